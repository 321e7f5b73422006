/** How punctually levels go out. */

import type { Output } from '../api';
import { element, foldingCard, setText } from '../dom';
import * as format from '../format';

export class OutputView {
  readonly root: HTMLElement;
  private readonly values: HTMLElement[] = [];
  private readonly rate = element('span');

  constructor() {
    const names = ['refresh rate', 'sent so far', 'usual delay', '99 of 100 are within', 'longest delay', 'priority'];
    const list = element('dl', { class: 'figures' });
    for (const name of names) {
      const value = element('dd');
      this.values.push(value);
      list.append(element('div', {}, element('dt', {}, name), value));
    }
    this.root = foldingCard('output', 'Sending to the lamps', this.rate, list);
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
    setText(this.rate, texts[0]!);
    texts.forEach((text, i) => setText(this.values[i]!, text));
  }
}
