/** The patches of a painted goal's surfaces (GET /api/surface-patches/{name}; tools/luxrigd/api/patch_file.h). */

import type {Vec3} from '../api';

export interface Patches {
  version: string;  // of the strokes that `lux` follows from
  count: number;
  cell_m: number;
  origin: Vec3;                // [m] world
  place: (p: number) => Vec3;  // relative to `origin`
  normal: (p: number) => Vec3;
  edge_m: (p: number) => number;
  lux: Float32Array;  // NaN: not painted
}

const HEAD = 64;
const RECORD = 16;

export function readPatches(bytes: ArrayBuffer): Patches {
  const view = new DataView(bytes);
  const count = bytes.byteLength >= HEAD && view.getUint32(0, false) === 0x4c585031 ? view.getUint32(4, true) : -1;
  if (count < 0 || bytes.byteLength !== HEAD + (RECORD + 4) * count)
    throw new Error('the patches that the daemon sent cannot be read');
  const cell_m = view.getFloat64(8, true);
  const at = (p: number): number => HEAD + RECORD * p;
  const lux = new Float32Array(count);
  for (let p = 0; p < count; ++p) lux[p] = view.getFloat32(HEAD + RECORD * count + 4 * p, true);
  return {
    version: String.fromCharCode(...new Uint8Array(bytes, 40, 16)),
    count,
    cell_m,
    origin: [view.getFloat64(16, true), view.getFloat64(24, true), view.getFloat64(32, true)],
    place: (p) => [view.getFloat32(at(p), true), view.getFloat32(at(p) + 4, true), view.getFloat32(at(p) + 8, true)],
    normal: (p) => [view.getInt8(at(p) + 12) / 127, view.getInt8(at(p) + 13) / 127, view.getInt8(at(p) + 14) / 127],
    edge_m: (p) => (view.getUint8(at(p) + 15) / 128) * cell_m,
    lux,
  };
}

/** Takes what changed; patches that there are not are left out. */
export function takeChange(patches: Patches, change: {patches: number[]; lux: number[]}): void {
  change.patches.forEach((p, i) => {
    if (Number.isInteger(p) && p >= 0 && p < patches.count) patches.lux[p] = change.lux[i] ?? NaN;
  });
}

export const paintedPatches = (patches: Patches): number[] => {
  const painted: number[] = [];
  for (let p = 0; p < patches.count; ++p)
    if (!Number.isNaN(patches.lux[p]!)) painted.push(p);
  return painted;
};

/** The light that is painted at a place [m, world], on that side; undefined: none. */
export function luxAt(patches: Patches, position: Vec3, normal: Vec3): number|undefined {
  let [best, far] = [-1, 1.2 * patches.cell_m];
  for (let p = 0; p < patches.count; ++p) {
    const [x, y, z] = patches.place(p);
    const away = Math.hypot(
        x + patches.origin[0] - position[0], y + patches.origin[1] - position[1], z + patches.origin[2] - position[2]);
    if (away >= far) continue;
    const side = patches.normal(p);
    if (side[0] * normal[0] + side[1] * normal[1] + side[2] * normal[2] < 0.5) continue;
    [best, far] = [p, away];
  }
  const lux = patches.lux[best];
  return lux === undefined || Number.isNaN(lux) ? undefined : lux;
}
