// The 3-D room's logic without a browser: colours, scales in lux, reading of geometry, and what is cut away.
//   node tests/web/room_unit_test.mjs
import assert from 'node:assert/strict';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { glbOf, sceneGlb } from './mock_scene.mjs';

const web = new URL('../../tools/web/', import.meta.url);
const { build } = createRequire(new URL('package.json', web))('esbuild');
const { outputFiles } = await build({
  stdin: {
    contents: ['colour_scales', 'layers', 'glb', 'made_room', 'surfaces', 'labels', 'points_3d', 'paint_document', 'patches'].map((name) => `export * from './src/room/${name}';`).join('\n')
      + "export { Ray, Vector3 } from 'three';",
    resolveDir: fileURLToPath(web), loader: 'ts',
  },
  bundle: true, format: 'esm', write: false, logLevel: 'error',
});
// As a file: errors of a module in an address would print the whole of it.
const folder = await mkdtemp(path.join(tmpdir(), 'luxrig-room-'));
const file = path.join(folder, 'room.mjs');
await writeFile(file, outputFiles[0].contents);
globalThis.window = { matchMedia: () => ({ matches: false, addEventListener: () => undefined }) };
const room = await import(pathToFileURL(file).href);
await rm(folder, { recursive: true });

/** Even in [0, 1), the same in each run (mulberry32). */
function dice(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
const bytesOf = (buffer) => buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.length);

/** CIE 1976 L* of an sRGB colour. */
function lightness(rgb) {
  const [r, g, b] = rgb.map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  const y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return y > 216 / 24389 ? 116 * Math.cbrt(y) - 16 : (24389 / 27) * y;
}

test('the lux scale only gets lighter, and evenly enough to read in grey', () => {
  let before = lightness(room.colourAt(room.VIRIDIS, 0));
  for (let i = 1; i <= 40; ++i) {
    const now = lightness(room.colourAt(room.VIRIDIS, i / 40));
    assert.ok(now - before > 0.8 && now - before < 4, `step ${i}: ${now - before}`);
    before = now;
  }
  assert.deepEqual(room.colourAt(room.VIRIDIS, -1), room.colourAt(room.VIRIDIS, 0));
  assert.deepEqual(room.colourAt(room.VIRIDIS, 7).map((v) => Math.round(v * 255)), [0xfd, 0xe7, 0x25]);
});

test('the difference scale is lightest in its middle, and darkens to both sides', () => {
  for (const side of [-1, 1])
    for (let i = 0; i < 10; ++i)
      assert.ok(lightness(room.colourAt(room.PURPLE_ORANGE, 0.5 + (side * i) / 20)) > lightness(room.colourAt(room.PURPLE_ORANGE, 0.5 + (side * (i + 1)) / 20)));
});

test('ticks are round, 3 to 8 of them, and nothing is off the scale', () => {
  const next = dice(5);
  for (let i = 0; i < 2000; ++i) {
    const size = 10 ** (6 * next() - 2);
    const points = Array.from({ length: 1 + Math.floor(5 * next()) }, () => ({ goal_lux: size * next(), predicted_lux: size * next(), standard_error_lux: size * next() * 0.1 }));
    for (const layer of ['goal', 'predicted', 'measured', 'difference', 'uncertainty']) {
      const scale = room.scaleOf(layer, points);
      for (const point of points) {
        const lux = room.layerLux(layer, point);
        assert.ok(lux === undefined || (lux >= scale.from - 1e-9 && lux <= scale.to + 1e-9), `${layer}: ${lux} in ${scale.from}…${scale.to}`);
      }
      assert.ok(scale.ticks.length >= 3 && scale.ticks.length <= 9, `${scale.ticks}`);
      const step = scale.ticks[1] - scale.ticks[0];
      const lead = step / 10 ** Math.floor(Math.log10(step) + 1e-9);
      assert.ok([1, 2, 5, 10].some((round) => Math.abs(lead - round) < 1e-6), `step ${step}`);
    }
  }
});

