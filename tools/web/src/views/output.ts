/** The output cycle's punctuality. */

import type { Output } from '../api';
import { card, element, setText } from '../dom';
import * as format from '../format';

export class OutputView {
  readonly root: HTMLElement;
  private readonly values: HTMLElement[] = [];

  constructor() {
    const names = ['rate', 'frames', 'late, median', 'late, 99 %', 'late, most', 'scheduling'];
    const list = element('dl', { class: 'figures' });
    for (const name of names) {
      const value = element('dd');
      this.values.push(value);
      list.append(element('div', {}, element('dt', {}, name), value));
    }
    this.root = card('output', 'Output cycle', list);
  }

  show(output: Output): void {
    const texts = [
      output.rate_hz === undefined ? format.UNKNOWN : `${Number(output.rate_hz.toFixed(1))} Hz`,
      format.count(output.frames),
      format.micros(output.p50_us),
      format.micros(output.p99_us),
      format.micros(output.max_us),
      output.realtime === undefined ? format.UNKNOWN : output.realtime ? 'real-time' : 'ordinary',
    ];
    texts.forEach((text, i) => setText(this.values[i]!, text));
  }
}
