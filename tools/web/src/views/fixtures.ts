/** Fixture levels as bars, with a tick where the fade goes; address; what each truly gives; why a head is kept dark. */

import type { Fixture } from '../api';
import { Rows, element, foldingCard, setAttribute, setText } from '../dom';
import * as format from '../format';
import { whyDark } from '../judge';
import type { Selection } from '../selection';

export class FixturesView {
  readonly root: HTMLElement;
  private readonly count = element('span');
  private readonly rows: Rows<Fixture, HTMLElement>;

  constructor(selection: Selection) {
    const list = element('ul', { class: 'fixtures' });
    const made: HTMLElement[] = [];
    this.rows = new Rows<Fixture, HTMLElement>(
      list,
      (index) => {
        const bar = element('span', { class: 'bar', role: 'meter', 'aria-valuemin': '0', 'aria-valuemax': '100' },
          element('span', { class: 'bar-fill' }), element('span', { class: 'bar-target' }));
        const row = element('li', {}, element('span', { class: 'name' }), bar, element('span', { class: 'level' }),
          element('span', { class: 'address' }),
          element('span', { class: 'gives', title: 'what the lamp truly gives, as a share of its rated light: by the luxmeters, with its standard error' }),
          element('span', { class: 'why-dark' }));
        row.addEventListener('pointerenter', () => selection.set({ kind: 'fixture', index }));
        row.addEventListener('pointerleave', () => selection.set(undefined));
        made[index] = row;
        return row;
      },
      (row, fixture) => {
        const [name, bar, level, address, gives, why] = [...row.children] as HTMLElement[];
        setText(name!, fixture.name);
        setAttribute(name!, 'title', fixture.name);
        setText(address!, `${fixture.bus} ${fixture.address}`);
        const share = Math.min(1, Math.max(0, fixture.level ?? 0));
        (bar!.children[0] as HTMLElement).style.width = `${(share * 100).toFixed(1)}%`;
        (bar!.children[1] as HTMLElement).style.left = `${(Math.min(1, Math.max(0, fixture.target_level ?? share)) * 100).toFixed(1)}%`;
        setAttribute(bar!, 'aria-valuenow', (share * 100).toFixed(0));
        setAttribute(bar!, 'aria-label', `level of ${fixture.name}`);
        setText(level!, format.percent(fixture.level, 1));
        setText(gives!, fixture.gain === undefined ? '' : `gives ${format.gives(fixture.gain, fixture.gain_standard_error)} of rated`);
        setText(why!, whyDark(fixture));
      },
    );
    this.root = foldingCard('fixtures', 'Fixtures', this.count, list);
    selection.onChange(() => {
      const chosen = selection.current;
      made.forEach((row, i) => row.classList.toggle('chosen', chosen?.kind === 'fixture' && chosen.index === i));
    });
  }

  show(fixtures: readonly Fixture[]): void {
    setText(this.count, String(fixtures.length));
    this.rows.show(fixtures);
  }
}
