/** Measurement points in the room: a disc that lies on the surface and a marker of constant size. Both have the layer's
 *  colour; the marker's shape is the verdict, as on the plan. */

import {BufferAttribute, BufferGeometry, CircleGeometry, Color, DoubleSide, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshBasicMaterial, Points, Quaternion, ShaderMaterial, SRGBColorSpace, Vector3,} from 'three';

import type {Point} from '../api';
import {type Verdict, judge} from '../judge';
import {type Layer, type LuxScale, colourOf, layerLux} from './layers';

const LEAST_DISC_M = 0.035;
const LARGEST_DISC_M = 0.28;
const MARKER_PX = 15;
const SHAPES: Verdict[] = ['met', 'low', 'high', 'over', 'unknown', 'limit-unknown', 'none'];

/** A marker is drawn nearer by its own size, so that the wall it lies on does not cut it. */
const VERTEX = `
attribute float shape; attribute vec3 tint; attribute float size; attribute float metered;
uniform float pixels; uniform float nearer;
varying float vShape; varying vec3 vTint; varying float vMetered; varying float vSize;
void main() {
  vShape = shape; vTint = tint; vMetered = metered; vSize = size * pixels;
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  vec4 moved = projectionMatrix * (place + vec4(0.0, 0.0, nearer, 0.0));
  gl_Position.z = moved.z / moved.w * gl_Position.w;
  gl_PointSize = vSize;
}`;
/** Distance to the outline of each shape, negative inside; about the middle, one unit = half the sprite. */
const FRAGMENT = `
precision highp float;
uniform vec3 halo;
varying float vShape; varying vec3 vTint; varying float vMetered; varying float vSize;
float triangle(vec2 p) { return max(abs(p.x) * 0.86 + p.y * 0.5, -p.y) - 0.36; }
void main() {
  vec2 p = gl_PointCoord * 2.0 - 1.0;
  p.y = -p.y;
  float d = length(p) - 0.58;
  if (vShape > 0.5 && vShape < 1.5) d = triangle(vec2(p.x, -p.y + 0.1));
  else if (vShape > 1.5 && vShape < 2.5) d = triangle(vec2(p.x, p.y + 0.1));
  else if (vShape > 2.5 && vShape < 3.5) d = (abs(p.x) + abs(p.y) - 0.72) * 0.7;
  else if (vShape > 3.5 && vShape < 4.5) d = abs(length(p) - 0.48) - 0.15;
  else if (vShape > 4.5 && vShape < 5.5) d = abs((abs(p.x) + abs(p.y) - 0.62) * 0.7) - 0.13;
  else if (vShape > 5.5) d = max(abs(p.x), abs(p.y)) - 0.42;
  float px = 2.0 / vSize;
  float ring = 0.16;
  float outer = 1.0 - smoothstep(ring - px, ring + px, d);
  float inner = 1.0 - smoothstep(-px, px, d);
  vec3 colour = mix(halo, vTint, inner);
  if (vMetered > 0.5) colour = mix(colour, halo, 1.0 - smoothstep(0.17 - px, 0.17 + px, length(p)));
  if (outer < 0.02) discard;
  gl_FragColor = vec4(colour, outer);
}`;

export interface PointColours {
  verdict: Record<Verdict, Color>;
  halo: Color;
  text: Color;
}

