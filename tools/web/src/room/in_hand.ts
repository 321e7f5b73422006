/** A fixture in hand, in the 3-D room: its spot, and the dragging of it. */

import {type Object3D, Ray, Vector3} from 'three';
import type {Fixture, Vec3} from '../api';
import {beamOf} from '../preview';
import {AimSpot} from './aim_spot';
import type {SurfaceHit} from './surfaces';

const SPOT_PX = {
  mouse: 20,
  touch: 34
} as const;
const OUT_OF_LAMP_M = 0.12;  // its own body, or the track that it hangs on

export interface RoomOfHand {
  root: HTMLElement;
  under(ray: Ray): SurfaceHit|undefined;
  rayThrough(x: number, y: number): Ray;
  onScreen(place: Vector3): {x: number; y: number}|undefined;
  change(): void;
}

export class InHand {
  onSpot: (place: Vec3) => void = () => undefined;  // world
  private readonly spot = new AimSpot();
  private fixture: Fixture|undefined;
  private lamp = new Vector3();
  private origin: Vec3 = [0, 0, 0];
  private angles: {pan_deg: number; tilt_deg: number}|undefined;
  private dragged: SurfaceHit|undefined;
  private dragging: number|undefined;  // the pointer's id

  constructor(private readonly room: RoomOfHand) {
    // Before the camera's listeners, which are on the canvas.
    room.root.addEventListener('pointerdown', (event) => this.down(event), {capture: true});
    room.root.addEventListener('pointermove', (event) => this.move(event), {capture: true});
    for (const over of ['pointerup', 'pointercancel'] as const)
      room.root.addEventListener(over, (event) => this.up(event), {capture: true});
  }

  get group(): Object3D { return this.spot.group; }
  setColour(colour: Parameters<AimSpot['setColour']>[0]): void { this.spot.setColour(colour); }

  /** Undefined: nothing. Another fixture's spot is where that looks. */
  take(fixture: Fixture|undefined): void {
    if (fixture?.name !== this.fixture?.name) this.dragged = this.angles = undefined;
    this.fixture = fixture;
    if (!fixture) this.dragging = undefined;
    this.room.change();
  }

  /** Where it would look at these angles; undefined: where it does. */
  turn(angles: {pan_deg: number; tilt_deg: number}|undefined): void {
    this.angles = angles;
    this.dragged = undefined;
    this.room.change();
  }

  /** fixture: as it is now. */
  draw(fixture: Fixture|undefined, origin: Vec3): void {
    this.origin = origin;
    if (!this.fixture || !fixture?.position) return this.spot.hide();
    this.fixture = fixture;
    const to = (place: Vec3): Vector3 => new Vector3(...place).sub(new Vector3(...origin));
    this.lamp = to(fixture.position);
    if (this.dragged) return this.spot.show(this.lamp, this.dragged.place, this.dragged.normal);
    const beam = beamOf(fixture, this.angles?.pan_deg, this.angles?.tilt_deg);
    const along = beam ? new Vector3(...beam) : fixture.aim ? to(fixture.aim).sub(this.lamp).normalize() : undefined;
    if (!along) return this.spot.hide();
    const hit = this.room.under(new Ray(this.lamp.clone().addScaledVector(along, OUT_OF_LAMP_M), along));
    if (hit)
      this.spot.show(this.lamp, hit.place, hit.normal);
    else if (fixture.aim && !this.angles)
      this.spot.show(this.lamp, to(fixture.aim), along.clone().negate());
    else
      this.spot.hide();
  }

  private at(event: PointerEvent): {x: number; y: number} {
    const frame = this.room.root.getBoundingClientRect();
    return {x: event.clientX - frame.left, y: event.clientY - frame.top};
  }

  /** For the page's test: where the spot is in the picture. */
  get seen(): {x: number; y: number}|undefined { return this.spot.place && this.room.onScreen(this.spot.place); }

  private down(event: PointerEvent): void {
    const seen = this.seen;
    if (!this.fixture || !seen || !event.isPrimary || event.button !== 0) return;
    const at = this.at(event);
    if (Math.hypot(at.x - seen.x, at.y - seen.y) > SPOT_PX[event.pointerType === 'mouse' ? 'mouse' : 'touch']) return;
    this.dragging = event.pointerId;
    (event.target as Element).setPointerCapture(event.pointerId);
    event.stopPropagation();
    event.preventDefault();
  }

  private move(event: PointerEvent): void {
    if (event.pointerId !== this.dragging) return;
    event.stopPropagation();
    const at = this.at(event);
    const hit = this.room.under(this.room.rayThrough(at.x, at.y));
    if (!hit) return;  // beside the room: the spot stays
    this.dragged = hit;
    this.angles = undefined;
    this.room.change();
    const [x, y, z] = hit.place.toArray();
    this.onSpot([x + this.origin[0], y + this.origin[1], z + this.origin[2]]);
  }

  private up(event: PointerEvent): void {
    if (event.pointerId !== this.dragging) return;
    this.dragging = undefined;
    event.stopPropagation();
  }
}
