/** Every measurement point as a row (goal, predicted, measured, error, limit, state), under a row for its work that folds
 *  them up. */

import type { Point } from '../api';
import { card, element, narrow, setAttribute, setText, svg } from '../dom';
import * as format from '../format';
import { type Judged, type Verdict, judge } from '../judge';
import { MARKER_PATHS } from '../plan_layout';
import type { Selection } from '../selection';
import { type Work, worksOf } from '../works';

const COLUMNS = ['point', 'goal lx', 'predicted lx', 'measured lx', 'error', 'limit lx', 'state'] as const;
const FILTERS = {
  all: () => true,
  missed: (p: Point) => p.verdict === 'missed',
  'not known': (p: Point) => p.verdict === 'unknown',
  'with a meter': (p: Point) => p.measured_lux !== undefined,
  'with a limit': (p: Point) => p.max_lux !== undefined,
};
type Filter = keyof typeof FILTERS;

/** The worst first: a work shows that of its points. */
const WORST: Verdict[] = ['over', 'limit-unknown', 'low', 'high', 'unknown', 'none', 'met'];
const rank = (verdict: Verdict): number => WORST.indexOf(verdict);

interface WorkRow {
  work: Work;
  row: HTMLTableRowElement;
  button: HTMLElement;
}

export class PointsTable {
  readonly root: HTMLElement;
  private readonly body: HTMLElement;
  private made: HTMLTableRowElement[] = []; // by index of the point
  private works: WorkRow[] = [];
  private madeFor = '';
  private readonly open = new Map<string, boolean>(); // by name of the work, where a person has chosen
  private readonly counts = new Map<Filter, HTMLElement>();
  private readonly nothing = element('p', { class: 'nothing', hidden: '' }, 'No such point.');
  private filter: Filter = 'all';
  private points: readonly Point[] = [];

  constructor(private readonly selection: Selection) {
    // Roles are spelled out since the narrow layout lays rows out as cards, which would drop them.
    this.body = element('tbody', { role: 'rowgroup' });
    const head = element('tr', { role: 'row' }, ...COLUMNS.map((c) => element('th', { scope: 'col', role: 'columnheader' }, c)));
    const table = element('table', { role: 'table', class: 'points' }, element('thead', { role: 'rowgroup' }, head), this.body);
    this.root = card('points', 'Measurement points', this.filterButtons(), table, this.nothing);
    selection.onChange(() => this.showSelection());
    narrow.addEventListener('change', () => this.show(this.points));
  }

