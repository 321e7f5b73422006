/** Fixtures in the room: a body that looks where it aims, a beam as strong as its level, and a ring that shows it. The
 *  beam ends at the aim; its width is a sign, as on the plan: the status does not have the luminaire's photometry. */

import {BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DoubleSide, DynamicDrawUsage, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshLambertMaterial, Points, Quaternion, ShaderMaterial, Vector3,} from 'three';
import type {Fixture} from '../api';

const BEAM_HALF_ANGLE = 0.15;  // [rad] of the sign
const NO_AIM_M = 1;            // the beam of a fixture whose aim is not known: down, so long
const RING_PX = 21;

const BEAM_VERTEX = `
attribute float strength; attribute float marked;
varying float vAlong; varying float vStrength; varying float vFacing; varying float vMarked;
void main() {
  vAlong = position.z; vStrength = strength; vMarked = marked;
  vec4 place = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
  vec3 n = normalize(mat3(modelViewMatrix) * (mat3(instanceMatrix) * vec3(normal.xy, 0.0)));
  bool parallel = projectionMatrix[3][3] == 1.0;
  vFacing = abs(dot(n, parallel ? vec3(0.0, 0.0, 1.0) : normalize(-place.xyz)));
  gl_Position = projectionMatrix * place;
}`;
const BEAM_FRAGMENT = `
precision highp float;
uniform vec3 lamp; uniform float most;
varying float vAlong; varying float vStrength; varying float vFacing; varying float vMarked;
void main() {
  float thin = mix(1.0, 0.25, vAlong) * smoothstep(0.0, 0.04, vAlong);
  float soft = mix(pow(vFacing, 1.4), 1.0, 0.25 * vMarked);
  float alpha = most * vStrength * thin * soft + vMarked * 0.10;
  if (alpha < 0.004) discard;
  gl_FragColor = vec4(lamp, alpha);
}`;
const RING_VERTEX = `
attribute float level; attribute float marked;
uniform float pixels; uniform float nearer;
varying float vLevel; varying float vMarked; varying float vSize;
void main() {
  vLevel = level; vMarked = marked;
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  vec4 moved = projectionMatrix * (place + vec4(0.0, 0.0, nearer, 0.0));
  gl_Position.z = moved.z / moved.w * gl_Position.w;
  vSize = pixels * ${RING_PX.toFixed(1)} * (1.0 + 0.3 * marked);
  gl_PointSize = vSize;
}`;
const RING_FRAGMENT = `
precision highp float;
uniform vec3 lamp; uniform vec3 halo; uniform vec3 track; uniform vec3 text;
varying float vLevel; varying float vMarked; varying float vSize;
void main() {
  vec2 p = gl_PointCoord * 2.0 - 1.0;
  float r = length(p);
  float px = 2.0 / vSize;
  float disc = 1.0 - smoothstep(0.92 - px, 0.92, r);
  if (disc < 0.02) discard;
  float turn = atan(p.x, -p.y) / 6.2831853;
  turn = turn < 0.0 ? turn + 1.0 : turn;
  float ring = smoothstep(0.56, 0.56 + px, r) * (1.0 - smoothstep(0.78 - px, 0.78, r));
  vec3 colour = mix(halo, vMarked > 0.5 ? text : halo, smoothstep(0.80, 0.80 + px, r));
  colour = mix(colour, turn < vLevel ? lamp : track, ring);
  float glow = 1.0 - smoothstep(0.42 - px, 0.42, r);
  colour = mix(colour, lamp, glow * (vLevel > 0.0 ? 0.25 + 0.75 * vLevel : 0.0));
  gl_FragColor = vec4(colour, disc);
}`;

export interface LampColours {
  lamp: Color;
  halo: Color;
  track: Color;
  text: Color;
  body: Color;
  dark: boolean;
}

export class Fixtures3d {
  readonly group = new Group();
  places: Vector3[] = [];  // as Points3d.places
  private bodies: InstancedMesh|undefined;
  private beams: InstancedMesh|undefined;
  private rings: Points|undefined;
  private madeFor = '';
  private readonly bodyMaterial = new MeshLambertMaterial();
  private readonly beamMaterial = new ShaderMaterial({
    vertexShader: BEAM_VERTEX,
    fragmentShader: BEAM_FRAGMENT,
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    uniforms: {lamp: {value: new Color()}, most: {value: 0.3}},
  });
  private readonly ringMaterial = new ShaderMaterial({
    vertexShader: RING_VERTEX,
    fragmentShader: RING_FRAGMENT,
    transparent: true,
    depthWrite: false,
    uniforms: {
      lamp: {value: new Color()},
      halo: {value: new Color()},
      track: {value: new Color()},
      text: {value: new Color()},
      pixels: {value: 1},
      nearer: {value: 0.2}
    },
  });

