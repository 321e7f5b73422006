/** Reads a room's geometry from binary glTF 2.0 (GET /api/scene): triangles by material, in frame world (metres, +Z up).
 *  What arrives is not trusted: every index and length is checked. Throws with a sentence for a person. */

export interface RoomMaterial {
  name: string;
  colour: readonly[number, number, number];  // reflectance, linear
  alpha: number;                             // below 1: glass
}

export interface RoomGeometry {
  positions: Float32Array;                   // x, y, z of each vertex, relative to `origin`
  origin: readonly[number, number, number];  // [m] world
  index: Uint32Array;                        // three vertices of each triangle
  material: Uint16Array;                     // of each triangle
  materials: RoomMaterial[];
}

type Matrix = readonly number[];  // 4 × 4, by columns
type Fields = Record<string, unknown>;

const IDENTITY: Matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const COMPONENT_BYTES: Record<number, number> = {
  5121: 1,
  5123: 2,
  5125: 4,
  5126: 4
};
const DEEPEST = 64;

const fail = (what: string): never => {
  throw new Error(`the room's geometry cannot be read: ${what}`);
};
const fields = (value: unknown): Fields => (typeof value === 'object' && value !== null ? (value as Fields) : {});
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
const numbers = (value: unknown, count: number): number[]|undefined =>
    Array.isArray(value) && value.length === count && value.every((v) => typeof v === 'number' && Number.isFinite(v)) ?
    value :
    undefined;
const index = (value: unknown): number => (Number.isInteger(value) && (value as number) >= 0 ? (value as number) : -1);

function times(a: Matrix, b: Matrix): Matrix {
  const out = new Array<number>(16).fill(0);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) out[4 * column + row]! += a[4 * k + row]! * b[4 * column + k]!;
  return out;
}

function matrixOf(node: Fields): Matrix {
  const whole = numbers(node['matrix'], 16);
  if (whole) return whole;
  const [tx, ty, tz] = numbers(node['translation'], 3) ?? [0, 0, 0];
  const [x, y, z, w] = (numbers(node['rotation'], 4) ?? [0, 0, 0, 1]) as [number, number, number, number];
  const [sx, sy, sz] = (numbers(node['scale'], 3) ?? [1, 1, 1]) as [number, number, number];
  return [
    (1 - 2 * (y * y + z * z)) * sx,
    2 * (x * y + z * w) * sx,
    2 * (x * z - y * w) * sx,
    0,
    2 * (x * y - z * w) * sy,
    (1 - 2 * (x * x + z * z)) * sy,
    2 * (y * z + x * w) * sy,
    0,
    2 * (x * z + y * w) * sz,
    2 * (y * z - x * w) * sz,
    (1 - 2 * (x * x + y * y)) * sz,
    0,
    tx!,
    ty!,
    tz!,
    1,
  ];
}

class Document {
  readonly root: Fields;
  private readonly binary: DataView;

  constructor(bytes: ArrayBuffer) {
    const view = new DataView(bytes);
    if (bytes.byteLength < 20 || view.getUint32(0, true) !== 0x46546c67 || view.getUint32(4, true) !== 2)
      fail('it is no binary glTF 2.0');
    const text_bytes = view.getUint32(12, true);
    if (view.getUint32(16, true) !== 0x4e4f534a || 20 + text_bytes > bytes.byteLength) fail('its JSON is cut off');
    try {
      this.root = fields(JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, text_bytes))));
    } catch {
      this.root = fail('its JSON is broken');
    }
    const at = 20 + text_bytes;
    const size = at + 8 <= bytes.byteLength ? view.getUint32(at, true) : 0;
    if (at + 8 + size > bytes.byteLength) fail('its data are cut off');
    this.binary = new DataView(bytes, Math.min(at + 8, bytes.byteLength), size);
  }

  entry(name: string, at: unknown): Fields { return fields(list(this.root[name])[index(at)]); }

  /** Rows of an accessor: how many, and what is in them. */
  accessor(at: unknown, components: number): {count: number; read: (row: number, component: number) => number} {
    const accessor = this.entry('accessors', at);
    const buffer = this.entry('bufferViews', accessor['bufferView']);
    const type = Number(accessor['componentType']);
    const bytes = COMPONENT_BYTES[type] ?? fail('it has numbers of an unknown kind');
    const count = index(accessor['count']);
    if (accessor['type'] !== (components === 3 ? 'VEC3' : 'SCALAR') || count < 0 || accessor['sparse'] !== undefined ||
        accessor['normalized'] === true)
      fail('it has numbers of an unknown kind');
    const stride = index(buffer['byteStride']) > 0 ? index(buffer['byteStride']) : bytes * components;
    const start = Math.max(0, index(buffer['byteOffset'])) + Math.max(0, index(accessor['byteOffset']));
    if (buffer['buffer'] !== 0 ||
        (count > 0 && start + (count - 1) * stride + bytes * components > this.binary.byteLength))
      fail('its data are cut off');
    const {binary} = this;
    const read: (row: number, component: number) => number = type === 5126 ?
        (row, component) => binary.getFloat32(start + row * stride + component * bytes, true) :
        type === 5125 ? (row, component) => binary.getUint32(start + row * stride + component * bytes, true) :
        type === 5123 ? (row, component) => binary.getUint16(start + row * stride + component * bytes, true) :
                        (row, component) => binary.getUint8(start + row * stride + component * bytes);
    return {count, read};
  }
}

