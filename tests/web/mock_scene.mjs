// The invented gallery's room as the daemon's GET /api/scene gives it: binary glTF, metres, +Y up.
import { createHash } from 'node:crypto';

const MATERIALS = [
  { name: 'white wall', colour: [0.72, 0.71, 0.68] },
  { name: 'oak floor', colour: [0.34, 0.24, 0.16] },
  { name: 'ceiling', colour: [0.8, 0.8, 0.78] },
  { name: 'pedestal', colour: [0.62, 0.61, 0.58] },
  { name: 'bench', colour: [0.12, 0.08, 0.06] },
  { name: 'picture', colour: [0.22, 0.27, 0.31] },
  { name: 'frame', colour: [0.25, 0.17, 0.08] },
];

/** [material, min, max] in metres, world. Walls are thick. */
function boxes() {
  const all = [
    [1, [0, 0, -0.3], [14, 9, 0]],
    [2, [0, 0, 4.2], [14, 9, 4.5]],
    [0, [-0.25, 9, -0.3], [14.25, 9.25, 4.5]],
    [0, [-0.25, -0.25, -0.3], [5.9, 0, 4.5]], // the door is between this and the next
    [0, [7.3, -0.25, -0.3], [14.25, 0, 4.5]],
    [0, [5.9, -0.25, 2.4], [7.3, 0, 4.5]],
    [0, [-0.25, 0, -0.3], [0, 9, 4.5]],
    [0, [14, 0, -0.3], [14.25, 9, 4.5]],
    [1, [5.9, -0.25, -0.3], [7.3, 0, 0]],
    [4, [9.8, 1.3, 0.38], [11.8, 1.75, 0.45]],
    [4, [10.0, 1.35, 0], [10.1, 1.7, 0.38]],
    [4, [11.5, 1.35, 0], [11.6, 1.7, 0.38]],
  ];
  for (const [x, y] of [[3.6, 4.4], [7.0, 4.7], [10.4, 4.2]]) all.push([3, [x - 0.25, y - 0.25, 0], [x + 0.25, y + 0.25, 1.1]]);
  for (const x of [2.2, 5.2, 8.4, 11.6]) {
    all.push([6, [x - 0.5, 8.97, 0.9], [x + 0.5, 9, 2.1]]);
    all.push([5, [x - 0.44, 8.955, 0.96], [x + 0.44, 8.97, 2.04]]);
  }
  all.push([5, [0, 4.1, 0.9], [0.04, 5.1, 2.1]], [5, [13.96, 4.2, 0.9], [14, 5.8, 2.1]]);
  return all;
}

const CORNERS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
const QUADS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/** all: [material, min, max]. materials: {name, colour, alpha?}. */
export function glbOf(all, materials = MATERIALS) {
  const positions = [];
  const indices = materials.map(() => []);
  for (const [material, min, max] of all) {
    const first = positions.length / 3;
    for (const corner of CORNERS) {
      const [x, y, z] = corner.map((c, axis) => (c ? max : min)[axis]);
      positions.push(x, z, -y);
    }
    for (const [a, b, c, d] of QUADS) indices[material].push(first + a, first + b, first + c, first + a, first + c, first + d);
  }
  const parts = [Buffer.from(new Float32Array(positions).buffer), ...indices.map((list) => Buffer.from(new Uint32Array(list).buffer))];
  const views = [];
  let at = 0;
  for (const part of parts) {
    views.push({ buffer: 0, byteOffset: at, byteLength: part.length });
    at += part.length;
  }
  const used = materials.map((_, m) => m).filter((m) => indices[m].length);
  const root = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: used.map((m) => ({ attributes: { POSITION: 0 }, indices: m + 1, material: m })) }],
    materials: materials.map(({ name, colour, alpha = 1 }) => ({ name, doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [...colour, alpha], metallicFactor: 0 }, ...(alpha < 1 ? { alphaMode: 'BLEND' } : {}) })),
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3' },
      ...indices.map((list, m) => ({ bufferView: m + 1, componentType: 5125, count: list.length, type: 'SCALAR' })),
    ],
    bufferViews: views,
    buffers: [{ byteLength: at }],
  };
  let text = JSON.stringify(root);
  while (Buffer.byteLength(text) % 4) text += ' ';
  const words = (...values) => Buffer.from(new Uint32Array(values).buffer);
  const length = Buffer.byteLength(text);
  return Buffer.concat([words(0x46546c67, 2, 28 + length + at, length, 0x4e4f534a), Buffer.from(text), words(at, 0x004e4942), ...parts]);
}

export const sceneGlb = () => glbOf(boxes());
export const etagOf = (bytes) => `"${createHash('sha256').update(bytes).digest('hex').slice(0, 16)}"`;
