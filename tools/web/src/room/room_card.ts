/** The room: the plan from above, or in three dimensions. The latter is fetched when it is first asked for; without it
 *  the plan stays, and a sentence says why. */

import {type Room, type Status, fetchScene} from '../api';
import {card, element, setAttribute, setText} from '../dom';
import type {Selection} from '../selection';
import type {Preview} from '../preview';
import {HandView} from '../views/hand';
import {PlanView} from '../views/plan';
import {LAYERS, type Layer} from './layers';
import {LuxLegend} from './lux_legend';
import type {MadeRoom} from './made_room';
import type {Paint} from './paint';
import type {Room3d} from './room_3d';
import {type View, VIEW_NAMES} from './view_names';

const REMEMBERED = 'luxrig-room';

export class RoomCard {
  readonly root: HTMLElement;
  private readonly plan: PlanView;
  private readonly said = element('p', {class: 'room-said', role: 'status', hidden: ''});
  private readonly stage = element('div', {class: 'room-stage', hidden: ''});
  private readonly tools = element('div', {class: 'room-tools', hidden: ''});
  private readonly keys = keysHelp();
  private readonly layers = element('select', {id: 'room-layer'});
  private readonly paintPlace = element('div', {hidden: ''});
  private paint: Paint|undefined;
  private readonly scale = new LuxLegend();
  private readonly ways = new Map<'plan'|'room', HTMLButtonElement>();
  private readonly views = new Map<View, HTMLButtonElement>();
  private readonly hand = new HandView();
  private layer: Layer = 'verdict';
  private preview: Preview|undefined;
  private room: Room|undefined;
  private status: Status|undefined;
  private solid: Room3d|undefined;
  private loading: Promise<void>|undefined;
  private sceneOf = '';
  private fetching = false;

  constructor(private readonly selection: Selection) {
    this.plan = new PlanView(selection);
    const ways = element('div', {class: 'filters room-ways', role: 'group', 'aria-label': 'Show the room as'});
    for (const [way, words] of [['plan', 'Plan'], ['room', '3-D']] as const) {
      const button =
          element('button', {type: 'button', id: `show-${way}`, 'aria-pressed': String(way === 'plan')}, words);
      button.addEventListener('click', () => void this.choose(way));
      this.ways.set(way, button);
      ways.append(button);
    }
    this.tools.append(this.viewButtons(), this.layerChoice(), this.paintButton());
    this.hand.root.hidden = true;
    this.hand.onTake = (fixture) => this.solid?.take(fixture);
    this.hand.onTurn = (angles) => this.solid?.hand.turn(angles);
    this.hand.onLight = (light) => this.showPreview(light);
    this.root = card(
        'plan', 'Room', ways, this.said, this.tools, this.paintPlace, this.stage, this.scale.root, this.hand.root,
        this.plan.root, this.plan.legend, this.keys);
    try {
      if (localStorage.getItem(REMEMBERED) === 'room') void this.choose('room');
    } catch {
      // Storage is closed to us: the plan is shown first.
    }
  }

  setRoom(room: Room): void {
    this.room = room;
    this.plan.setRoom(room);
    if (this.solid) void this.loadScene(this.solid);
  }

  show(status: Status): void {
    this.status = status;
    this.hand.show(status);
    if (this.stage.hidden)
      this.plan.show(status);
    else
      this.solid?.show(this.seen(status), this.room);
  }

  private async choose(way: 'plan'|'room'): Promise<void> {
    try {
      localStorage.setItem(REMEMBERED, way);
    } catch {
      // as above
    }
    this.mark(way);
    if (way === 'plan') return this.say('');
    this.loading ??= this.load();
    try {
      await this.loading;
    } catch (error) {
      this.loading = undefined;  // it may be tried again
      this.mark('plan');
      this.say(error instanceof Error ? error.message : String(error));
    }
  }

