/** The room's surfaces: drawn, and found under the pointer. */

import {Box3, BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, Ray, Sphere, Vector3} from 'three';
import {MeshBVH} from 'three-mesh-bvh';
import type {RoomMaterial} from './glb';
import type {MadeRoom} from './made_room';

export interface SurfaceHit {
  material: RoomMaterial;
  place: Vector3;   // relative to the scene's origin
  normal: Vector3;  // towards the viewer
  distance_m: number;
}

export class Surfaces {
  readonly group = new Group();
  private readonly search: MeshBVH;
  private readonly lines = new LineBasicMaterial({transparent: true, opacity: 0.35, depthWrite: false});
  private readonly a = new Vector3();
  private readonly b = new Vector3();

  constructor(private readonly room: MadeRoom) {
    const positions = new BufferAttribute(room.positions, 3);
    // Else three finds it for each part anew, in all vertices: a tenth of a second of a large room.
    const around = new Box3(new Vector3(...room.min), new Vector3(...room.max)).getBoundingSphere(new Sphere());
    for (const part of room.parts) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', positions);
      geometry.boundingSphere = around;
      geometry.setIndex(new BufferAttribute(part.index, 1));
      const {colour, alpha} = part.material;
      const glass = alpha < 1;
      const material = new MeshLambertMaterial({
        color: new Color(colour[0], colour[1], colour[2]),
        side: part.cut_away ? FrontSide : DoubleSide,
        flatShading: true,
        transparent: glass,
        opacity: glass ? Math.max(0.15, alpha) : 1,
        depthWrite: !glass,
        polygonOffset: true,  // lines and discs lie on it
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 2,
      });
      this.group.add(new Mesh(geometry, material));
    }
    if (room.edges.length) {
      const edges = new BufferGeometry();
      edges.setAttribute('position', new BufferAttribute(room.edges, 3));
      edges.boundingSphere = around;
      this.group.add(new LineSegments(edges, this.lines));
    }
    const whole = new BufferGeometry();
    whole.setAttribute('position', positions);
    this.search = MeshBVH.deserialize(room.bvh, whole);
  }

  setTheme(line: Color): void { this.lines.color.copy(line); }

  /** The first surface that a ray meets and that is drawn from there. */
  under(ray: Ray): SurfaceHit|undefined {
    let found: SurfaceHit|undefined;
    for (const hit of this.search.raycast(ray, DoubleSide)) {
      if (hit.faceIndex === undefined || hit.faceIndex === null || !hit.face ||
          (found && hit.distance >= found.distance_m))
        continue;
      const part = this.room.parts[this.room.part[hit.faceIndex]!]!;
      const behind = hit.face.normal.dot(ray.direction) > 0;
      if (part.cut_away && behind) continue;
      found = {
        material: part.material,
        place: hit.point,
        normal: hit.face.normal.clone().multiplyScalar(behind ? -1 : 1),
        distance_m: hit.distance
      };
    }
    return found;
  }

  /** Whether a drawn surface stands between the two. */
  hides(from: Vector3, place: Vector3): boolean {
    const far = this.a.copy(place).sub(from).length();
    const hit = this.under(new Ray(from, this.b.copy(this.a).normalize()));
    return hit !== undefined && hit.distance_m < far - 0.05;
  }

  dispose(): void {
    this.group.traverse((object) => {
      if (object instanceof Mesh || object instanceof LineSegments) {
        (object.geometry as BufferGeometry).dispose();
        (object.material as MeshLambertMaterial).dispose();
      }
    });
  }
}
