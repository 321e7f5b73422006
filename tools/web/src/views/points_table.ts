/** Every measurement point as a row: goal, predicted, measured, error, limit, state. */

import type { Point } from '../api';
import { Rows, card, element, setAttribute, setText, svg } from '../dom';
import * as format from '../format';
import { judge } from '../judge';
import { MARKER_PATHS } from '../plan_layout';
import type { Selection } from '../selection';

const COLUMNS = ['point', 'goal lx', 'predicted lx', 'measured lx', 'error', 'limit lx', 'state'] as const;
const FILTERS = {
  all: () => true,
  'not met': (p: Point) => p.goal_lux !== undefined && !p.met,
  'with a meter': (p: Point) => p.measured_lux !== undefined,
  'with a limit': (p: Point) => p.max_lux !== undefined,
};
type Filter = keyof typeof FILTERS;

export class PointsTable {
  readonly root: HTMLElement;
  private readonly rows: Rows<Point, HTMLTableRowElement>;
  private readonly made: HTMLTableRowElement[] = [];
  private readonly counts = new Map<Filter, HTMLElement>();
  private readonly nothing = element('p', { class: 'nothing', hidden: '' }, 'No such point.');
  private filter: Filter = 'all';
  private points: readonly Point[] = [];

  constructor(private readonly selection: Selection) {
    // Roles are spelled out since the narrow layout lays rows out as cards, which would drop them.
    const body = element('tbody', { role: 'rowgroup' });
    const head = element('tr', { role: 'row' }, ...COLUMNS.map((c) => element('th', { scope: 'col', role: 'columnheader' }, c)));
    const table = element('table', { role: 'table', class: 'points' }, element('thead', { role: 'rowgroup' }, head), body);
    this.rows = new Rows(body, (index) => this.makeRow(index), (row, point) => this.showRow(row, point));
    this.root = card('points', 'Measurement points', this.filterButtons(), table, this.nothing);
    selection.onChange(() => this.showSelection());
  }

  show(points: readonly Point[]): void {
    this.points = points;
    this.rows.show(points);
    this.made.length = points.length;
    let shown = 0;
    points.forEach((point, index) => {
      const visible = FILTERS[this.filter](point);
      if (visible) ++shown;
      const row = this.made[index];
      if (row && row.hidden === visible) row.hidden = !visible;
    });
    this.nothing.hidden = shown > 0;
    for (const [filter, label] of this.counts) setText(label, String(points.filter(FILTERS[filter]).length));
  }

  private filterButtons(): HTMLElement {
    const group = element('div', { class: 'filters', role: 'group', 'aria-label': 'Show points' });
    for (const filter of Object.keys(FILTERS) as Filter[]) {
      const label = element('span', { class: 'filter-count' });
      this.counts.set(filter, label);
      const button = element('button', { type: 'button', 'aria-pressed': String(filter === this.filter) }, `${filter} `, label);
      button.addEventListener('click', () => {
        this.filter = filter;
        for (const other of group.children) setAttribute(other, 'aria-pressed', String(other === button));
        this.show(this.points);
      });
      group.append(button);
    }
    return group;
  }

  private makeRow(index: number): HTMLTableRowElement {
    const sign = svg('path', { class: 'shape' });
    const row = element(
      'tr',
      { role: 'row' },
      element('th', { scope: 'row', role: 'rowheader' }),
      ...COLUMNS.slice(1, 6).map((column) => element('td', { role: 'cell', 'data-label': column })),
      element('td', { role: 'cell', 'data-label': 'state', class: 'state' },
        svg('svg', { viewBox: '-9 -9 18 18', class: 'key', 'aria-hidden': 'true' }, svg('g', { class: 'point' }, sign)),
        element('span')),
    );
    row.cells[3]!.append(element('span', { class: 'value' }), element('small', { class: 'age' }));
    row.cells[4]!.append(element('span', { class: 'value' }), element('small', { class: 'source' }));
    row.addEventListener('pointerenter', () => this.selection.set({ kind: 'point', index }));
    row.addEventListener('pointerleave', () => this.selection.set(undefined));
    this.made[index] = row;
    return row;
  }

  private showRow(row: HTMLTableRowElement, point: Point): void {
    const judged = judge(point);
    const cell = (i: number): HTMLTableCellElement => row.cells[i]!;
    setText(cell(0), point.name);
    setText(cell(1), format.lux(point.goal_lux));
    setText(cell(2), format.withError(point.predicted_lux, point.standard_error_lux));
    setText(cell(3).children[0]!, format.lux(point.measured_lux));
    setText(cell(3).children[1]!, point.measured_lux === undefined ? '' : ` ${format.age(point.measured_age_s)} ago`);
    setText(cell(4).children[0]!, format.signedPercent(judged.error));
    setText(cell(4).children[1]!, judged.error === undefined || judged.measured ? '' : 'model');
    setText(cell(5), point.max_lux === undefined ? format.UNKNOWN : `≤ ${format.lux(point.max_lux)}`);
    // A narrow window leaves these out.
    cell(3).classList.toggle('unknown', point.measured_lux === undefined);
    cell(4).classList.toggle('unknown', judged.error === undefined);
    cell(5).classList.toggle('unknown', point.max_lux === undefined);
    setAttribute(row, 'data-verdict', judged.verdict);
    const group = cell(6).querySelector('g')!;
    setAttribute(group, 'data-verdict', judged.verdict);
    setAttribute(group.firstElementChild!, 'd', MARKER_PATHS[judged.verdict]);
    setText(cell(6).lastElementChild!, judged.words);
  }

  private showSelection(): void {
    const chosen = this.selection.current;
    this.made.forEach((row, i) => row.classList.toggle('chosen', chosen?.kind === 'point' && chosen.index === i));
  }
}