  private mark(way: 'plan'|'room'): void {
    for (const [name, button] of this.ways) setAttribute(button, 'aria-pressed', String(name === way));
    const solid = way === 'room' && this.solid !== undefined;
    for (const part of [this.stage, this.tools, this.keys, this.hand.root]) part.hidden = !solid;
    if (!solid) this.hand.take('');
    this.paintPlace.classList.toggle('off', !solid);
    this.plan.root.hidden = solid;
    this.scale.root.classList.toggle('off', !solid);
    if (!this.status) return;
    if (solid)
      this.solid!.show(this.seen(this.status), this.room, true);
    else
      this.plan.show(this.status);
  }

  /** The light that a change would give, in place of the prediction. */
  private seen(status: Status): Status {
    const {preview} = this;
    if (!preview || preview.points.length !== status.points.length) return status;
    return {
      ...status,
      points: status.points.map((point, i) => {
        const {standard_error_lux: _, ...rest} = point;
        const {lux, standard_error_lux} = preview.points[i]!;
        if (lux === undefined) return point;
        return {...rest, predicted_lux: lux, ...(standard_error_lux === undefined ? {} : {standard_error_lux})};
      })
    };
  }

  private showPreview(light: Preview|undefined): void {
    const begins = light && !this.preview, ends = !light && this.preview;
    this.preview = light;
    if (begins || ends) {
      this.layers.value = begins ? 'predicted' : this.layer;
      this.solid?.setLayer(this.layers.value as Layer);
    }
    if (this.status && !this.stage.hidden) this.solid?.show(this.seen(this.status), this.room, true);
  }

  private say(words: string): void {
    setText(this.said, words);
    this.said.hidden = !words;
  }

  private async load(): Promise<void> {
    const context = document.createElement('canvas').getContext('webgl2');
    context?.getExtension('WEBGL_lose_context')?.loseContext();  // browsers have few at a time
    if (!context)
      throw new Error(
          'This browser cannot draw in 3-D (it has no WebGL 2). The plan and the tables show the same numbers.');
    this.say('Fetching the room …');
    const made = await import('./room_3d').catch(() => {
      throw new Error('The 3-D view could not be fetched. Press 3-D to try again.');
    });
    const solid = new made.Room3d(this.selection);
    solid.onScale = (layer, scale) => this.scale.show(layer, scale);
    solid.onLost = () => {
      this.mark('plan');
      this.say(
          'The browser took the 3-D picture away. Reload the page to have it again; the plan shows the same numbers.');
    };
    solid.onTake = (fixture) => this.hand.take(this.status?.fixtures[fixture]?.name ?? '');
    solid.hand.onSpot = (place) => this.hand.spotAt(place);
    this.stage.replaceChildren(solid.root, solid.heard);
    this.solid = solid;
    solid.setLayer(this.layer);
    if (this.ways.get('room')!.getAttribute('aria-pressed') === 'true') this.mark('room');
    await this.loadScene(solid);
  }

  /** Again for another room; the browser keeps the geometry, and asks whether it is still the same. */
  private async loadScene(solid: Room3d): Promise<void> {
    if (this.fetching) return;  // the answer that comes is as new
    this.fetching = true;
    try {
      const bytes = await fetchScene();
      if (bytes === 'none') {
        solid.setScene(undefined);
        return this.say('This rig has no scene: lamps and points are shown alone.');
      }
      if (bytes.etag && bytes.etag === this.sceneOf) return this.say('');
      solid.setScene(await made(bytes.glb));
      this.sceneOf = bytes.etag;
      this.say('');
    } catch (error) {
      this.say(`${error instanceof Error ? error.message : error} Lamps and points are shown alone.`);
    } finally {
      this.fetching = false;
    }
  }