test('goal, predicted and measured have one scale; it stays while it fits', () => {
  const points = [{ goal_lux: 45, predicted_lux: 44, measured_lux: 47.5 }, { goal_lux: 300, predicted_lux: 310 }];
  const [goal, predicted, measured] = ['goal', 'predicted', 'measured'].map((layer) => room.scaleOf(layer, points));
  assert.deepEqual([goal, measured], [predicted, predicted]);
  assert.equal(room.scaleOf('goal', [{ goal_lux: 320 }], goal), goal, 'a little more light is no other scale');
  assert.notEqual(room.scaleOf('goal', [{ goal_lux: 900 }], goal).to, goal.to);
  assert.notEqual(room.scaleOf('goal', [{ goal_lux: 3 }], goal).to, goal.to, 'and much less is one');
  const difference = room.scaleOf('difference', points);
  assert.equal(difference.from, -difference.to);
  assert.deepEqual(room.colourOf(difference, 0), room.colourAt(room.PURPLE_ORANGE, 0.5));
  assert.equal(room.layerLux('difference', points[0]), 2.5, 'of the reading, where there is one');
  assert.equal(room.layerLux('difference', { predicted_lux: 3 }), undefined, 'no goal, no difference');
});

test('a room is read in frame world, with its materials', () => {
  const read = room.readGlb(bytesOf(glbOf([[0, [1, 2, 3], [4, 6, 8]], [1, [0, 0, 0], [1, 1, 1]]],
    [{ name: 'wall', colour: [0.5, 0.4, 0.3] }, { name: 'pane', colour: [0.9, 0.9, 0.9], alpha: 0.2 }])));
  assert.equal(read.index.length / 3, 24);
  const axis = (n) => Array.from({ length: 8 }, (_, v) => read.positions[3 * v + n]);
  assert.deepEqual([0, 1, 2].map((n) => [Math.min(...axis(n)), Math.max(...axis(n))]), [[1, 4], [2, 6], [3, 8]]);
  assert.deepEqual(read.materials[read.material[0]], { name: 'wall', colour: [0.5, 0.4, 0.3], alpha: 1 });
  assert.equal(read.materials[read.material[23]].alpha, 0.2);
});

test('a file of another program is read: nodes turned and scaled, interleaved vertices', async () => {
  const read = room.readGlb(bytesOf(await readFile(new URL('../../rigs/gallery/scene/gallery.glb', import.meta.url))));
  assert.equal(read.index.length, 5790);
  const high = read.positions.filter((_, i) => i % 3 === 2);
  const span = high.reduce((most, v) => Math.max(most, v), -Infinity) - high.reduce((least, v) => Math.min(least, v), Infinity);
  assert.ok(Math.abs(span - 5.05) < 0.02, `${span} m high`);
});

test('garbled and cut files are refused with a sentence, and never read past their end', () => {
  const whole = sceneGlb();
  const next = dice(11);
  let refused = 0;
  for (let i = 0; i < 3000; ++i) {
    const bytes = Buffer.from(i % 3 ? whole : whole.subarray(0, Math.floor(next() * whole.length)));
    for (let hits = 1 + Math.floor(next() * 4); hits > 0 && bytes.length; --hits) bytes[Math.floor(next() * Math.min(bytes.length, 2500))] = Math.floor(next() * 256);
    try {
      const read = room.readGlb(bytesOf(bytes));
      const vertices = read.positions.length / 3;
      assert.ok(read.index.every((v) => v < vertices) && read.positions.every(Number.isFinite) && read.material.every((m) => m < read.materials.length));
    } catch (error) {
      if (error.code === 'ERR_ASSERTION') throw error;
      assert.match(error.message, /^the room's geometry cannot be read: [a-z' A-Z0-9.]+$/, error.stack);
      ++refused;
    }
  }
  assert.ok(refused > 1000, `${refused} refused`);
});

/** The mock's room: what is first seen from a place outside, towards a place within. */
const within = ({ x, y, z }) => x > -0.01 && x < 14.01 && y > -0.01 && y < 9.01 && z > -0.01 && z < 4.21;
function looks(surfaces, count, seed) {
  const next = dice(seed);
  const seen = [];
  while (seen.length < count) {
    const direction = new room.Vector3(next() - 0.5, next() - 0.5, next() - 0.5);
    if (direction.length() < 0.1 || direction.length() > 0.5) continue;
    const target = new room.Vector3(0.5 + 13 * next(), 0.5 + 8 * next(), 0.5 + 3 * next());
    const eye = new room.Vector3(7, 4.5, 2).addScaledVector(direction.normalize(), 40);
    // Through the door the thickness of the wall is seen, or the world outside.
    const [out, inside] = [-0.26, 0.01].map((y) => eye.clone().lerp(target, (y - eye.y) / (target.y - eye.y)).x);
    if (Math.min(out, inside) < 7.35 && Math.max(out, inside) > 5.85) continue;
    seen.push({ eye, target, hit: surfaces.under(new room.Ray(eye, target.clone().sub(eye).normalize())) });
  }
  return seen;
}

