/** What is shown at the points: the verdict, or lux by one scale. */

import type {Point} from '../api';
import {PURPLE_ORANGE, VIRIDIS, type Rgb, colourAt} from './colour_scales';

export const LAYERS = {
  verdict: 'verdict',
  goal: 'goal',
  predicted: 'predicted',
  measured: 'measured',
  difference: 'difference from goal',
  uncertainty: 'uncertainty',
} as const;
export type Layer = keyof typeof LAYERS;

/** [lx] at a point; undefined if it is not known. The difference is of the best number there is, and signed; the
 *  uncertainty is the standard error of the prediction. */
export function layerLux(layer: Layer, point: Point): number|undefined {
  switch (layer) {
    case 'verdict':
      return undefined;
    case 'goal':
      return point.goal_lux;
    case 'predicted':
      return point.predicted_lux;
    case 'measured':
      return point.measured_lux;
    case 'difference': {
      const best = point.measured_lux ?? point.predicted_lux;
      return best === undefined || point.goal_lux === undefined ? undefined : best - point.goal_lux;
    }
    case 'uncertainty':
      return point.standard_error_lux;
  }
}

export interface LuxScale {
  from: number;  // [lx]
  to: number;
  ticks: number[];  // round, within from…to
  colours: readonly string[];
}

/** A round step so that `span` has 3 to 7 of them. */
export function roundStep(span: number): number {
  const power = 10 ** Math.floor(Math.log10(span / 4));
  const step = [1, 2, 5, 10].find((factor) => span / (factor * power) <= 7) ?? 10;
  return step * power;
}

/** Goal, predicted and measured share one scale, from 0 to a round number above all of them, so that colours of one mean
 *  the same in the others. `before`: kept while it still fits, as the lux change five times a second. `painted`: the most
 *  that is painted, which the scale has to reach, too. */
export function scaleOf(layer: Layer, points: readonly Point[], before?: LuxScale, painted = 0): LuxScale|undefined {
  if (layer === 'verdict') return undefined;
  const shared = layer === 'goal' || layer === 'predicted' || layer === 'measured';
  const layers: Layer[] = shared ? ['goal', 'predicted', 'measured'] : [layer];
  let most = shared ? painted : 0;
  for (const one of layers)
    for (const point of points) most = Math.max(most, Math.abs(layerLux(one, point) ?? 0));
  const signed = layer === 'difference';
  if (before && before.to >= most && most > 0.4 * before.to) return before;
  if (!(most > 0)) most = 1;
  const step = roundStep(signed ? 2 * most : most);
  const to = Math.ceil(most / step - 1e-9) * step;
  const from = signed ? -to : 0;
  const count = Math.round((to - from) / step);
  const ticks = Array.from({length: count + 1}, (_, i) => Number((from + i * step).toPrecision(12)));
  return {from, to, ticks, colours: signed ? PURPLE_ORANGE : VIRIDIS};
}

export function colourOf(scale: LuxScale, lux: number): Rgb {
  return colourAt(scale.colours, (lux - scale.from) / (scale.to - scale.from));
}