  private viewButtons(): HTMLElement {
    const group = element('div', {class: 'filters', role: 'group', 'aria-label': 'Look'});
    for (const [view, words] of Object.entries(VIEW_NAMES) as [View, string][]) {
      const button =
          element('button', {type: 'button', 'data-view': view, 'aria-pressed': String(view === 'orbit')}, words);
      button.addEventListener('click', () => {
        const side = this.solid?.setView(view);
        for (const [name, other] of this.views) {
          setAttribute(other, 'aria-pressed', String(name === view));
          setText(other, name === 'side' && side ? `From the ${side}` : VIEW_NAMES[name]);
        }
      });
      this.views.set(view, button);
      group.append(button);
    }
    return group;
  }

  private layerChoice(): HTMLElement {
    const {layers} = this;
    layers.append(...Object.entries(LAYERS).map(([value, words]) => element('option', {value}, words)));
    layers.addEventListener('change', () => this.setLayer(layers.value as Layer));
    return element('div', {class: 'room-layer'}, element('label', {for: 'room-layer'
                   }, 'At the points'), layers);
  }

  private setLayer(layer: Layer): void {
    this.layer = this.layers.value = layer;
    this.solid?.setLayer(layer);
  }

  private paintButton(): HTMLElement {
    const button = element('button', {type: 'button', id: 'paint-mode', 'aria-pressed': 'false'}, 'Paint goals');
    button.addEventListener('click', () => void this.setPainting(button));
    return element('div', {class: 'filters'}, button);
  }

  /** Painting is fetched when it is first asked for. */
  private async setPainting(button: HTMLButtonElement): Promise<void> {
    const on = button.getAttribute('aria-pressed') !== 'true';
    const {solid} = this;
    if (!solid) return;
    setAttribute(button, 'aria-pressed', String(on));
    if (on && !this.paint) {
      const made = await import('./paint').catch(() => undefined);
      if (!made) {
        setAttribute(button, 'aria-pressed', 'false');
        return this.say('Painting could not be fetched. Press Paint goals to try again.');
      }
      this.paint = new made.Paint(solid);
      this.paintPlace.replaceChildren(this.paint.panel.root);
    }
    this.paintPlace.hidden = !on;
    // On a phone below the picture, so that both are in sight.
    this.stage[window.matchMedia('(max-width: 640px)').matches ? 'after' : 'before'](this.paintPlace);
    if (!on) return this.paint?.end();
    this.setLayer('goal');  // patches and points have its scale
    await this.paint?.begin();
  }
}

/** In a worker: a large room takes seconds. */
function made(glb: ArrayBuffer): Promise<MadeRoom> {
  const worker = new Worker(new URL('./scene_worker.ts', import.meta.url), {type: 'module'});
  return new Promise<MadeRoom>((resolve, reject) => {
           worker.onmessage = ({data}: MessageEvent<{room?: MadeRoom; error?: string}>) =>
               data.room ? resolve(data.room) : reject(new Error(`${data.error ?? 'the room cannot be read'}.`));
           worker.onerror = () => reject(new Error('The room could not be made ready.'));
           worker.postMessage(glb, [glb]);
         })
      .finally(() => worker.terminate());
}

function keysHelp(): HTMLElement {
  const rows: [string, string][] = [
    ['drag', 'turns the room; the right button, or two fingers, moves it; the wheel or a pinch zooms'],
    ['hold a finger', 'shows what is under it'],
    ['arrow keys', 'turn it (walk: go and look); with Shift they move it'],
    ['W A S D', 'walk'],
    ['+ and −', 'zoom'],
    ['N and P', 'next point, point before'],
    ['F', 'next fixture, with Shift the one before'],
    ['0', 'whole room'],
    ['H', 'takes the chosen fixture in hand; drag its spot to aim it'],
    ['Esc', 'nothing chosen'],
  ];
  return element(
      'details', {class: 'room-keys', hidden: ''}, element('summary', {}, 'Mouse, touch and keys'),
      element('dl', {}, ...rows.flatMap(([key, what]) => [element('dt', {}, key), element('dd', {}, what)])),
      element(
          'p', {},
          'Walls, floor and ceiling are not drawn from outside. A beam ends where its lamp aims; its width is a sign, not its photometry.'));
}