export class Points3d {
  readonly group = new Group();
  places: Vector3[] = [];  // of each point with a place, else far away; relative to the scene's origin
  private discs: InstancedMesh|undefined;
  private markers: Points|undefined;
  private readonly shader = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {pixels: {value: 1}, nearer: {value: 0.15}, halo: {value: new Color()}},
    transparent: true,
    depthWrite: false,
  });
  private readonly discMaterial = new MeshBasicMaterial({
    side: DoubleSide,
    transparent: true,
    opacity: 0.94,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -2
  });
  private radius: number[] = [];
  private turned: Quaternion[] = [];
  private madeFor = '';

  constructor(private colours: PointColours) {}

  setColours(colours: PointColours): void { this.colours = colours; }

  /** pixels: of the device, per CSS pixel. */
  setPixels(pixels: number): void { this.shader.uniforms['pixels']!.value = pixels; }

  show(
      points: readonly Point[], origin: readonly number[], layer: Layer, scale: LuxScale|undefined,
      chosen: number|undefined): void {
    const key = JSON.stringify([origin, points.map((p) => [p.position, p.normal])]);
    if (key !== this.madeFor) this.make(points, origin, key);
    if (!this.discs || !this.markers) return;
    const matrix = new Matrix4();
    const colour = new Color();
    const attribute = (name: string): BufferAttribute => this.markers!.geometry.getAttribute(name) as BufferAttribute;
    const [shapes, tints, sizes, metered] =
        [attribute('shape'), attribute('tint'), attribute('size'), attribute('metered')];
    points.forEach((point, index) => {
      const judged = judge(point);
      const lux = layerLux(layer, point);
      const is_chosen = index === chosen;
      const tint = this.colours.verdict[judged.verdict];
      const [r, g, b] = scale && lux !== undefined ? colourOf(scale, lux) : [tint.r, tint.g, tint.b];
      colour.setRGB(r, g, b, SRGBColorSpace);
      this.discs!.setColorAt(index, colour);
      const shown = layer === 'verdict' || lux !== undefined;
      const radius = shown ? this.radius[index]! * (layer === 'verdict' ? 0.55 : 1) * (is_chosen ? 1.15 : 1) : 0;
      matrix.compose(this.places[index]!, this.turned[index]!, new Vector3(radius, radius, radius));
      this.discs!.setMatrixAt(index, matrix);
      shapes.setX(index, SHAPES.indexOf(judged.verdict));
      // By a scale, the marker has the disc's colour too: from afar it is all that is seen.
      tints.setXYZ(index, r, g, b);
      // Modelled points are smaller than measured ones, as on the plan.
      const large = judged.measured ? 1.25 : 1;
      sizes.setX(
          index, point.position ? MARKER_PX * (is_chosen ? 1.7 : large) * (layer === 'verdict' ? 1.15 : 0.9) : 0);
      metered.setX(index, judged.measured ? 1 : 0);
    });
    for (const changed of [shapes, tints, sizes, metered]) changed.needsUpdate = true;
    this.discs.instanceMatrix.needsUpdate = true;
    if (this.discs.instanceColor) this.discs.instanceColor.needsUpdate = true;
    (this.shader.uniforms['halo']!.value as Color).copy(this.colours.halo);
  }

  private make(points: readonly Point[], origin: readonly number[], key: string): void {
    this.madeFor = key;
    this.dispose();
    const at = (index: number): number[] => points[index]!.position!.map((v, axis) => v - origin[axis]!);
    const placed = points.map((p) => p.position !== undefined);
    this.places = points.map((_, i) => (placed[i] ? new Vector3().fromArray(at(i)) : new Vector3(0, 0, -1e6)));
    this.radius = nearest(this.places).map((far) => Math.min(LARGEST_DISC_M, Math.max(LEAST_DISC_M, 0.46 * far)));
    this.turned = points.map(
        (p) => new Quaternion().setFromUnitVectors(
            new Vector3(0, 0, 1), new Vector3().fromArray(p.normal ?? [0, 0, 1]).normalize()));
    points.forEach((p, i) => {
      if (p.normal) this.places[i]!.addScaledVector(new Vector3().fromArray(p.normal), 0.006);
    });
    if (!points.length) return;
    this.discs = new InstancedMesh(new CircleGeometry(1, 28), this.discMaterial, points.length);
    this.discs.frustumCulled = false;
    this.discs.renderOrder = 1;
    const geometry = new BufferGeometry();
    geometry.setAttribute(
        'position', new BufferAttribute(new Float32Array(this.places.flatMap((p) => p.toArray())), 3));
    for (const [name, size] of [['shape', 1], ['tint', 3], ['size', 1], ['metered', 1]] as const) {
      const attribute = new BufferAttribute(new Float32Array(size * points.length), size);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    this.markers = new Points(geometry, this.shader);
    this.markers.frustumCulled = false;
    this.markers.renderOrder = 3;
    this.group.add(this.discs, this.markers);
  }

  private dispose(): void {
    this.group.clear();
    this.discs?.geometry.dispose();
    this.discs?.dispose();
    this.markers?.geometry.dispose();
    this.discs = undefined;
    this.markers = undefined;
  }
}

/** [m] from each place to the nearest other one. By cells, since there may be thousands. */
export function nearest(places: readonly {
  x: number;
  y: number;
  z: number
}[]): number[] {
  const size = 0.7;
  const cells = new Map<string, number[]>();
  const cell = (v: number): number => Math.floor(v / size);
  places.forEach((p, i) => {
    const key = `${cell(p.x)},${cell(p.y)},${cell(p.z)}`;
    const all = cells.get(key);
    if (all)
      all.push(i);
    else
      cells.set(key, [i]);
  });
  return places.map((p, i) => {
    let least = size;
    for (let dx = -1; dx <= 1; ++dx)
      for (let dy = -1; dy <= 1; ++dy)
        for (let dz = -1; dz <= 1; ++dz)
          for (const j of cells.get(`${cell(p.x) + dx},${cell(p.y) + dy},${cell(p.z) + dz}`) ?? []) {
            const q = places[j]!;
            const far = j === i ? Infinity : Math.hypot(p.x - q.x, p.y - q.y, p.z - q.z);
            if (far > 1e-4) least = Math.min(least, far);
          }
    return least;
  });
}
