/** A fixture, or a group of them, in hand: its level, its aim, and what the light would be, before anything moves. */

import {type Fixture, type Status, type Vec3, postLevel, postRelease, post} from '../api';
import {Rows, element, setAttribute, setText} from '../dom';
import * as format from '../format';
import {type Change, type Preview, PreviewLine, groupsOf} from '../preview';

const TURN_FOR_S = 60;
const SHOWN_POINTS = 8;
const LEAST_CHANGE = 0.01;  // of the light at a point, to be listed
const SOLO_FOR_S = 600;

interface PointChange {
  name: string;
  from?: number;
  to: number;
  error?: number;
  goal?: number;
  max?: number;
}

export class HandView {
  readonly root: HTMLElement;
  /** The fixture that is in hand; undefined: none, or a group. */
  onTake: (fixture: number|undefined) => void = () => undefined;
  /** Angles that are typed; undefined: as it looks now. */
  onTurn: (angles: {pan_deg: number; tilt_deg: number}|undefined) => void = () => undefined;
  onLight: (light: Preview|undefined) => void = () => undefined;
  private readonly which = element('select', {id: 'hand-which'});
  private readonly level = element('input', {id: 'hand-level', type: 'range', min: '0', max: '100', step: '0.5'});
  private readonly levelSaid = element('output', {for: 'hand-level'
  });
  private readonly pan = element('input', {id: 'hand-pan', type: 'number', step: '0.5'});
  private readonly tilt = element('input', {id: 'hand-tilt', type: 'number', step: '0.5'});
  private readonly angles = element('div', {class: 'hand-row', hidden: ''}, element('label', {for: 'hand-pan'
                                    }, 'pan °'), this.pan, element('label', {for: 'hand-tilt'
                                    }, 'tilt °'), this.tilt);
  private readonly how = element('p', {class: 'hand-how'});
  private readonly said = element('p', {class: 'hand-said', role: 'status'});
  private readonly rows: Rows<PointChange, HTMLElement>;
  private readonly changes =
      element('ul', {class: 'hand-points', 'aria-label': 'Predicted light at the points that change most'});
  private readonly buttons: Record<'turn'|'hold'|'solo'|'identify'|'park'|'release'|'drop', HTMLButtonElement>;
  private readonly line = new PreviewLine();
  private status: Status|undefined;
  private names = '';
  private aim: Vec3|undefined;
  private typed: {pan_deg: number; tilt_deg: number}|undefined;
  private light: Preview|undefined;

  constructor() {
    const button = (id: string, text: string, press: () => unknown): HTMLButtonElement => {
      const made = element('button', {type: 'button', id: `hand-${id}`}, text);
      made.addEventListener('click', () => void press());
      return made;
    };
    this.buttons = {
      turn: button('turn', `Turn it there for ${TURN_FOR_S} s`, () => this.turn()),
      hold: button('hold', 'Hold this level', () => this.send(() => postLevel([this.pattern], this.wantedLevel))),
      solo: button('solo', 'Solo', () => this.send(() => this.solo())),
      identify: button(
          'identify', 'Identify',
          () => this.send(() => this.tell('/api/identify', {fixture: this.pattern}, 'it shows itself for 5 s'))),
      park: button(
          'park', 'Park',
          () => this.send(
              () => this.tell('/api/park', {fixtures: [this.pattern]}, 'it goes dark, then to its place of rest'))),
      release:
          button('release', 'Release', () => this.send(() => postRelease(this.solos ? undefined : [this.pattern]))),
      drop: button('drop', 'As it is', () => this.asItIs()),
    };
    this.rows = new Rows<PointChange, HTMLElement>(
        this.changes,
        () => element('li', {}, element('span', {class: 'name'}), element('span'), element('span', {class: 'over'})),
        (row, one) => {
          const [name, numbers, over] = [...row.children] as HTMLElement[];
          setText(name!, one.name);
          setText(
              numbers!,
              `${format.lux(one.from)} → ${format.withError(one.to, one.error)} lx${
                  one.goal === undefined ? '' : `, goal ${format.lux(one.goal)}`}`);
          setText(
              over!, one.max !== undefined && one.to > one.max ? `over its limit of ${format.lux(one.max)} lx` : '');
        });
    this.which.addEventListener('change', () => this.take(this.which.value));
    this.level.addEventListener('input', () => this.preview());
    for (const field of [this.pan, this.tilt])
      field.addEventListener('input', () => {
        const [pan_deg, tilt_deg] = [this.pan.valueAsNumber, this.tilt.valueAsNumber];
        if (!Number.isFinite(pan_deg) || !Number.isFinite(tilt_deg)) return;
        this.aim = undefined;
        this.typed = {pan_deg, tilt_deg};
        this.onTurn(this.typed);
        this.preview();
      });
    this.line.onLight = (light) => this.showLight(light);
    this.line.onFailure = (words) => setText(this.said, `Not known: ${words}.`);
    const {turn, hold, solo, identify, park, release, drop} = this.buttons;
    this.root = element(
        'div', {class: 'hand', role: 'group', 'aria-label': 'By hand'},
        element(
            'div', {class: 'hand-row'},
            element(
                'label',
                {for: 'hand-which'
                },
                'In hand'),
            this.which, this.how),
        element(
            'div', {class: 'hand-rest', hidden: ''},
            element(
                'div', {class: 'hand-row'},
                element(
                    'label',
                    {for: 'hand-level'
                    },
                    'level'),
                this.level, this.levelSaid),
            this.angles, element('div', {class: 'hand-row'}, turn, hold, solo, identify, park, release, drop),
            this.said, this.changes));
  }

