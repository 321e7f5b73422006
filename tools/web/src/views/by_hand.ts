/** What a person has set by hand, with its age and how long it still holds, and the form to set and release it. */

import { postGoal, postLevel, postRelease, type Override, type Status } from '../api';
import { Rows, card, element, setAttribute, setText } from '../dom';
import * as format from '../format';
import {forRole} from '../roles';

const SHOWN_MS = 10_000;
/** As a person chooses it; [s], 0: until released. */
const DURATIONS: readonly (readonly [string, number])[] = [
  ['until released', 0],
  ['for 10 min', 600],
  ['for 1 h', 3600],
  ['for 8 h', 28800],
];

export class ByHandView {
  readonly root: HTMLElement;
  private readonly rows: Rows<Override, HTMLElement>;
  private readonly names = element('datalist', { id: 'by-hand-names' });
  private readonly options: Rows<string, HTMLElement>;
  private readonly name = element('input', { id: 'by-hand-name', list: 'by-hand-names', required: '', autocomplete: 'off', placeholder: 'spot-1 or spot-*' });
  private readonly value = element('input', { id: 'by-hand-value', type: 'number', min: '0', step: 'any', required: '' });
  private readonly unit = element('label', { for: 'by-hand-value' }, 'level %, or lux');
  private readonly duration = element('select', { id: 'by-hand-duration', 'aria-label': 'for how long' });
  private readonly answer = element('p', { class: 'by-hand-answer', role: 'status' });
  private readonly none = element('p', { class: 'nothing' }, 'Nothing is set by hand.');
  private readonly all = element('button', { type: 'button', id: 'by-hand-all', hidden: '' }, 'Release all');
  private points: readonly string[] = [];
  private fixtures: readonly string[] = [];
  private shownNames = '';
  private fading: ReturnType<typeof setTimeout> | undefined;

  constructor() {
    const list = element('ul', { class: 'by-hand' });
    const shown: Override[] = [];
    this.rows = new Rows<Override, HTMLElement>(
      list,
      (index) => {
        const release = element('button', { type: 'button' }, 'Release');
        release.addEventListener('click', () => void this.send(() => postRelease([shown[index]!.name])));
        return element('li', {}, element('span', { class: 'name' }), element('span', { class: 'level' }),
          element('span', { class: 'since' }), release, element('span', { class: 'why-dark' }));
      },
      (row, override, index) => {
        shown[index] = override;
        const [name, value, since, release, why] = [...row.children] as HTMLElement[];
        setText(name!, override.name);
        setText(value!, override.kind === 'level' ? format.percent(override.level, 1) : `${format.lux(override.goal_lux)} lx`);
        const left = override.of_plan ? 'until the next plan'
          : override.remaining_s === undefined ? 'until released' : `${format.age(override.remaining_s)} left`;
        setText(since!, `for ${format.age(override.age_s)}, ${left}`);
        setAttribute(release!, 'aria-label', `release ${override.name}`);
        setText(why!, override.why ? `not so at present: ${override.why}` : '');
      },
    );
    this.options = new Rows<string, HTMLElement>(this.names, () => element('option'), (row, name) => setAttribute(row, 'value', name));
    for (const [words, seconds] of DURATIONS) this.duration.append(element('option', { value: String(seconds) }, words));
    const form = element('form', { class: 'by-hand-form' }, element('label', { for: 'by-hand-name' }, 'fixture or point'), this.name,
      this.names, this.unit, this.value, this.duration, element('button', { type: 'submit' }, 'Hold'));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.hold();
    });
    this.name.addEventListener('input', () => this.showUnit());
    this.all.addEventListener('click', () => void this.send(() => postRelease(undefined)));
    this.root = card('by-hand', 'By hand', forRole('operate', list, this.none, form, this.all), this.answer);
  }

  show(status: Status): void {
    this.rows.show(status.overrides);
    this.none.hidden = status.overrides.length > 0;
    this.all.hidden = status.overrides.length === 0;
    this.fixtures = status.fixtures.map((f) => f.name);
    this.points = status.points.map((p) => p.name);
    const names = [...this.fixtures, ...this.points];
    if (names.join('\n') === this.shownNames) return;
    this.shownNames = names.join('\n');
    this.options.show(names);
  }

  /** What names points alone takes lux, anything else a level. */
  private isPoint(): boolean {
    const pattern = this.name.value.replace(/[.+^${}()|[\]\\]/g, '\\$&').replace(/\*/g, '.*').replace(/\?/g, '.');
    const called = new RegExp(`^${pattern}$`);
    return this.points.some((p) => called.test(p)) && !this.fixtures.some((f) => called.test(f));
  }

  private showUnit(): void {
    setText(this.unit, this.isPoint() ? 'goal in lux' : 'level in %');
  }

  private async hold(): Promise<void> {
    const value = Number(this.value.value);
    const forS = Number(this.duration.value) || undefined;
    await this.send(() => (this.isPoint() ? postGoal([this.name.value], value, forS) : postLevel([this.name.value], value / 100, forS)));
  }

  private async send(ask: () => Promise<string>): Promise<void> {
    let words: string;
    try {
      words = await ask();
    } catch (error) {
      words = `Not done: ${error instanceof Error ? error.message : 'unknown cause'}.`;
    }
    setText(this.answer, words);
    clearTimeout(this.fading);
    this.fading = setTimeout(() => setText(this.answer, ''), SHOWN_MS);
  }
}
