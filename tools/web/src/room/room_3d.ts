/** The room in three dimensions: what is drawn, what the pointer is on, and the keys. Loaded when it is asked for, with
 *  three. Draws only when something has changed. */

import {Box3, Color, DirectionalLight, type Group, HemisphereLight, Ray, Raycaster, Scene, Vector2, Vector3, WebGLRenderer} from 'three';
import type {Point, Room, Status, Vec3} from '../api';
import {element, setAttribute, setText} from '../dom';
import * as format from '../format';
import {judge} from '../judge';
import type {Spot} from '../plan_layout';
import {type Chosen, type Selection} from '../selection';
import {fixtureTip, placeTip, pointTip, surfaceTip} from '../views/tip';
import {worksOf} from '../works';
import {Fixtures3d} from './fixtures_3d';
import {InHand} from './in_hand';
import {type Label, Labels, fitting} from './labels';
import {type Layer, type LuxScale, layerLux, scaleOf} from './layers';
import type {MadeRoom} from './made_room';
import {Points3d} from './points_3d';
import {isSoftware, readTheme, watchTheme} from './room_look';
import {type SurfaceHit, Surfaces} from './surfaces';
import type {View} from './view_names';
import {RoomCamera} from './views';

const PICK_PX = 15;  // how near the pointer has to be
const LONG_PRESS_MS = 450;
const PRESS_MOVES_PX = 9;
const LABEL_ABOVE_PX = 19;
const SOFTWARE_EVERY_MS = 1000;

type Hit = {
  kind: 'fixture'|'point'; index: number; x: number; y: number
}|{
  kind: 'surface';
  hit: SurfaceHit;
  x: number;
  y: number
};

/** What takes the pointer and keys before the room does, and is drawn with it. */
export interface Painter {
  readonly group: Group;
  /** The most that is painted [lx]: the scale reaches it. */
  readonly most: number;
  /** hit: of the surface under the pointer; undefined: none is. */
  down: (hit: SurfaceHit|undefined) => void;
  /** Dragging, or only above it. */
  move: (hit: SurfaceHit|undefined, dragging: boolean) => void;
  /** taken_back: a second finger came, to move the room. */
  up: (taken_back: boolean) => void;
  /** True if the key was the painter's. middle: what is in the middle of the picture. */
  key: (event: KeyboardEvent, middle: () => SurfaceHit | undefined) => boolean;
  /** After a change of the scale or the scene. */
  look: (scale: LuxScale|undefined, origin: Vec3) => void;
}

export class Room3d {
  readonly root = element('div', {
    class: 'room-3d',
    tabindex: '0',
    role: 'application',
    'aria-roledescription': '3-D view',
    'aria-label': 'The room in 3-D'
  });
  readonly heard = element('p', {class: 'only-heard', role: 'status'});
  private readonly canvas = element('canvas', {'aria-hidden': 'true'});
  private readonly labels = new Labels();
  private readonly tip = element('div', {class: 'tip', 'aria-hidden': 'true'});
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly sky = new HemisphereLight(0xffffff, 0x8d877f, 2);
  private readonly lamp = new DirectionalLight(0xffffff, 1.2);
  private readonly look: RoomCamera;
  private readonly points: Points3d;
  private readonly fixtures = new Fixtures3d();
  private surfaces: Surfaces|undefined;
  private origin: Vec3 = [0, 0, 0];
  private status: Status|undefined;
  private layer: Layer = 'verdict';
  private scale: LuxScale|undefined;
  private hasBox = false;
  private dirty = true;
  private news = true;  // as takeNews() takes
  private texts: {place: Vector3; text: string; kind: Label['kind']; above: number}[] = [];
  private readonly scratch = new Vector3();
  private scheduled = false;
  private last_s = 0;
  private shown = true;
  private bright = 1;  // of the picture's own light
  private readonly software: boolean;
  private told_ms = -Infinity;
  private pointer: {x: number; y: number}|undefined;
  private probe: Hit|undefined;
  private byKeys = false;
  private press: {timer: number; x: number; y: number}|undefined;
  private frames = 0;
  private painter: Painter|undefined;
  private paints = false;  // the pointer is down
  onScale: (layer: Layer, scale: LuxScale|undefined) => void = () => undefined;
  onLost: () => void = () => undefined;
  onTake: (fixture: number) => void = () => undefined;  // a person pressed one
  readonly hand: InHand;
  private taken: number|undefined;

