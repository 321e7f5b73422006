/** The scale of the layer that is shown, in lux, with round numbers; and the signs of the room's picture. */

import {element, setText} from '../dom';
import {count} from '../format';

import {colourAt, css} from './colour_scales';

import {type Layer, type LuxScale} from './layers';

const STEPS = 24;
const TITLES: Record<Layer, string> = {
  verdict: '',
  goal: 'goal, lx',
  predicted: 'predicted, lx',
  measured: 'measured, lx (points without a meter have none)',
  difference: 'above or below the goal, lx: measured, else predicted',
  uncertainty: 'standard error of the prediction, lx',
};

export class LuxLegend {
  readonly root = element('div', {class: 'lux-scale', role: 'img', hidden: ''});
  private readonly title = element('span', {class: 'lux-title'});
  private readonly bar = element('div', {class: 'lux-bar'});
  private readonly ticks = element('div', {class: 'lux-ticks'});
  private madeFor = '';

  constructor() { this.root.append(this.title, this.bar, this.ticks); }

  show(layer: Layer, scale: LuxScale|undefined): void {
    this.root.hidden = !scale;
    if (!scale) return;
    const key = JSON.stringify([layer, scale.from, scale.to]);
    if (key === this.madeFor) return;
    this.madeFor = key;
    setText(this.title, TITLES[layer]);
    const stops = Array.from(
        {length: STEPS + 1}, (_, i) => `${css(colourAt(scale.colours, i / STEPS))} ${((100 * i) / STEPS).toFixed(1)}%`);
    this.bar.style.background = `linear-gradient(to right, ${stops.join(', ')})`;
    this.ticks.replaceChildren(...scale.ticks.map((tick) => {
      const share = (tick - scale.from) / (scale.to - scale.from);
      const mark = element('span', {}, tickText(tick, scale.from < 0));
      mark.style.left = `${(100 * share).toFixed(2)}%`;
      return mark;
    }));
    this.root.setAttribute(
        'aria-label', `Scale: ${TITLES[layer]}, from ${tickText(scale.from, false)} to ${tickText(scale.to, false)}`);
  }
}

function tickText(lux: number, signed: boolean): string {
  const size = Math.abs(lux);
  const text = size >= 10_000 ? count(size) : String(size);
  return lux < 0 ? `\u2212${text}` : signed && lux > 0 ? `+${text}` : text;
}
