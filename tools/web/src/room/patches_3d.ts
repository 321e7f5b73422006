/** Draws painted patches, each a square on its surface in its lux's colour, with one call of WebGL; and the brush's rim. */

import {BufferGeometry, CircleGeometry, Color, Float32BufferAttribute, Group, InstancedBufferAttribute, InstancedBufferGeometry, LineBasicMaterial, LineLoop, Mesh, ShaderMaterial, Vector3} from 'three';
import type {Vec3} from '../api';
import {type LuxScale, colourOf} from './layers';
import {type Patches, paintedPatches} from './patches';

const LIFTED_M = 0.004;  // before the surface

const VERTEX = `
attribute vec3 place;
attribute vec3 facing;
attribute float edge;
attribute vec3 tint;
varying vec3 seen;
void main() {
  vec3 n = normalize(facing);
  vec3 u = normalize(cross(abs(n.z) > 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 0.0, 1.0), n));
  vec3 v = cross(n, u);
  vec3 at = place + ${LIFTED_M.toFixed(4)} * n + edge * (position.x * u + position.y * v);
  seen = tint;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1.0);
}`;
const FRAGMENT = `
varying vec3 seen;
void main() { gl_FragColor = vec4(seen, 1.0); }`;

export class Patches3d {
  readonly group = new Group();
  private readonly material = new ShaderMaterial({vertexShader: VERTEX, fragmentShader: FRAGMENT});
  private readonly rim = new LineLoop(rimGeometry(), new LineBasicMaterial({depthTest: false}));
  private mesh: Mesh|undefined;

  constructor() {
    this.rim.visible = false;
    this.rim.renderOrder = 4;
    this.group.add(this.rim);
  }

  /** origin: of the scene [m, world]. */
  show(patches: Patches|undefined, origin: Vec3, scale: LuxScale|undefined): void {
    if (this.mesh) {
      this.group.remove(this.mesh);
      this.mesh.geometry.dispose();
      this.mesh = undefined;
    }
    const painted = patches ? paintedPatches(patches) : [];
    if (!patches || !painted.length || !scale) return;
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute([-.5, -.5, 0, .5, -.5, 0, .5, .5, 0, -.5, .5, 0], 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const of = (size: number, value: (p: number) => readonly number[]): InstancedBufferAttribute => {
      const all = new Float32Array(size * painted.length);
      painted.forEach((p, i) => all.set(value(p), size * i));
      return new InstancedBufferAttribute(all, size);
    };
    const off = patches.origin.map((v, axis) => v - origin[axis]!);
    geometry.setAttribute('place', of(3, (p) => patches.place(p).map((v, axis) => v + off[axis]!)));
    geometry.setAttribute('facing', of(3, patches.normal));
    geometry.setAttribute('edge', of(1, (p) => [Math.min(patches.cell_m, patches.edge_m(p))]));
    geometry.setAttribute('tint', of(3, (p) => colourOf(scale, patches.lux[p]!)));
    geometry.instanceCount = painted.length;
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.group.add(this.mesh);
  }

  /** Where the brush would paint; undefined: nowhere. Relative to the scene's origin. */
  showRim(place: Vector3|undefined, normal: Vector3|undefined, radius_m: number, colour: Color): void {
    this.rim.visible = place !== undefined && normal !== undefined;
    if (!place || !normal) return;
    (this.rim.material as LineBasicMaterial).color.copy(colour);
    this.rim.position.copy(place).addScaledVector(normal, LIFTED_M);
    this.rim.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    this.rim.scale.setScalar(radius_m);
  }
}

function rimGeometry(): BufferGeometry {
  const disc = new CircleGeometry(1, 48).getAttribute('position');
  const rim: number[] = [];
  for (let i = 1; i < disc.count - 1; ++i) rim.push(disc.getX(i), disc.getY(i), 0);  // without the middle
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(rim, 3));
  return geometry;
}