test('the room is seen into from everywhere: thick walls, floor and ceiling are not drawn from outside', () => {
  const surfaces = new room.Surfaces(room.makeRoom(bytesOf(sceneGlb())));
  for (const { eye, target, hit } of looks(surfaces, 2000, 3))
    assert.ok(hit && within(hit.place), `from ${eye.toArray()} to ${target.toArray()}: ${hit?.material.name} at ${hit?.place.toArray()}`);
});

test('and so is a room of single sheets that face either way', () => {
  const next = dice(9);
  const read = room.readGlb(bytesOf(glbOf([[0, [0, 0, 0], [14, 9, 4.2]], [3, [6, 4, 0], [7, 5, 1.1]]])));
  const glb = glbOf([[0, [0, 0, 0], [14, 9, 4.2]], [3, [6, 4, 0], [7, 5, 1.1]]]);
  // Turned in the file: two corners of a triangle change places.
  const start = glb.length - 4 * read.index.length;
  for (let t = 0; t < read.index.length / 3; ++t)
    if (next() < 0.5) {
      const at = start + 12 * t;
      const [a, b] = [glb.readUInt32LE(at + 4), glb.readUInt32LE(at + 8)];
      glb.writeUInt32LE(b, at + 4);
      glb.writeUInt32LE(a, at + 8);
    }
  const surfaces = new room.Surfaces(room.makeRoom(bytesOf(glb)));
  let pedestal = 0;
  for (const { hit, eye, target } of looks(surfaces, 1000, 4)) {
    assert.ok(hit && hit.distance_m > eye.distanceTo(target) - 20, 'something is seen');
    const { x, y, z } = hit.place;
    const near = [x, 14 - x, y, 9 - y, z, 4.2 - z].some((far) => Math.abs(far) < 1e-3);
    if (hit.material.name === 'pedestal') ++pedestal;
    else assert.ok(near && hit.distance_m > eye.distanceTo(target), `the far side, not the near one: ${hit.place.toArray()}`);
  }
  assert.ok(pedestal > 3, `what stands in the room is seen from outside: ${pedestal}`);
});

test('from within, every wall is there', () => {
  const surfaces = new room.Surfaces(room.makeRoom(bytesOf(sceneGlb())));
  const next = dice(21);
  for (let i = 0; i < 500; ++i) {
    const direction = new room.Vector3(next() - 0.5, next() - 0.5, next() - 0.5).normalize();
    const hit = surfaces.under(new room.Ray(new room.Vector3(5, 3, 1.6), direction));
    const out_of_the_door = !hit && direction.y < 0;
    assert.ok(out_of_the_door || hit, `towards ${direction.toArray()}`);
    if (hit) assert.ok(hit.normal.dot(direction) < 0, 'its normal looks at the viewer');
  }
  assert.ok(surfaces.hides(new room.Vector3(5, 3, 1.6), new room.Vector3(5, 30, 1.6)));
  assert.ok(!surfaces.hides(new room.Vector3(5, 3, 1.6), new room.Vector3(5, 8.9, 1.6)));
});

test('labels do not lie on one another, nor over the edge; the first win', () => {
  const next = dice(2);
  const labels = Array.from({ length: 300 }, (_, i) => ({ x: 500 * next(), y: 300 * next(), text: `label ${i}`, kind: 'lux' }));
  const fit = room.fitting(labels, 500, 300);
  assert.equal(fit[0], labels.find((l) => l.x > 40 && l.x < 460 && l.y > 8 && l.y < 292));
  assert.ok(fit.length > 20);
  fit.forEach((a, i) => fit.slice(i + 1).forEach((b) => assert.ok(Math.abs(a.x - b.x) > 50 || Math.abs(a.y - b.y) >= 16)));
});