  constructor(private readonly selection: Selection) {
    this.root.append(this.canvas, this.labels.root, this.tip);
    this.software = isSoftware();
    // By the processor, each pixel once.
    this.renderer = new WebGLRenderer({canvas: this.canvas, antialias: !this.software, powerPreference: 'low-power'});
    const dense = this.software ? 1 : Math.min(2, window.devicePixelRatio);
    this.renderer.setPixelRatio(dense);
    const still = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.look = new RoomCamera(this.canvas, !still);
    const {colours} = readTheme();
    this.points = new Points3d(colours);
    this.points.setPixels(dense);
    this.fixtures.setPixels(dense);
    this.hand = new InHand({
      root: this.root,
      under: (ray) => this.surfaces?.under(ray),
      rayThrough: (x, y) => this.rayThrough(x, y),
      onScreen: (place) => this.onScreen(place),
      change: () => this.change(true),
    });
    this.scene.add(this.sky, this.lamp, this.lamp.target, this.points.group, this.fixtures.group, this.hand.group);
    this.setTheme();
    watchTheme(() => this.setTheme());
    new ResizeObserver(() => this.resize()).observe(this.root);
    new IntersectionObserver((entries) => {
      this.shown = entries[entries.length - 1]?.isIntersecting ?? true;  // a busy page hears of several at once
      this.schedule();
    }).observe(this.root);
    this.look.controls.addEventListener('update', () => this.change());
    for (const event of ['control', 'controlstart', 'rest'] as const)
      this.look.controls.addEventListener(event, () => this.change());
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.onLost();
    });
    selection.onChange(() => this.change(true));
    this.listen();
  }

  /** Undefined: there is no scene, and lamps and points alone are drawn. */
  setScene(made: MadeRoom|undefined): void {
    if (this.surfaces) {
      this.scene.remove(this.surfaces.group);
      this.surfaces.dispose();
    }
    this.surfaces = undefined;
    this.hasBox = false;
    if (made) {
      this.origin = made.origin;
      this.surfaces = new Surfaces(made);
      this.scene.add(this.surfaces.group);
      this.look.setBox(made.min, made.max);
      this.hasBox = true;
      setAttribute(this.root, 'data-triangles', made.triangles);
    }
    this.setTheme();
    if (this.status) this.show(this.status, undefined, true);
  }

  /** at_once: what a person did, not what the daemon said. */
  show(status: Status, room?: Room, at_once = false): void {
    this.status = status;
    // The processor that draws may be the one that has the light to send: it draws news once a second.
    if (this.software && !at_once && performance.now() - this.told_ms < SOFTWARE_EVERY_MS) return;
    this.told_ms = performance.now();
    if (!this.hasBox) {
      const box = new Box3();
      for (const thing of [...status.points, ...status.fixtures])
        if (thing.position) box.expandByPoint(new Vector3().fromArray(thing.position));
      if (room) box.expandByPoint(new Vector3(...room.min, 0)).expandByPoint(new Vector3(...room.max, 0));
      if (!box.isEmpty()) {
        const centre = box.getCenter(new Vector3());
        if (!this.surfaces) this.origin = [Math.round(centre.x), Math.round(centre.y), 0];
        const off = new Vector3().fromArray(this.origin);
        this.look.setBox(box.min.sub(off).toArray(), box.max.sub(off).toArray());
        this.hasBox = true;
      }
    }
    const scale = scaleOf(this.layer, status.points, this.scale, this.painter?.most);
    if (scale !== this.scale) {
      this.scale = scale;
      this.onScale(this.layer, scale);
      this.painter?.look(scale, this.origin);
    }
    const bright = (status.blackout ? 0.3 : 1) * this.bright;
    this.sky.intensity = 1.9 * bright;
    this.lamp.intensity = 1.3 * bright;
    const goals = status.points.filter((p) => p.goal_lux !== undefined);
    setAttribute(
        this.root, 'aria-label',
        `The room in 3-D: ${status.fixtures.length} fixtures; ${goals.filter((p) => p.verdict === 'met').length} of ${
            goals.length} goals met. ` +
            'Arrow keys turn it, plus and minus zoom, N and P go from point to point, F from fixture to fixture, 0 shows the whole room.');
    this.change(true);
  }

  setLayer(layer: Layer): void {
    this.layer = layer;
    this.scale = undefined;
    if (this.status) this.show(this.status, undefined, true);
    this.onScale(this.layer, this.scale);
  }

  /** Its spot can be dragged. */
  take(fixture: number|undefined): void {
    this.taken = fixture;
    this.hand.take(fixture === undefined ? undefined : this.status?.fixtures[fixture]);
  }

  setView(view: View): string {
    const side = view === 'side' ? this.look.turn() : '';
    if (view !== 'side') this.look.look(view);
    this.change();
    return side;
  }

  /** Undefined: a person looks, and no longer paints. */
  setPainter(painter: Painter|undefined): void {
    if (this.painter) this.scene.remove(this.painter.group);
    this.painter = painter;
    this.pointer = this.probe = undefined;
    this.look.setPainting(painter !== undefined);
    this.root.classList.toggle('paints', painter !== undefined);
    if (painter) this.scene.add(painter.group);
    this.painted();
  }

  /** What the painter shows has changed. */
  painted(): void {
    if (this.status) this.show(this.status, undefined, true);
    this.painter?.look(this.scale, this.origin);
    this.change();
  }

  private surfaceAt(x: number, y: number): SurfaceHit|undefined { return this.surfaces?.under(this.rayThrough(x, y)); }

  private change(news = false): void {
    this.dirty = true;
    this.news ||= news;
    this.schedule();
  }

  private schedule(): void {
    if (this.scheduled || !this.shown || !this.root.isConnected) return;
    this.scheduled = true;
    requestAnimationFrame((at) => this.frame(at));
  }

  private frame(at_ms: number): void {
    this.scheduled = false;
    const delta = Math.min(0.1, Math.max(0.001, at_ms / 1000 - this.last_s));
    this.last_s = at_ms / 1000;
    const moved = this.look.controls.update(delta);
    if (this.pointer) this.pick(this.pointer);
    if (moved || this.dirty) {
      this.dirty = false;
      this.draw();
      setAttribute(this.root, 'data-frames', ++this.frames);  // for the page's test
    }
    if (moved) this.schedule();
  }

  private draw(): void {
    const {look} = this;
    const chosen = this.selection.current;
    if (this.news) this.takeNews();
    // The light of the picture comes over the viewer's shoulder.
    look.camera.updateMatrixWorld();
    this.lamp.position.setFromMatrixPosition(look.camera.matrixWorld);
    this.lamp.position.add(new Vector3(-0.5, 0.6, 0.3).transformDirection(look.camera.matrixWorld).multiplyScalar(4));
    const ahead = new Vector3();
    look.camera.getWorldDirection(ahead);
    this.lamp.target.position.setFromMatrixPosition(look.camera.matrixWorld).addScaledVector(ahead, 5);
    this.renderer.render(this.scene, look.camera);
    this.showTip(chosen);
    this.showLabels();
    const spot = this.hand.seen;
    setAttribute(this.root, 'data-spot', spot ? `${spot.x.toFixed(1)} ${spot.y.toFixed(1)}` : '');  // as above
  }

  /** [px] in the picture; undefined behind the viewer. */
  private onScreen(place: Vector3): {x: number; y: number}|undefined {
    const seen = this.scratch.copy(place).project(this.look.camera);
    if (!(seen.z > -1 && seen.z < 1)) return undefined;
    return {x: (seen.x * 0.5 + 0.5) * this.root.clientWidth, y: (0.5 - seen.y * 0.5) * this.root.clientHeight};
  }

  private rayThrough(x: number, y: number): Ray {
    const caster = new Raycaster();
    caster.setFromCamera(
        new Vector2((2 * x) / this.root.clientWidth - 1, 1 - (2 * y) / this.root.clientHeight), this.look.camera);
    return caster.ray;
  }

  private isHidden(place: Vector3, at: {x: number; y: number}): boolean {
    return this.surfaces?.hides(this.rayThrough(at.x, at.y).origin, place) ?? false;
  }

  private pick(at: {x: number; y: number}, near_px = PICK_PX): void {
    const candidates: (Exclude<Hit, {kind: 'surface'}>&{
      far: number;
      place: Vector3
    })[] = [];
    for (const [kind, places] of [['point', this.points.places], ['fixture', this.fixtures.places]] as const)
      places.forEach((place, index) => {
        const seen = this.onScreen(place);
        const far = seen ? Math.hypot(seen.x - at.x, seen.y - at.y) : Infinity;
        if (seen && far < near_px) candidates.push({kind, index, ...seen, far, place});
      });
    candidates.sort((a, b) => a.far - b.far);
    const found = candidates.slice(0, 8).find((c) => !this.isHidden(c.place, c));
    const hit = found ? undefined : this.surfaces?.under(this.rayThrough(at.x, at.y));
    this.probe = found ?? (hit && {kind: 'surface', hit, ...at});
    this.pointer = undefined;
    this.byKeys = false;
    this.selection.set(found && {kind: found.kind, index: found.index});
    this.dirty = true;
  }

  private showTip(chosen: Chosen): void {
    const {status, probe} = this;
    // What is chosen in a table is marked; only what the pointer or the keys are on has its card.
    let at: {x: number; y: number}|undefined;
    if (chosen && status && (this.byKeys || (probe && probe.kind === chosen.kind && probe.index === chosen.index))) {
      const place = (chosen.kind === 'point' ? this.points : this.fixtures).places[chosen.index];
      at = place && this.onScreen(place);
      const [point, fixture] = [status.points[chosen.index], status.fixtures[chosen.index]];
      if (chosen.kind === 'point' && point)
        pointTip(this.tip, point);
      else if (chosen.kind === 'fixture' && fixture)
        fixtureTip(this.tip, fixture);
      else
        at = undefined;
    } else if (probe?.kind === 'surface') {
      const {material, place} = probe.hit;
      const y = 0.2126 * material.colour[0] + 0.7152 * material.colour[1] + 0.0722 * material.colour[2];
      surfaceTip(
          this.tip, material.name, material.alpha < 1 ? undefined : y,
          place.toArray().map((v, i) => v + this.origin[i]!));
      at = probe;
    }
    if (at)
      placeTip(this.tip, at, this.canvas, this.root);
    else
      this.tip.classList.remove('shown');
  }

  /** What depends on the status, the layer and the choice, and not on the camera. */
  private takeNews(): void {
    this.news = false;
    const {status} = this;
    const chosen = this.selection.current;
    if (!status) return;
    const marked = new Set<number>();
    status.fixtures.forEach((f, i) => {
      if ((chosen?.kind === 'fixture' && chosen.index === i) || (status.question && status.question.fixture === f.name))
        marked.add(i);
    });
    const chosen_point = chosen?.kind === 'point' ? chosen.index : undefined;
    this.points.show(status.points, this.origin, this.layer, this.scale, chosen_point);
    this.fixtures.show(status.fixtures, this.origin, marked);
    this.hand.draw(this.taken === undefined ? undefined : status.fixtures[this.taken], this.origin);

    this.texts = [];
    const add = (place: Vector3|undefined, text: string, kind: Label['kind'], above = LABEL_ABOVE_PX): void => {
      if (place && text) this.texts.push({place, text, kind, above});
    };
    const asked = status.question?.position;
    if (asked) add(new Vector3(...asked).sub(new Vector3(...this.origin)), 'luxmeter here', 'asked', 0);
    if (chosen?.kind === 'point')
      add(this.points.places[chosen.index], status.points[chosen.index]?.name ?? '', 'chosen', 26);
    if (chosen?.kind === 'fixture')
      add(this.fixtures.places[chosen.index], status.fixtures[chosen.index]?.name ?? '', 'chosen', 26);
    // Those with a reading first.
    for (const measured of [true, false])
      status.points.forEach((point, index) => {
        if (point.position && (point.measured_lux !== undefined) === measured)
          add(this.points.places[index], this.number(point), 'lux');
      });
    for (const work of worksOf(status.points)) {
      const places = work.points.filter((i) => status.points[i]!.position).map((i) => this.points.places[i]!);
      if (!places.length) continue;
      const {min, max} = new Box3().setFromPoints(places);
      add(new Vector3((min.x + max.x) / 2, (min.y + max.y) / 2, max.z), work.name, 'work', 36);
    }
  }

  /** What the layer shows of a point, as text. */
  private number(point: Point): string {
    const lux = this.layer === 'verdict' ? point.measured_lux : layerLux(this.layer, point);
    if (lux === undefined) return '';
    const sign = this.layer === 'difference' && lux > 0 ? '+' : this.layer === 'uncertainty' ? '± ' : '';
    return sign + format.lux(lux);
  }

  private showLabels(): void {
    const has_card = this.tip.classList.contains('shown');  // which has the name
    const labels: (Label&{
      place: Vector3;
      seen_at: Spot
    })[] = [];
    for (const {place, text, kind, above} of this.texts) {
      const seen_at = kind === 'chosen' && has_card ? undefined : this.onScreen(place);
      if (seen_at) labels.push({x: seen_at.x, y: seen_at.y - above, text, kind, place, seen_at});
    }
    const isSeen = ({kind, place, seen_at}: {kind: Label['kind']; place: Vector3; seen_at: Spot}): boolean =>
        kind === 'asked' || kind === 'chosen' || !this.isHidden(place, seen_at);
    this.labels.show(fitting(labels, this.root.clientWidth, this.root.clientHeight, isSeen));
  }

  private listen(): void {
    const at = (event: PointerEvent): {x: number; y: number} => {
      const frame = this.canvas.getBoundingClientRect();
      return {x: event.clientX - frame.left, y: event.clientY - frame.top};
    };
    const drop = (): void => {
      if (this.press) clearTimeout(this.press.timer);
      this.press = undefined;
    };
    const forget = (): void => {
      this.pointer = this.probe = undefined;
      this.selection.set(undefined);
      this.change();
    };
    this.canvas.addEventListener('pointermove', (event) => {
      const now = at(event);
      if (this.painter && (event.isPrimary || this.paints)) {
        this.painter.move(this.surfaceAt(now.x, now.y), this.paints);
        return this.change();
      }
      if (this.press && Math.hypot(now.x - this.press.x, now.y - this.press.y) > PRESS_MOVES_PX) drop();
      if (event.pointerType !== 'mouse' || event.buttons) return;
      this.pointer = now;
      this.schedule();
    });
    this.canvas.addEventListener('pointerdown', (event) => {
      drop();
      const now = at(event);
      if (this.painter) {
        if (event.isPrimary && event.button === 0) {
          this.paints = true;
          this.canvas.setPointerCapture(event.pointerId);
          this.painter.down(this.surfaceAt(now.x, now.y));
        } else if (this.paints && !event.isPrimary) {
          this.paints = false;
          this.painter.up(true);
        }
        return this.change();
      }
      if (event.pointerType === 'mouse') return;
      if (!event.isPrimary) return;  // a second finger: it moves the room
      const timer = window.setTimeout(() => {
        this.press = undefined;
        this.pick(now, 2 * PICK_PX);
        this.change();
      }, LONG_PRESS_MS);
      this.press = {timer, ...now};
    });
    this.canvas.addEventListener('pointerup', (event) => {
      if (this.paints && event.isPrimary) {
        this.paints = false;
        this.painter?.up(false);
        return this.change();
      }
      // A tap on a sign is as good; beside one it puts the card away.
      if (this.press && event.pointerType !== 'mouse') {
        this.pick(at(event), 1.6 * PICK_PX);
        if (this.probe?.kind === 'surface') this.probe = undefined;
        this.change();
      }
      drop();
    });
    this.canvas.addEventListener('pointercancel', () => {
      drop();
      if (this.paints) this.painter?.up(true);
      this.paints = false;
    });
    // A press that turned the room took nothing.
    let pressed: {x: number; y: number}|undefined;
    this.canvas.addEventListener('pointerdown', (event) => (pressed = at(event)));
    this.canvas.addEventListener('click', (event) => {
      const now = at(event as PointerEvent);
      if (!pressed || Math.hypot(now.x - pressed.x, now.y - pressed.y) > PRESS_MOVES_PX) return;
      const chosen = this.selection.current;
      if (chosen?.kind === 'fixture' && this.probe?.kind === 'fixture') this.onTake(chosen.index);
    });
    this.canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    this.canvas.addEventListener('pointerleave', (event) => {
      if (event.pointerType === 'mouse') forget();
    });
    this.root.addEventListener('keydown', (event) => {
      const middle = (): SurfaceHit|undefined => this.surfaceAt(this.root.clientWidth / 2, this.root.clientHeight / 2);
      if (this.painter?.key(event, middle)) {
        event.preventDefault();
        return this.change();
      }
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const key = event.key.toLowerCase();
      if (key === 'n' || key === 'p')
        this.step('point', key === 'n' ? 1 : -1);
      else if (key === 'f')
        this.step('fixture', event.shiftKey ? -1 : 1);
      else if (key === 'h') {
        if (this.selection.current?.kind === 'fixture') this.onTake(this.selection.current.index);
      } else if (key === 'escape') {
        this.byKeys = false;
        forget();
      } else if (!this.look.key(event.key, event.shiftKey))
        return;
      event.preventDefault();
      this.change();
    });
  }

  /** To the next point or fixture, by keys; it is said, too. */
  private step(kind: 'point'|'fixture', by: number): void {
    const {status} = this;
    const all = kind === 'point' ? status?.points : status?.fixtures;
    if (!status || !all?.length) return;
    const now = this.selection.current;
    const from = now?.kind === kind ? now.index : by > 0 ? -1 : 0;
    const index = (from + by + all.length) % all.length;
    this.byKeys = true;
    this.probe = undefined;
    this.selection.set({kind, index});
    const place = (kind === 'point' ? this.points : this.fixtures).places[index];
    if (place && all[index]!.position) this.look.bring(place);
    const [point, fixture] = [status.points[index], status.fixtures[index]];
    setText(
        this.heard,
        kind === 'point' && point ?
            `${point.name}: ${judge(point).words}. Goal ${format.lux(point.goal_lux)} lux, predicted ${
                format.withError(point.predicted_lux, point.standard_error_lux)}, ` +
                `measured ${point.measured_lux === undefined ? 'no reading' : format.lux(point.measured_lux)}.` :
            `${fixture?.name}: level ${format.percent(fixture?.level)}`);
  }

  private resize(): void {
    const [width, height] = [this.root.clientWidth, this.root.clientHeight];
    if (width < 20 || height < 20) return;
    this.renderer.setSize(width, height, false);
    this.look.resize(width, height);
    this.change();
  }

  private setTheme(): void {
    const {colours, lamp, ground, line} = readTheme();
    this.points.setColours(colours);
    this.fixtures.setColours(lamp);
    this.hand.setColour(new Color().copy(lamp.text).convertSRGBToLinear());
    this.surfaces?.setTheme(new Color().copy(line).convertSRGBToLinear());
    this.renderer.setClearColor(new Color().copy(ground).convertSRGBToLinear());
    this.bright = lamp.dark ? 1 : 1.5;
    if (this.status) this.show(this.status, undefined, true);
    this.change(true);
  }
}
