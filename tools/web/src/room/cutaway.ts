/** Which side of a surface is the room's: so that walls, floor and ceiling are not drawn from outside, and the inside
 *  can be seen from anywhere. Triangles in a file face either way, and walls may be thick or a sheet. So rays decide: a
 *  side is outside when most rays from it, past anything nearer than a wall is thick, meet nothing. */

const WALL_M = 0.7;         // what is nearer is the same wall
const LEAN = 0.7;           // of the four rays beside the normal: the tangent of their angle with it
const PLACES = 3;           // rays of a face start in so many of its triangles
export const LEAST_FACE_M2 = 0.01;  // smaller faces hide nothing, and are drawn from both sides
const MOST_FACES = 20_000;  // beyond this, the smallest are drawn from both sides

/** Whether a ray meets a surface further away than `near_m`. */
export type Meets = (origin: readonly number[], direction: readonly number[], near_m: number) => boolean;

export const enum Side {
  both = 0,
  front = 1,  // the room is where the corners go anticlockwise
  back = 2,
}

export interface Faces {
  of: Uint32Array;        // the face of each triangle
  triangles: number[][];  // of each face, the largest first, PLACES at most
  area_m2: number[];
  normal: (readonly[number, number, number])[];
}

/** Triangles of one plane are one face. */
export function facesOf(positions: Float32Array, index: Uint32Array): Faces {
  const count = index.length / 3;
  const faces: Faces = {of: new Uint32Array(count), triangles: [], area_m2: [], normal: []};
  const known = new Map<number, number>();
  const areas = new Float64Array(count);
  const cell = (v: number, size: number): number => Math.round(v / size);
  for (let t = 0; t < count; ++t) {
    let [nx, ny, nz, area] = normalOf(positions, index, t);
    areas[t] = area;
    // Of opposite normals one stands for both.
    if (nx < -1e-5 || (nx < 1e-5 && (ny < -1e-5 || (ny < 1e-5 && nz < 0)))) [nx, ny, nz] = [-nx, -ny, -nz];
    const first = 3 * index[3 * t]!;
    const along = nx * positions[first]! + ny * positions[first + 1]! + nz * positions[first + 2]!;
    // 51 cells on each axis of the normal, 4 cm of the plane's distance: one number up to 2^53.
    const turned = (cell(nx, 0.04) + 25) * 2601 + (cell(ny, 0.04) + 25) * 51 + cell(nz, 0.04) + 25;
    const key = (cell(along, 0.04) + 2 ** 30) * 2 ** 18 + turned;
    let face = known.get(key);
    if (face === undefined) {
      face = faces.triangles.length;
      known.set(key, face);
      faces.triangles.push([]);
      faces.area_m2.push(0);
      faces.normal.push([nx, ny, nz]);
    }
    faces.of[t] = face;
    faces.area_m2[face]! += area;
    const largest = faces.triangles[face]!;
    let place = largest.length;
    while (place > 0 && areas[largest[place - 1]!]! < area) --place;
    if (place < PLACES) largest.splice(place, 0, t);
    if (largest.length > PLACES) largest.pop();
  }
  return faces;
}

/** The side from which each triangle is drawn. */
export function sidesOf(positions: Float32Array, index: Uint32Array, faces: Faces, meets: Meets): Uint8Array {
  const order = [...faces.area_m2.keys()]
                    .filter((face) => faces.area_m2[face]! >= LEAST_FACE_M2)
                    .sort((a, b) => faces.area_m2[b]! - faces.area_m2[a]!);
  const of_face = new Int8Array(faces.area_m2.length);  // +1: the room is on the side of the face's normal
  for (const face of order.slice(0, MOST_FACES)) {
    const normal = faces.normal[face]!;
    const outside = (sign: number): boolean => {
      let [gone, rays] = [0, 0];
      for (const triangle of faces.triangles[face]!) {
        const middle = middleOf(positions, index, triangle);
        for (const direction of fan(normal, sign)) {
          ++rays;
          if (!meets(middle, direction, WALL_M)) ++gone;
        }
      }
      return gone > 0.6 * rays;
    };
    const [front, back] = [outside(1), outside(-1)];
    of_face[face] = front === back ? 0 : front ? -1 : 1;
  }
  const sides = new Uint8Array(index.length / 3);
  for (let t = 0; t < sides.length; ++t) {
    const inside = of_face[faces.of[t]!]!;
    if (inside === 0) continue;
    const normal = normalOf(positions, index, t);
    const with_face = dot(normal, faces.normal[faces.of[t]!]!) > 0;
    sides[t] = inside > 0 === with_face ? Side.front : Side.back;
  }
  return sides;
}

const cornerOf = (positions: Float32Array, v: number):
    [number, number, number] => [positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!];
const dot = (a: readonly number[], b: readonly number[]): number => a[0]! * b[0]! + a[1]! * b[1]! + a[2]! * b[2]!;

function middleOf(positions: Float32Array, index: Uint32Array, t: number): [number, number, number] {
  const [a, b, c] =
      [0, 1, 2].map((i) => cornerOf(positions, index[3 * t + i]!)) as unknown as [number[], number[], number[]];
  return [0, 1, 2].map((axis) => (a[axis]! + b[axis]! + c[axis]!) / 3) as [number, number, number];
}

/** Its unit normal, and its area in m². */
function normalOf(positions: Float32Array, index: Uint32Array, t: number): [number, number, number, number] {
  const [a, b, c] = [3 * index[3 * t]!, 3 * index[3 * t + 1]!, 3 * index[3 * t + 2]!];
  const [ax, ay, az] = [positions[a]!, positions[a + 1]!, positions[a + 2]!];
  const [ux, uy, uz] = [positions[b]! - ax, positions[b + 1]! - ay, positions[b + 2]! - az];
  const [vx, vy, vz] = [positions[c]! - ax, positions[c + 1]! - ay, positions[c + 2]! - az];
  const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.sqrt(x * x + y * y + z * z);
  return length > 0 ? [x / length, y / length, z / length, length / 2] : [0, 0, 1, 0];
}

/** The normal, and four rays that lean from it. */
function fan(normal: readonly[number, number, number], sign: number): number[][] {
  const [x, y, z] = normal.map((v) => v * sign) as [number, number, number];
  const aside = Math.abs(z) < 0.9 ? [-y, x, 0] : [0, -z, y];
  const long = Math.hypot(...aside);
  const u = aside.map((v) => v / long) as [number, number, number];
  const w = [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]] as const;
  const lean = (a: number, b: number): number[] => {
    const d = [x + a * u[0] + b * w[0], y + a * u[1] + b * w[1], z + a * u[2] + b * w[2]];
    const length = Math.hypot(...d);
    return d.map((v) => v / length);
  };
  return [lean(0, 0), lean(LEAN, 0), lean(-LEAN, 0), lean(0, LEAN), lean(0, -LEAN)];
}