function readMaterial(from: Fields): RoomMaterial {
  const look = fields(from['pbrMetallicRoughness']);
  const [r, g, b, a] = (numbers(look['baseColorFactor'], 4) ?? [1, 1, 1, 1]) as [number, number, number, number];
  const clamp = (v: number): number => Math.min(1, Math.max(0, v));
  return {
    name: typeof from['name'] === 'string' ? from['name'] : '',
    colour: [clamp(r), clamp(g), clamp(b)],
    alpha: from['alphaMode'] === 'BLEND' ? clamp(a) : 1,
  };
}

export function readGlb(bytes: ArrayBuffer): RoomGeometry {
  const document = new Document(bytes);
  const materials = list(document.root['materials']).slice(0, 65534).map((m) => readMaterial(fields(m)));
  const plain = materials.push({name: '', colour: [0.5, 0.5, 0.5], alpha: 1}) - 1;

  // Every use of a mesh, with its place.
  const placed: {primitive: Fields; matrix: Matrix}[] = [];
  const place = (at: unknown, above: Matrix, depth: number): void => {
    if (depth > DEEPEST || placed.length > 100_000) fail('its nodes are too many or too deep');
    const node = document.entry('nodes', at);
    const matrix = times(above, matrixOf(node));
    if (node['mesh'] !== undefined)
      for (const primitive of list(document.entry('meshes', node['mesh'])['primitives']))
        placed.push({primitive: fields(primitive), matrix});
    for (const child of list(node['children'])) place(child, matrix, depth + 1);
  };
  for (const node of list(document.entry('scenes', document.root['scene'] ?? 0)['nodes'])) place(node, IDENTITY, 0);

  // Vertices that primitives share at one place are kept once.
  const parts: {key: string; first: number; vertices: number; triangles: number; primitive: Fields; matrix: Matrix}[] =
      [];
  const known = new Map < string, {
    first: number;
    vertices: number
  }
  > ();
  let [vertices, triangles] = [0, 0];
  for (const {primitive, matrix} of placed) {
    if (primitive['mode'] !== undefined && primitive['mode'] !== 4) continue;  // lines and points
    const position = index(fields(primitive['attributes'])['POSITION']);
    const key = `${position} ${matrix.join(' ')}`;
    let block = known.get(key);
    if (!block) {
      block = {first: vertices, vertices: document.accessor(position, 3).count};
      known.set(key, block);
      vertices += block.vertices;
    }
    const corners =
        primitive['indices'] === undefined ? block.vertices : document.accessor(primitive['indices'], 1).count;
    parts.push({key, ...block, triangles: Math.floor(corners / 3), primitive, matrix});
    triangles += Math.floor(corners / 3);
  }
  if (triangles === 0) fail('it has no triangles');

  const first = parts[0]!.matrix;
  const origin = [first[12]!, -first[14]!, first[13]!] as const;  // glTF x, y, z is world x, -z, y
  const geometry: RoomGeometry = {
    positions: new Float32Array(3 * vertices),
    origin,
    index: new Uint32Array(3 * triangles),
    material: new Uint16Array(triangles),
    materials,
  };
  const done = new Set<string>();
  let next = 0;
  for (const part of parts) {
    if (!done.has(part.key)) {
      done.add(part.key);
      fillVertices(document, part, geometry);
    }
    const indices =
        part.primitive['indices'] === undefined ? undefined : document.accessor(part.primitive['indices'], 1);
    const material = index(part.primitive['material']);
    for (let t = 0; t < part.triangles; ++t, ++next) {
      for (let corner = 0; corner < 3; ++corner) {
        const vertex = indices ? indices.read(3 * t + corner, 0) : 3 * t + corner;
        if (vertex >= part.vertices) fail('a triangle has a vertex that is not there');
        geometry.index[3 * next + corner] = part.first + vertex;
      }
      geometry.material[next] = material >= 0 && material < plain ? material : plain;
    }
  }
  return geometry;
}

function fillVertices(
    document: Document, part: {first: number; vertices: number; primitive: Fields; matrix: Matrix},
    to: RoomGeometry): void {
  const from = document.accessor(fields(part.primitive['attributes'])['POSITION'], 3);
  const m = part.matrix;
  for (let v = 0; v < part.vertices; ++v) {
    const [x, y, z] = [from.read(v, 0), from.read(v, 1), from.read(v, 2)];
    const at = (row: number): number => m[row]! * x + m[4 + row]! * y + m[8 + row]! * z + m[12 + row]!;
    const place = [at(0) - to.origin[0], -at(2) - to.origin[1], at(1) - to.origin[2]];
    for (let axis = 0; axis < 3; ++axis) {
      const value = place[axis]!;
      if (!Number.isFinite(value)) fail('a vertex is nowhere');
      to.positions[3 * (part.first + v) + axis] = value;
    }
  }
}
