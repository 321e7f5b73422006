/** The small card beside what the pointer is on. */

import type { Fixture, Point } from '../api';
import { element } from '../dom';
import * as format from '../format';
import { judge, whyDark } from '../judge';
import type { Spot } from '../plan_layout';

function fill(tip: HTMLElement, title: string, verdict: string, lines: [string, string][]): void {
  const key = JSON.stringify([title, verdict, lines]);
  if (tip.dataset['key'] === key) return;
  tip.dataset['key'] = key;
  tip.replaceChildren(
    element('strong', {}, title),
    element('dl', {}, ...lines.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)])),
    ...(verdict ? [element('p', {}, verdict)] : []),
  );
}

export function pointTip(tip: HTMLElement, point: Point): void {
  const judged = judge(point);
  const lines: [string, string][] = [
    ['goal', `${format.lux(point.goal_lux)} lx`],
    ['predicted', `${format.withError(point.predicted_lux, point.standard_error_lux)} lx`],
    ['measured', point.measured_lux === undefined ? 'no reading' : `${format.lux(point.measured_lux)} lx, ${format.age(point.measured_age_s)} ago`],
    [judged.measured ? 'error' : 'error (computed)', format.signedPercent(judged.error)],
  ];
  if (point.max_lux !== undefined) lines.push(['limit', `${format.lux(point.max_lux)} lx`]);
  fill(tip, point.name, judged.words, lines);
}

export function fixtureTip(tip: HTMLElement, fixture: Fixture): void {
  fill(tip, fixture.name, whyDark(fixture), [
    ['level', format.percent(fixture.level, 1) + (fixture.level_known ? '' : ', not known: it does not answer')],
    ['going to', format.percent(fixture.target_level, 1)],
    ['on the wire', format.percent(fixture.drive, 1)],
    ['gives of rated', format.gives(fixture.gain, fixture.gain_standard_error)],
    ['address', `${fixture.bus} ${fixture.address}`.trim() || format.UNKNOWN],
  ]);
}

/** reflectance: luminous, 0…1; undefined for glass. place: [m] world. */
export function surfaceTip(
    tip: HTMLElement, material: string, reflectance: number|undefined, place: readonly number[]): void {
  const metres = (v: number): string => `${v.toFixed(2).replace(/^-(?=0\.00$)/, '').replace('-', '\u2212')} m`;
  fill(tip, material || 'surface', '', [
    ['reflectance', reflectance === undefined ? 'glass' : format.percent(reflectance)],
    ['x, y', `${metres(place[0]!)}, ${metres(place[1]!)}`],
    ['height', metres(place[2]!)],
  ]);
}

/** Beside `at` (pixels of the drawing), kept inside the stage. */
export function placeTip(tip: HTMLElement, at: Spot, drawing: Element, stage: HTMLElement): void {
  tip.classList.add('shown');
  const frame = drawing.getBoundingClientRect();
  const around = stage.getBoundingClientRect();
  const x = at.x + frame.left - around.left;
  const y = at.y + frame.top - around.top;
  const left = x + 18 + tip.offsetWidth < around.width ? x + 18 : x - 18 - tip.offsetWidth;
  tip.style.left = `${Math.max(4, Math.min(left, around.width - tip.offsetWidth - 4))}px`;
  tip.style.top = `${Math.max(4, Math.min(y - tip.offsetHeight / 2, around.height - tip.offsetHeight - 4))}px`;
}
