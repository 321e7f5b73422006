/** What a measurement point's numbers mean for a person. */

import type { Fixture, Point, Status } from './api';

/** The sign of a point. Colour never stands alone: each has its own shape and its own word. What counts as met, missed or
 *  unknown, kept or exceeded, the daemon decides (core/plan/verdict.h); a miss is low or high here. */
export type Verdict = 'met' | 'low' | 'high' | 'over' | 'unknown' | 'limit-unknown' | 'none';

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

export function judge(point: Point): Judged {
  const error = errorOf(point);
  const measured = point.measured_lux !== undefined;
  const common = { measured, ...(error === undefined ? {} : { error }) };
  const because = (words: string, reason: string): string => (reason ? `${words}: ${reason}` : words);
  if (point.limit === 'exceeded') return { ...common, verdict: 'over', words: because('over its limit', point.limit_reason) };
  if (point.limit === 'unknown')
    return { ...common, verdict: 'limit-unknown', words: because('its limit may be exceeded', point.limit_reason) };
  if (point.verdict === undefined)
    return { ...common, verdict: 'none', words: point.max_lux === undefined ? 'no goal' : 'within its limit' };
  if (point.verdict === 'met') return { ...common, verdict: 'met', words: 'goal met' };
  if (point.verdict === 'unknown') return { ...common, verdict: 'unknown', words: because('not known', point.reason) };
  return { ...common, verdict: (error ?? 0) < 0 ? 'low' : 'high', words: point.reason };
}

export interface Summary {
  goals: number;
  goalsMet: number;
  goalsMissed: number;
  goalsUnknown: number;
  limits: number;
  limitsKept: number;
  limitsExceeded: number;
  worst?: { name: string; error: number; measured: boolean };
}

export function summarise(status: Status): Summary {
  const summary: Summary = { goals: 0, goalsMet: 0, goalsMissed: 0, goalsUnknown: 0, limits: 0, limitsKept: 0, limitsExceeded: 0 };
  for (const point of status.points) {
    const { error, measured } = judge(point);
    if (point.verdict !== undefined) {
      ++summary.goals;
      if (point.verdict === 'met') ++summary.goalsMet;
      if (point.verdict === 'missed') ++summary.goalsMissed;
      if (point.verdict === 'unknown') ++summary.goalsUnknown;
      if (error !== undefined && (!summary.worst || Math.abs(error) > Math.abs(summary.worst.error)))
        summary.worst = { name: point.name, error, measured };
    }
    if (point.limit !== undefined) {
      ++summary.limits;
      if (point.limit === 'kept') ++summary.limitsKept;
      if (point.limit === 'exceeded') ++summary.limitsExceeded;
    }
  }
  return summary;
}

/** Why a head is dark that is asked for light, and until when; empty when it is not. */
export function whyDark(fixture: Fixture): string {
  const why = fixture.parked ? 'parked' : fixture.kept_dark ? 'kept dark' : '';
  return why && fixture.waits_for ? `${why}, waits for ${fixture.waits_for}` : why;
}
