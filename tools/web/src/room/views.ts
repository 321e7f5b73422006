/** The camera of the room, and its ways to look: around it, from within, and drawn to scale from above or a side. */

import CameraControls from 'camera-controls';
import {Box3, Matrix4, OrthographicCamera, PerspectiveCamera, Quaternion, Raycaster, Sphere, Spherical, Vector2, Vector3, Vector4,} from 'three';
import type {View} from './view_names';

CameraControls.install({THREE: {Vector2, Vector3, Vector4, Quaternion, Matrix4, Spherical, Box3, Sphere, Raycaster}});

/** The side that the viewer stands at. Azimuth 0 looks along world +y. */
export const SIDES = ['front', 'right', 'back', 'left'] as const;

const EYES_M = 1.6;
const FIELD_DEG = 45;
const WALK_FIELD_DEG = 65;
const AT_HAND_M = 0.01;  // from the eye to the point that it turns about: it turns where it stands
const STEP = 0.12;       // of a key press: radians, or a share of the room

export class RoomCamera {
  readonly controls: CameraControls;
  private readonly perspective = new PerspectiveCamera(FIELD_DEG, 1, 0.05, 1000);
  private readonly parallel = new OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
  private readonly box = new Box3(new Vector3(-5, -5, 0), new Vector3(5, 5, 3));
  private aspect = 1;
  private quarter = 0;  // of `side`
  private painting = false;
  view: View = 'orbit';

  constructor(canvas: HTMLElement, private readonly smooth: boolean) {
    for (const camera of [this.perspective, this.parallel]) camera.up.set(0, 0, 1);
    this.controls = new CameraControls(this.perspective, canvas);
    this.controls.smoothTime = smooth ? 0.18 : 0.001;
    this.controls.draggingSmoothTime = smooth ? 0.05 : 0.001;
    this.controls.dollyToCursor = true;
  }

  get camera(): PerspectiveCamera|OrthographicCamera {
    return this.controls.camera as PerspectiveCamera | OrthographicCamera;
  }

  /** [m] relative to the scene's origin. */
  setBox(min: readonly number[], max: readonly number[]): void {
    this.box.min.fromArray(min);
    this.box.max.fromArray(max);
    const size = this.box.getSize(new Vector3()).length();
    this.perspective.far = 20 * size + 100;
    this.perspective.near = Math.max(0.02, size / 2000);
    this.parallel.near = -10 * size - 100;
    this.parallel.far = 10 * size + 100;
    this.look(this.view, false);
  }

  resize(width: number, height: number): void {
    this.aspect = width / height;
    this.perspective.aspect = this.aspect;
    this.perspective.updateProjectionMatrix();
    this.fitParallel();
  }

  /** The whole room by this view. */
  look(view: View, smoothly = this.smooth): void {
    const changed = view !== this.view;
    this.view = view;
    const {controls, box} = this;
    const size = box.getSize(new Vector3());
    const middle = box.getCenter(new Vector3());
    const flat = view === 'above' || view === 'side';
    controls.camera = flat ? this.parallel : this.perspective;
    this.perspective.fov = view === 'walk' ? WALK_FIELD_DEG : FIELD_DEG;
    this.perspective.updateProjectionMatrix();
    controls.minDistance = view === 'walk' ? AT_HAND_M : 0.3;
    controls.maxDistance = view === 'walk' ? AT_HAND_M : 4 * size.length() + 10;
    controls.minZoom = 0.4;
    controls.maxZoom = 40;
    controls.mouseButtons.wheel = flat ? CameraControls.ACTION.ZOOM :
        view === 'walk'                ? CameraControls.ACTION.NONE :
                                         CameraControls.ACTION.DOLLY;
    controls.touches.two = flat ? CameraControls.ACTION.TOUCH_ZOOM_TRUCK :
        view === 'walk'         ? CameraControls.ACTION.TOUCH_TRUCK :
                                  CameraControls.ACTION.TOUCH_DOLLY_TRUCK;
    this.setButtons();
    const glide = smoothly && !changed;  // another lens has no way from here to there
    if (view === 'walk') {
      const eye = Math.min(box.min.z + EYES_M, middle.z);
      const start = new Vector3(middle.x, box.min.y + 0.18 * size.y, eye);
      void controls.setLookAt(start.x, start.y, start.z, start.x, start.y + AT_HAND_M, start.z, glide);
    } else if (flat) {
      this.fitParallel();
      const far = size.length() + 1;
      const angle = (this.quarter * Math.PI) / 2;
      const from = view === 'above' ? [middle.x, middle.y - 1e-4, middle.z + far] :
                                      [middle.x + far * Math.sin(angle), middle.y - far * Math.cos(angle), middle.z];
      void controls.zoomTo(1, glide);
      void controls.setLookAt(from[0]!, from[1]!, from[2]!, middle.x, middle.y, middle.z, glide);
    } else {
      const {eye, target} = this.wholeFrom(new Vector3(0.34, -0.76, 0.56).normalize());
      void controls.setLookAt(eye.x, eye.y, eye.z, target.x, target.y, target.z, glide);
    }
    void controls.setFocalOffset(0, 0, 0, false);
  }