  show(status: Status): void {
    this.status = status;
    const fixtures = status.fixtures.map((f) => f.name);
    const names = fixtures.join('\n');
    if (names !== this.names) {
      this.names = names;
      const kept = this.which.value;
      const option = (value: string, text = value): HTMLElement => element('option', {value}, text);
      const groups = [...groupsOf(fixtures), ...(fixtures.length > 1 ? ['*'] : [])];
      this.which.replaceChildren(
          option('', 'nothing'), element('optgroup', {label: 'fixtures'}, ...fixtures.map((f) => option(f))),
          element('optgroup', {label: 'groups'}, ...groups.map((g) => option(g, g === '*' ? 'all (*)' : g))));
      this.which.value = kept;
      if (this.which.value !== kept) this.take('');
    }
    if (this.fixture && !this.aim && !this.typed) this.showAngles(this.fixture.pan_deg, this.fixture.tilt_deg);
    this.showHow();
  }

  /** '': nothing. A name, or a pattern. */
  take(which: string): void {
    this.which.value = which;
    this.aim = this.typed = undefined;
    this.forgetLight();
    const {fixture} = this;
    const level = fixture ? fixture.target_level ?? fixture.level : undefined;
    this.level.value = String(100 * (level ?? 0.5));
    this.level.max = String(100 * (fixture?.max_level ?? 1));
    this.showLevel();
    this.showAngles(fixture?.pan_deg, fixture?.tilt_deg);
    (this.root.children[1] as HTMLElement).hidden = !which;
    setText(this.said, '');
    this.showHow();
    const index = this.status?.fixtures.findIndex((f) => f.name === which) ?? -1;
    this.onTurn(undefined);
    this.onTake(index < 0 ? undefined : index);
  }

  /** Its spot is dragged there. */
  spotAt(place: Vec3): void {
    this.aim = place;
    this.typed = undefined;
    this.preview();
  }

  private get pattern(): string { return this.which.value; }
  private get fixture(): Fixture|undefined { return this.status?.fixtures.find((f) => f.name === this.which.value); }
  private get wantedLevel(): number { return Number(this.level.value) / 100; }
  private get solos(): boolean {
    return (this.status?.overrides.filter((o) => o.kind === 'level').length ?? 0) >=
        (this.status?.fixtures.length ?? 0);
  }

  private preview(): void {
    this.showLevel();
    if (!this.pattern) return;
    const change: Change = {fixture: this.pattern, level: this.wantedLevel};
    if (this.aim)
      change.aim = this.aim;
    else if (this.typed)
      Object.assign(change, this.typed);
    this.line.ask([change]);
  }

