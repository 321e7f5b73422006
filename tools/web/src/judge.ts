/** What a measurement point's numbers mean for a person. */

import type { Fixture, Point, Status } from './api';

/** Colour never stands alone: every verdict has its own shape and its own word. */
export type Verdict = 'met' | 'low' | 'high' | 'over' | 'none';

export interface Judged {
  verdict: Verdict;
  error?: number; // fraction of the goal, signed
  measured: boolean; // the error is a meter's, not the model's
  words: string;
}

/** The daemon's own error where it gives one, else from the best number there is. */
export function errorOf(point: Point): number | undefined {
  if (point.error !== undefined) return point.error;
  const best = point.measured_lux ?? point.predicted_lux;
  if (point.goal_lux === undefined || point.goal_lux <= 0 || best === undefined) return undefined;
  return best / point.goal_lux - 1;
}

/** How far a number may lie above a limit and still tell of none broken: a reading by its meter's tolerance, the
 *  model, whose limits the daemon keeps exactly, by rounding. */
const slackOf = (point: Point): number => (point.measured_lux === undefined ? 1e-3 : (point.meter_tolerance ?? 0));

export function judge(point: Point): Judged {
  const error = errorOf(point);
  const measured = point.measured_lux !== undefined;
  const best = point.measured_lux ?? point.predicted_lux;
  const common = { measured, ...(error === undefined ? {} : { error }) };
  if (point.max_lux !== undefined && best !== undefined && best > point.max_lux * (1 + slackOf(point)))
    return { ...common, verdict: 'over', words: 'over its limit' };
  if (point.goal_lux === undefined)
    return { ...common, verdict: 'none', words: point.max_lux === undefined ? 'no goal' : 'within its limit' };
  if (point.met) return { ...common, verdict: 'met', words: point.why ? `as near as it can be: ${point.why}` : 'goal met' };
  const verdict: Verdict = error === undefined ? 'none' : error < 0 ? 'low' : 'high';
  const how = verdict === 'none' ? 'not known yet' : verdict === 'low' ? 'too dark' : 'too bright';
  return { ...common, verdict, words: point.why ? `${how}: ${point.why}` : how };
}

export interface Summary {
  goals: number;
  goalsMet: number;
  limits: number;
  limitsKept: number;
  worst?: { name: string; error: number; measured: boolean };
}

export function summarise(status: Status): Summary {
  const summary: Summary = { goals: 0, goalsMet: 0, limits: 0, limitsKept: 0 };
  for (const point of status.points) {
    const { verdict, error, measured } = judge(point);
    if (point.goal_lux !== undefined) {
      ++summary.goals;
      if (point.met && verdict !== 'over') ++summary.goalsMet;
      if (error !== undefined && (!summary.worst || Math.abs(error) > Math.abs(summary.worst.error)))
        summary.worst = { name: point.name, error, measured };
    }
    if (point.max_lux !== undefined && (point.measured_lux ?? point.predicted_lux) !== undefined) {
      ++summary.limits;
      if (verdict !== 'over') ++summary.limitsKept;
    }
  }
  return summary;
}

/** Why a head is dark that is asked for light, and until when; empty when it is not. */
export function whyDark(fixture: Fixture): string {
  const why = fixture.parked ? 'parked' : fixture.kept_dark ? 'kept dark' : '';
  return why && fixture.waits_for ? `${why}, waits for ${fixture.waits_for}` : why;
}