test('the nearest other point is found', () => {
  const next = dice(8);
  const places = Array.from({ length: 200 }, () => ({ x: 4 * next(), y: 4 * next(), z: next() }));
  const brute = places.map((p, i) => Math.min(0.7, ...places.filter((_, j) => j !== i).map((q) => Math.hypot(p.x - q.x, p.y - q.y, p.z - q.z))));
  room.nearest(places).forEach((far, i) => assert.ok(Math.abs(far - brute[i]) < 1e-12));
});

test('a list of strokes is undone, done again, and brought to what the daemon has', () => {
  const pen = { lux: 300, radius_m: 0.4, falloff: 0 };
  const place = (x) => ({ position: [x, 0, 0], normal: [0, 0, 1] });
  const document = new room.PaintDocument();
  document.add(room.strokeOf('bucket', pen, place(1)));
  document.add(room.strokeOf('brush', pen, place(2)));
  document.extend(place(3));
  const kinds = () => document.strokes.map((one) => `${one.kind}${one.path.length}`).join();
  assert.equal(kinds(), 'bucket1,brush2');
  document.undo();
  assert.equal(kinds(), 'bucket1');
  document.extend(place(4)); // a bucket has one place
  assert.equal(kinds(), 'bucket1');
  document.redo();
  assert.equal(kinds(), 'bucket1,brush2');
  // Somebody else took the brush away and put an eraser there: ours can be put on top of it.
  const theirs = [document.strokes[0], room.strokeOf('eraser', pen, place(1))];
  assert.deepEqual(theirs[1], { kind: 'eraser', path: [place(1)] });
  document.replace(theirs);
  assert.equal(kinds(), 'bucket1,eraser1');
  document.replace(theirs); // as it is told twice
  document.redo();
  assert.equal(kinds(), 'bucket1,eraser1,brush2');
  document.undo();
  document.add(room.strokeOf('selective', pen, place(5)));
  assert.ok(!document.canRedo);
  const before = document.revision;
  document.redo();
  assert.equal(document.revision, before);
  assert.ok(room.isApart([0, 0, 0], [0.2, 0, 0], 0.4) && !room.isApart([0, 0, 0], [0.05, 0, 0], 0.4));
  assert.equal(room.otherRadius(0.4, true), 0.5);
  assert.equal(room.otherRadius(0.05, false), 0.05);
});

test('patches are read as they are sent, changed, and looked up by their side', () => {
  const bytes = Buffer.alloc(64 + 20 * 2);
  bytes.write('LXP1', 0);
  bytes.writeUInt32LE(2, 4);
  bytes.writeDoubleLE(0.25, 8);
  bytes.writeDoubleLE(100, 16);
  bytes.write('0123456789abcdef', 40);
  for (const [p, side] of [[0, 127], [1, -127]]) {
    bytes.writeFloatLE(1.5, 64 + 16 * p);
    bytes.writeInt8(side, 64 + 16 * p + 14);
    bytes.writeUInt8(64, 64 + 16 * p + 15);
    bytes.writeFloatLE(p ? NaN : 120, 64 + 32 + 4 * p);
  }
  const patches = room.readPatches(bytesOf(bytes));
  assert.equal(patches.version, '0123456789abcdef');
  assert.deepEqual(patches.origin, [100, 0, 0]);
  assert.deepEqual([patches.place(1), patches.normal(1), patches.edge_m(0)], [[1.5, 0, 0], [0, 0, -1], 0.125]);
  assert.deepEqual(room.paintedPatches(patches), [0]);
  assert.equal(room.luxAt(patches, [101.5, 0.1, 0], [0, 0, 1]), 120);
  assert.equal(room.luxAt(patches, [101.5, 0.1, 0], [0, 0, -1]), undefined, 'the other side is not painted');
  assert.equal(room.luxAt(patches, [103, 0, 0], [0, 0, 1]), undefined);
  room.takeChange(patches, { patches: [1, 7, -1, 0.5], lux: [80, 1, 1, 1] });
  assert.equal(room.luxAt(patches, [101.5, 0, 0], [0, 0, -1]), 80);
  for (const cut of [0, 10, 63, 64 + 20]) assert.throws(() => room.readPatches(bytesOf(bytes).slice(0, cut)), /cannot be read/);
});