  show(points: readonly Point[]): void {
    this.points = points;
    const key = JSON.stringify(points.map((p) => [p.name, p.position]));
    if (key !== this.madeFor) this.make(points, key);
    points.forEach((point, index) => this.showRow(this.made[index]!, point));
    let shown = 0;
    for (const work of this.works) {
      const fitting = work.work.points.filter((index) => FILTERS[this.filter](points[index]!));
      shown += fitting.length;
      const alone = work.work.points.length === 1;
      const open = alone || this.isOpen(work.work);
      work.row.hidden = alone || fitting.length === 0;
      if (!work.row.hidden) this.showWork(work, points, open);
      for (const index of work.work.points) this.made[index]!.hidden = !open || !fitting.includes(index);
    }
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

  /** What is asked for is shown: with a filter, every point that fits. */
  private isOpen(work: Work): boolean {
    return this.open.get(work.name) ?? (this.filter !== 'all' || !narrow.matches);
  }

  private make(points: readonly Point[], key: string): void {
    this.madeFor = key;
    this.made = points.map((_, index) => this.makeRow(index));
    this.works = worksOf(points).map((work) => this.makeWork(work));
    this.body.replaceChildren(...this.works.flatMap(({ work, row }) => [row, ...work.points.map((index) => this.made[index]!)]));
    for (const { work } of this.works)
      if (work.points.length > 1) for (const index of work.points) this.made[index]!.classList.add('of-work');
    this.showSelection();
  }

  private makeWork(work: Work): WorkRow {
    const button = element('button', { type: 'button' }, element('span', { class: 'name' }, work.name),
      element('small', {}, `${work.points.length} points`));
    button.addEventListener('click', () => {
      this.open.set(work.name, !this.isOpen(work));
      this.show(this.points);
    });
    const row = element('tr', { role: 'row', class: 'work' },
      element('th', { scope: 'rowgroup', role: 'rowheader', colspan: '4' }, button),
      element('td', { role: 'cell', class: 'worst', colspan: '2' }, element('span', { class: 'value' })),
      stateCell());
    return { work, row, button };
  }

  private showWork({ work, row, button }: WorkRow, points: readonly Point[], open: boolean): void {
    setAttribute(button, 'aria-expanded', String(open));
    const judged = work.points.map((index) => judge(points[index]!));
    const worst = judged.reduce((a, b) => (rank(b.verdict) < rank(a.verdict) ? b : a));
    const alike = judged.filter((j) => j.verdict === worst.verdict);
    const furthest = judged.reduce((a, b) => (Math.abs(b.error ?? 0) > Math.abs(a.error ?? 0) ? b : a));
    setText(row.cells[1]!.children[0]!, furthest.error === undefined ? '' : `worst ${format.signedPercent(furthest.error)}`);
    setAttribute(row, 'data-verdict', worst.verdict);
    showState(row.cells[2]!, worst.verdict, alike.length === judged.length ? plain(worst) : `${alike.length} of ${judged.length}: ${plain(worst)}`);
  }

  private makeRow(index: number): HTMLTableRowElement {
    const row = element(
      'tr',
      { role: 'row', 'data-point': String(index) },
      element('th', { scope: 'row', role: 'rowheader' }),
      ...COLUMNS.slice(1, 6).map((column) => element('td', { role: 'cell', 'data-label': column })),
      stateCell(),
    );
    row.cells[3]!.append(element('span', { class: 'value' }), element('small', { class: 'age' }));
    row.cells[4]!.append(element('span', { class: 'value' }), element('small', { class: 'source' }));
    row.addEventListener('pointerenter', () => this.selection.set({ kind: 'point', index }));
    row.addEventListener('pointerleave', () => this.selection.set(undefined));
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
    setText(cell(4).children[1]!, judged.error === undefined || judged.measured ? '' : 'computed');
    setText(cell(5), point.max_lux === undefined ? format.UNKNOWN : `≤ ${format.lux(point.max_lux)}`);
    // A narrow window leaves these out.
    cell(3).classList.toggle('unknown', point.measured_lux === undefined);
    cell(4).classList.toggle('unknown', judged.error === undefined);
    cell(5).classList.toggle('unknown', point.max_lux === undefined);
    setAttribute(row, 'data-verdict', judged.verdict);
    showState(cell(6), judged.verdict, judged.words);
  }

  private showSelection(): void {
    const chosen = this.selection.current;
    this.made.forEach((row, i) => row.classList.toggle('chosen', chosen?.kind === 'point' && chosen.index === i));
  }
}

/** The words of a verdict without its reason, which is one point's. */
const plain = (judged: Judged): string => judged.words.split(':')[0]!;

function stateCell(): HTMLTableCellElement {
  return element('td', { role: 'cell', 'data-label': 'state', class: 'state' },
    svg('svg', { viewBox: '-9 -9 18 18', class: 'key', 'aria-hidden': 'true' }, svg('g', { class: 'point' }, svg('path', { class: 'shape' }))),
    element('span'));
}

function showState(cell: HTMLTableCellElement, verdict: Verdict, words: string): void {
  const group = cell.querySelector('g')!;
  setAttribute(group, 'data-verdict', verdict);
  setAttribute(group.firstElementChild!, 'd', MARKER_PATHS[verdict]);
  setText(cell.lastElementChild!, words);
}
