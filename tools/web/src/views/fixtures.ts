/** Fixture levels as bars, with a tick where the fade goes, and the gain the meters have shown; why a head is kept dark. */

import type { Fixture } from '../api';
import { Rows, card, element, setAttribute, setText } from '../dom';
import * as format from '../format';
import { whyDark } from '../judge';
import type { Selection } from '../selection';

export class FixturesView {
  readonly root: HTMLElement;
  private readonly rows: Rows<Fixture, HTMLElement>;

  constructor(selection: Selection) {
    const list = element('ul', { class: 'fixtures' });
    const made: HTMLElement[] = [];
    this.rows = new Rows<Fixture, HTMLElement>(
      list,
      (index) => {
        const bar = element('span', { class: 'bar', role: 'meter', 'aria-valuemin': '0', 'aria-valuemax': '100' },
          element('span', { class: 'bar-fill' }), element('span', { class: 'bar-target' }));
        const row = element('li', {}, element('span', {}, element('span', { class: 'name' }), element('span', { class: 'bus' })), bar,
          element('span', { class: 'level' }), element('span', { class: 'gain', title: 'true output over rated, as the meters show it' }),
          element('span', { class: 'why-dark' }));
        row.addEventListener('pointerenter', () => selection.set({ kind: 'fixture', index }));
        row.addEventListener('pointerleave', () => selection.set(undefined));
        made[index] = row;
        return row;
      },
      (row, fixture) => {
        const [who, bar, level, gain, why] = [...row.children] as HTMLElement[];
        setText(who!.children[0]!, fixture.name);
        setText(who!.children[1]!, fixture.bus);
        const share = Math.min(1, Math.max(0, fixture.level ?? 0));
        (bar!.children[0] as HTMLElement).style.width = `${(share * 100).toFixed(1)}%`;
        (bar!.children[1] as HTMLElement).style.left = `${(Math.min(1, Math.max(0, fixture.target_level ?? share)) * 100).toFixed(1)}%`;
        setAttribute(bar!, 'aria-valuenow', (share * 100).toFixed(0));
        setAttribute(bar!, 'aria-label', `level of ${fixture.name}`);
        setText(level!, format.percent(fixture.level, 1));
        setText(gain!, format.withError(fixture.gain, fixture.gain_standard_error));
        setText(why!, whyDark(fixture));
      },
    );
    this.root = card('fixtures', 'Fixtures',
      element('div', { class: 'fixtures-head', 'aria-hidden': 'true' }, element('span', {}, 'level'), element('span', {}, 'gain')), list);
    selection.onChange(() => {
      const chosen = selection.current;
      made.forEach((row, i) => row.classList.toggle('chosen', chosen?.kind === 'fixture' && chosen.index === i));
    });
  }

  show(fixtures: readonly Fixture[]): void {
    this.rows.show(fixtures);
  }
}