  private showLight(light: Preview): void {
    this.light = light;
    this.onLight(light);
    const first = light.fixtures[0];
    if (first?.reached && this.aim) this.showAngles(first.pan_deg, first.tilt_deg);
    const known = light.reflections ? 'Predicted, with reflected light.' :
                                      'Predicted: direct light; what is reflected is taken as it is now.';
    const kept = first && !first.reached ? `It cannot look there: ${first.why}. ` : first?.why ? `${first.why}. ` : '';
    const person = first?.by_a_person && this.aim ?
        'Nobody but a person can turn it: this is what turning it there by hand would give. ' :
        '';
    setText(this.said, kept + person + known);
    const now = new Map(this.status?.points.map((p) => [p.name, p]));
    const list: PointChange[] = light.points.flatMap((p) => {
      const is = now.get(p.name);
      if (p.lux === undefined) return [];
      return [{
        name: p.name,
        to: p.lux,
        ...(is?.predicted_lux === undefined ? {} : {from: is.predicted_lux}),
        ...(p.standard_error_lux === undefined ? {} : {error: p.standard_error_lux}),
        ...(is?.goal_lux === undefined ? {} : {goal: is.goal_lux}),
        ...(is?.max_lux === undefined ? {} : {max: is.max_lux})
      }];
    });
    const change = (one: PointChange): number => Math.abs(one.to - (one.from ?? 0));
    const listed = list.filter((one) => change(one) > LEAST_CHANGE * Math.max(1, one.from ?? 0))
                       .sort((a, b) => change(b) - change(a));
    this.rows.show(listed.slice(0, SHOWN_POINTS));
    this.showHow();
  }

  private forgetLight(): void {
    this.line.stop();
    this.light = undefined;
    this.onLight(undefined);
    this.rows.show([]);
  }

  private asItIs(): void { this.take(this.pattern); }

  private showAngles(pan_deg: number|undefined, tilt_deg: number|undefined): void {
    for (const [field, value] of [[this.pan, pan_deg], [this.tilt, tilt_deg]] as const)
      if (document.activeElement !== field && value !== undefined) field.value = value.toFixed(1);
  }

  private showLevel(): void { setText(this.levelSaid, format.percent(this.wantedLevel, 1)); }

  private showHow(): void {
    const {fixture} = this;
    const moves = fixture?.moves === true;
    const group = this.pattern && !fixture;
    setText(
        this.how,
        !this.pattern ? 'Press a fixture in the room, or choose one here. Nothing moves until you say so.' :
            group     ? 'A group: its levels.' :
            fixture?.aimed_by_hand ? 'It is turned by hand at present.' :
            moves                  ? 'Drag its spot in the room, or type its angles.' :
                                     'Drag its spot to see what turning it would give. It cannot turn by itself.');
    this.angles.hidden = !moves;
    const {turn, identify, park, drop} = this.buttons;
    turn.hidden = !moves;
    identify.hidden = !fixture;
    park.hidden = !fixture?.parks;
    drop.hidden = !this.light;
    const reached = this.light?.fixtures[0]?.reached !== false;
    if (moves && reached && (this.aim || this.typed) && this.light)
      turn.removeAttribute('disabled');
    else
      setAttribute(turn, 'disabled', '');
  }

  private async turn(): Promise<void> {
    const to = this.light?.fixtures[0];
    if (!to || to.pan_deg === undefined || to.tilt_deg === undefined) return;
    const body =
        {fixture: this.pattern, pan_deg: to.pan_deg, tilt_deg: to.tilt_deg, level: this.wantedLevel, for_s: TURN_FOR_S};
    await this.send(
        () => this.tell('/api/aim', body, `it turns there, and back after ${TURN_FOR_S} s or when it is released`));
  }

  private async solo(): Promise<string> {
    const pattern = new RegExp(`^${this.pattern.replace(/[.+^${}()|[\]\\?]/g, '\\$&').replace(/\*/g, '.*')}$`);
    const levels = Object.fromEntries(
        (this.status?.fixtures ?? []).map((f) => [f.name, pattern.test(f.name) ? this.wantedLevel : 0]));
    await post('/api/level', {levels, for_s: SOLO_FOR_S});
    return `alone for ${SOLO_FOR_S / 60} min, or until it is released`;
  }

  private async tell(route: string, body: Record<string, unknown>, done: string): Promise<string> {
    await post(route, body);
    return done;
  }

  private async send(ask: () => Promise<string>): Promise<void> {
    try {
      setText(this.said, `${this.pattern}: ${await ask()}`);
    } catch (error) {
      setText(this.said, `Not done: ${error instanceof Error ? error.message : String(error)}.`);
    }
  }
}