  setColours(colours: LampColours): void {
    for (const key of ['lamp', 'halo', 'track', 'text'] as const)
      (this.ringMaterial.uniforms[key]!.value as Color).copy(colours[key]);
    (this.beamMaterial.uniforms['lamp']!.value as Color).copy(colours.lamp);
    this.beamMaterial.uniforms['most']!.value = colours.dark ? 0.42 : 0.5;
    this.bodyMaterial.color.copy(colours.body).convertSRGBToLinear();
  }

  setPixels(pixels: number): void { this.ringMaterial.uniforms['pixels']!.value = pixels; }

  show(fixtures: readonly Fixture[], origin: readonly number[], marked: ReadonlySet<number>): void {
    const key = JSON.stringify([origin, fixtures.map((f) => [f.position, f.aim])]);
    if (key !== this.madeFor) this.make(fixtures, origin, key);
    if (!this.beams || !this.rings) return;
    const strength = this.beams.geometry.getAttribute('strength') as InstancedBufferAttribute;
    const beam_marked = this.beams.geometry.getAttribute('marked') as InstancedBufferAttribute;
    const level = this.rings.geometry.getAttribute('level') as BufferAttribute;
    const ring_marked = this.rings.geometry.getAttribute('marked') as BufferAttribute;
    fixtures.forEach((fixture, index) => {
      const share = Math.min(1, Math.max(0, fixture.level ?? 0));
      // The eye sees the dim ones too.
      strength.setX(index, share > 0 ? 0.25 + 0.75 * Math.sqrt(share) : 0);
      level.setX(index, share);
      beam_marked.setX(index, marked.has(index) ? 1 : 0);
      ring_marked.setX(index, marked.has(index) ? 1 : 0);
    });
    for (const changed of [strength, beam_marked, level, ring_marked]) changed.needsUpdate = true;
  }

  private make(fixtures: readonly Fixture[], origin: readonly number[], key: string): void {
    this.madeFor = key;
    this.dispose();
    const at = (v: readonly number[]): Vector3 =>
        new Vector3(v[0]! - origin[0]!, v[1]! - origin[1]!, v[2]! - origin[2]!);
    this.places = fixtures.map((f) => (f.position ? at(f.position) : new Vector3(0, 0, -1e6)));
    if (!fixtures.length) return;
    const count = fixtures.length;
    const body = new CylinderGeometry(0.055, 0.08, 0.2, 16);
    body.rotateX(Math.PI / 2);  // along +z, the wide end in front
    body.translate(0, 0, -0.02);
    this.bodies = new InstancedMesh(body, this.bodyMaterial, count);
    const cone = new ConeGeometry(1, 1, 40, 8, true);
    cone.translate(0, -0.5, 0);
    cone.rotateX(-Math.PI / 2);  // the tip at 0, opening along +z to 1
    for (const name of ['strength', 'marked'])
      cone.setAttribute(name, new InstancedBufferAttribute(new Float32Array(count), 1).setUsage(DynamicDrawUsage));
    this.beams = new InstancedMesh(cone, this.beamMaterial, count);
    const matrix = new Matrix4();
    fixtures.forEach((fixture, index) => {
      const place = this.places[index]!;
      const along = fixture.aim ? at(fixture.aim).sub(place) : new Vector3(0, 0, -NO_AIM_M);
      const length = Math.max(1e-3, along.length());
      const turned = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), along.normalize());
      const wide = length * Math.tan(BEAM_HALF_ANGLE);
      this.bodies!.setMatrixAt(index, matrix.compose(place, turned, new Vector3(1, 1, 1)));
      this.beams!.setMatrixAt(index, matrix.compose(place, turned, new Vector3(wide, wide, length)));
    });
    const rings = new BufferGeometry();
    rings.setAttribute('position', new BufferAttribute(new Float32Array(this.places.flatMap((p) => p.toArray())), 3));
    for (const name of ['level', 'marked'])
      rings.setAttribute(name, new BufferAttribute(new Float32Array(count), 1).setUsage(DynamicDrawUsage));
    this.rings = new Points(rings, this.ringMaterial);
    this.beams.renderOrder = 2;
    this.rings.renderOrder = 3;
    for (const part of [this.bodies, this.beams, this.rings]) part.frustumCulled = false;
    this.group.add(this.bodies, this.beams, this.rings);
  }

  private dispose(): void {
    this.group.clear();
    for (const part of [this.bodies, this.beams, this.rings]) part?.geometry.dispose();
    this.bodies?.dispose();
    this.beams?.dispose();
    this.bodies = this.beams = this.rings = undefined;
  }
}
