/** Makes of a room's geometry what drawing and picking need. Takes its time: called in a worker. */

import {BufferAttribute, BufferGeometry, DoubleSide, EdgesGeometry, Ray} from 'three';
import {MeshBVH, type SerializedBVH} from 'three-mesh-bvh';
import {facesOf, LEAST_FACE_M2, type Meets, Side, sidesOf} from './cutaway';
import {type RoomMaterial, readGlb} from './glb';

/** Triangles of one material that are drawn from one side or from both. */
export interface DrawnPart {
  material: RoomMaterial;
  cut_away: boolean;  // drawn from the room's side alone
  index: Uint32Array;
}

export interface MadeRoom {
  positions: Float32Array;                   // relative to `origin`
  origin: readonly[number, number, number];  // [m] world
  min: [number, number, number];             // relative to `origin`
  max: [number, number, number];
  parts: DrawnPart[];
  edges: Float32Array;  // ends of lines; empty where they would be too many
  bvh: SerializedBVH;   // of all triangles in its index; those that are cut away face the room
  part: Uint16Array;    // of each triangle of that index
  triangles: number;
}

const MOST_EDGES_OF = 60_000;  // triangles

export function makeRoom(bytes: ArrayBuffer): MadeRoom {
  const {positions, origin, index, material, materials} = readGlb(bytes);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(index.slice(), 1));
  const search = new MeshBVH(geometry, {indirect: true});
  const ray = new Ray();
  const meets: Meets = ([ox, oy, oz], [dx, dy, dz], near) => {
    ray.origin.set(ox!, oy!, oz!);
    ray.direction.set(dx!, dy!, dz!);
    return search.raycastFirst(ray, DoubleSide, near) !== null;
  };
  const faces = facesOf(positions, index);
  const sides = sidesOf(positions, index, faces, meets);

  // By part; a triangle that is cut away is turned to face the room.
  const part = new Uint16Array(sides.length);
  const counts = new Map<number, number>();
  const keyOf = (t: number): number => 2 * material[t]! + (sides[t] === Side.both ? 0 : 1);
  for (let t = 0; t < sides.length; ++t) {
    counts.set(keyOf(t), (counts.get(keyOf(t)) ?? 0) + 1);
    if (sides[t] === Side.back) [index[3 * t + 1], index[3 * t + 2]] = [index[3 * t + 2]!, index[3 * t + 1]!];
  }
  const keys = [...counts.keys()].sort((a, b) => a - b);
  const parts = keys.map(
      (key) =>
          ({material: materials[key >> 1]!, cut_away: key % 2 === 1, index: new Uint32Array(3 * counts.get(key)!)}));
  const number_of = new Map(keys.map((key, i) => [key, i]));
  const filled = parts.map(() => 0);
  for (let t = 0; t < sides.length; ++t) {
    const p = number_of.get(keyOf(t))!;
    part[t] = p;
    for (let corner = 0; corner < 3; ++corner) parts[p]!.index[filled[p]!++] = index[3 * t + corner]!;
  }

  geometry.setIndex(new BufferAttribute(index, 1));  // `search` holds for it: the same triangles, some turned round
  const edges = edgesOf(geometry, (t) => faces.area_m2[faces.of[t]!]! >= LEAST_FACE_M2);
  geometry.computeBoundingBox();
  const {min, max} = geometry.boundingBox!;
  const bvh = MeshBVH.serialize(search, {cloneBuffers: false});
  return {positions, origin, min: min.toArray(), max: max.toArray(), parts, edges, bvh, part, triangles: sides.length};
}

/** Lines where faces meet at an angle. Of a room with very many triangles, only of its `large` faces: the lines of a
 *  statue would be a black spot. */
function edgesOf(geometry: BufferGeometry, large: (triangle: number) => boolean): Float32Array {
  const index = geometry.getIndex()!.array;
  const count = index.length / 3;
  const some = new BufferGeometry();
  some.setAttribute('position', geometry.getAttribute('position'));
  const kept: number[] = [];
  for (let t = 0; t < count; ++t)
    if (count <= MOST_EDGES_OF || large(t)) kept.push(index[3 * t]!, index[3 * t + 1]!, index[3 * t + 2]!);
  if (kept.length === 0 || kept.length > 3 * MOST_EDGES_OF) return new Float32Array();
  some.setIndex(kept);
  return new Float32Array(new EdgesGeometry(some, 25).getAttribute('position').array);
}