  /** While a person paints, the left button and one finger are the brush's: the right button turns the room. */
  setPainting(on: boolean): void {
    this.painting = on;
    this.setButtons();
  }

  private setButtons(): void {
    const {controls, painting} = this;
    const {ROTATE, TRUCK, TOUCH_TRUCK, TOUCH_ROTATE, NONE} = CameraControls.ACTION;
    const flat = this.view === 'above' || this.view === 'side';
    controls.mouseButtons.left = painting ? NONE : flat ? TRUCK : ROTATE;
    controls.mouseButtons.right = painting && !flat ? ROTATE : TRUCK;
    controls.touches.one = painting ? NONE : flat ? TOUCH_TRUCK : TOUCH_ROTATE;
  }

  /** The next side, of the view from a side. */
  turn(): string {
    if (this.view === 'side') this.quarter = (this.quarter + 1) % SIDES.length;
    this.look('side');
    return SIDES[this.quarter]!;
  }

  get side(): string { return SIDES[this.quarter]!; }

  /** Brings a place into the middle, if it is not in sight as it is. */
  bring(place: Vector3): void {
    if (this.view === 'walk') {
      const eye = this.controls.getPosition(new Vector3());
      const towards = place.clone().sub(eye).setLength(AT_HAND_M).add(eye);
      void this.controls.setTarget(towards.x, towards.y, towards.z, this.smooth);
      return;
    }
    const seen = place.clone().project(this.camera);
    if (Math.max(Math.abs(seen.x), Math.abs(seen.y)) > 0.9)
      void this.controls.moveTo(place.x, place.y, place.z, this.smooth);
  }

  /** Moves as the key says; false if it is none of the camera's. */
  key(key: string, shift: boolean): boolean {
    const {controls} = this;
    const [across, up] = ({ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]} as
                          Record<string, [number, number]>)[key] ??
        [0, 0];
    const flat = this.view === 'above' || this.view === 'side';
    const step_m = this.view === 'walk' ? 0.4 : STEP * this.box.getSize(new Vector3()).length() * 0.3;
    if (across || up) {
      if (this.view === 'walk' && !shift) {
        if (across) void controls.rotate(-across * STEP, 0, this.smooth);
        if (up) void controls.forward(up * step_m, this.smooth);
      } else if (flat || shift)
        void controls.truck(across * step_m, -up * step_m, this.smooth);
      else
        void controls.rotate(across * STEP, -up * STEP, this.smooth);
      return true;
    }
    const walked =
        ({w: [0, 1], s: [0, -1], a: [-1, 0], d: [1, 0]} as Record<string, [number, number]>)[key.toLowerCase()];
    if (walked && this.view === 'walk') {
      if (walked[1]) void controls.forward(walked[1] * step_m, this.smooth);
      if (walked[0]) void controls.truck(walked[0] * step_m, 0, this.smooth);
      return true;
    }
    if (key === '+' || key === '=' || key === '-') {
      const closer = key !== '-';
      if (flat)
        void controls.zoom((closer ? 0.25 : -0.2) * this.parallel.zoom, this.smooth);
      else if (this.view === 'walk')
        void controls.forward(closer ? step_m : -step_m, this.smooth);
      else
        void controls.dolly((closer ? 0.2 : -0.25) * controls.distance, this.smooth);
      return true;
    }
    if (key === '0' || key === 'Home') {
      this.look(this.view);
      return true;
    }
    return false;
  }

  /** As near as the whole room fits, seen from `back` (a unit vector), and in the middle of the picture. */
  private wholeFrom(back: Vector3): {eye: Vector3; target: Vector3} {
    const right = new Vector3(0, 0, 1).cross(back).normalize();
    const up = back.clone().cross(right);
    const tan_up = Math.tan((FIELD_DEG * Math.PI) / 360) * 0.93;
    const tan_right = tan_up * this.aspect;
    const target = this.box.getCenter(new Vector3());
    const {min, max} = this.box;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
        (i) => new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z));
    let far = 1;
    for (let round = 0; round < 8; ++round) {
      const seen = corners.map((corner) => {
        const d = corner.clone().sub(target);
        return {x: d.dot(right), y: d.dot(up), z: d.dot(back)};
      });
      far = Math.max(...seen.map((s) => s.z + Math.max(Math.abs(s.x) / tan_right, Math.abs(s.y) / tan_up)));
      const middle = (of: (s: {x: number; y: number; z: number}) => number): number => {
        const places = seen.map((s) => of(s) / (far - s.z));
        return (Math.min(...places) + Math.max(...places)) / 2;
      };
      target.addScaledVector(right, middle((s) => s.x) * far).addScaledVector(up, middle((s) => s.y) * far);
    }
    return {eye: target.clone().addScaledVector(back, far), target};
  }

  private fitParallel(): void {
    const size = this.box.getSize(new Vector3());
    const [wide, high] = this.view === 'above' ? [size.x, size.y] : [this.quarter % 2 ? size.y : size.x, size.z];
    const half = (0.5 * Math.max(high, wide / this.aspect)) * 1.12 + 0.2;
    this.parallel.left = -half * this.aspect;
    this.parallel.right = half * this.aspect;
    this.parallel.top = half;
    this.parallel.bottom = -half;
    this.parallel.updateProjectionMatrix();
  }
}
