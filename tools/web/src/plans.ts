/** Jobs that find plans, plans as files, and how a plan differs from the light that is in force. */

import {type Fields, type Fixture, type Status, fieldsOf, listOf, number, numbers, oneOf, post, text} from './api';

const STATES = ['waits', 'runs', 'done', 'failed', 'cancelled', 'lost'] as const;
export interface Job {
  id: string;
  state: (typeof STATES)[number];
  stage: string;  // what it works on
  doing: string;  // how far that is, or its best result so far
  why: string;    // it failed or is lost
  can_be_taken: boolean;
  plan?: Fields;
}
export const isEnded = (job: Job): boolean => job.state !== 'waits' && job.state !== 'runs';

export function readJob(value: unknown): Job|undefined {
  const j = fieldsOf(value);
  const {state} = oneOf(j, 'state', STATES);
  if (!state || !text(j['id'])) return undefined;
  return {
    id: text(j['id']),
    state,
    stage: text(j['stage']),
    doing: text(j['doing']),
    why: text(j['why']),
    can_be_taken: j['can_be_taken'] === true,
    ...(j['plan'] ? {plan: fieldsOf(j['plan'])} : {}),
  };
}

export interface PointDifference {
  name: string;
  goal_lux?: number;
  before_lux?: number;  // measured, else predicted
  before_measured: boolean;
  before_verdict?: string;
  after_lux?: number;
  after_error_lux?: number;
  after_verdict?: string;
  reason: string;  // why the plan misses it, or is not sure
}
export interface LightDifference {
  name: string;
  before?: number;  // level
  after: number;
  turns: boolean;  // its aim changes
}
export interface Difference {
  points: PointDifference[];  // with a goal; missed ones first
  lights: LightDifference[];  // the largest change first
  before: {met: number; missed: number; unknown: number; watts?: number};
  after: {met: number; missed: number; unknown: number; watts?: number};
}

const ORDER: Record<string, number> = {
  missed: 0,
  unknown: 1,
  met: 2
};
const TURN_DEG = 0.5;

function counts(verdicts: (string|undefined)[]): {met: number; missed: number; unknown: number} {
  const of = (word: string): number => verdicts.filter((v) => v === word).length;
  return {met: of('met'), missed: of('missed'), unknown: of('unknown')};
}

/** Undefined as soon as one is not known. */
function sum(values: (number|undefined)[]): number|undefined {
  return values.reduce<number|undefined>(
      (all, one) => all === undefined || one === undefined ? undefined : all + one, 0);
}

/** watts: of each fixture at full level, by its name. */
export function differenceOf(status: Status, plan: Fields, watts: ReadonlyMap<string, number>): Difference {
  const lights = new Map<string, Fields>();  // of each fixture, the last task that names it counts
  for (const task of listOf(plan['tasks']))
    for (const light of listOf(task['lights'])) lights.set(text(light['name']), light);
  const now = new Map(status.points.map((p) => [p.name, p]));
  const points: PointDifference[] = [];
  for (const planned of listOf(plan['points'])) {
    const name = text(planned['name']);
    const {goal_lux, lux, standard_error_lux} = numbers(planned, 'goal_lux', 'lux', 'standard_error_lux');
    const is = now.get(name);
    if (goal_lux === undefined && is?.goal_lux === undefined) continue;
    const before_lux = is?.measured_lux ?? is?.predicted_lux;
    const goal = goal_lux ?? is?.goal_lux;
    const after_verdict = text(planned['verdict']);
    points.push({
      name,
      before_measured: is?.measured_lux !== undefined,
      reason: text(planned['reason']) || text(planned['why']),
      ...(goal === undefined ? {} : {goal_lux: goal}),
      ...(before_lux === undefined ? {} : {before_lux}),
      ...(is?.verdict ? {before_verdict: is.verdict} : {}),
      ...(lux === undefined ? {} : {after_lux: lux}),
      ...(standard_error_lux === undefined ? {} : {after_error_lux: standard_error_lux}),
      ...(after_verdict ? {after_verdict} : {}),
    });
  }
  const difference: Difference = {
    points: [...points].sort((a, b) => (ORDER[a.after_verdict ?? ''] ?? 3) - (ORDER[b.after_verdict ?? ''] ?? 3)),
    lights: [],
    before: counts(points.map((p) => p.before_verdict)),
    after: counts(points.map((p) => p.after_verdict)),
  };
  const turns = (light: Fields, fixture: Fixture): boolean => {
    const {pan_deg, tilt_deg} = numbers(light, 'pan_deg', 'tilt_deg');
    if (!fixture.moves || pan_deg === undefined || tilt_deg === undefined) return false;
    return Math.hypot(pan_deg - (fixture.pan_deg ?? pan_deg), tilt_deg - (fixture.tilt_deg ?? tilt_deg)) > TURN_DEG;
  };
  for (const fixture of status.fixtures) {
    const light = lights.get(fixture.name);
    const after = light && number(light['level']);
    if (!light || after === undefined) continue;
    const before = fixture.target_level ?? fixture.level;
    difference.lights.push(
        {name: fixture.name, after, turns: turns(light, fixture), ...(before === undefined ? {} : {before})});
  }
  const change = (l: LightDifference): number => Math.abs(l.after - (l.before ?? 0)) + (l.turns ? 1 : 0);
  difference.lights.sort((a, b) => change(b) - change(a));
  const power = (levels: [string, number|undefined][]): number|undefined => sum(levels.map(([name, level]) => {
    const full = watts.get(name);
    return full === undefined || level === undefined ? undefined : full * level;
  }));
  const before_watts = power(difference.lights.map((l) => [l.name, l.before]));
  const after_watts = power(difference.lights.map((l) => [l.name, l.after]));
  if (before_watts !== undefined) difference.before.watts = before_watts;
  if (after_watts !== undefined) difference.after.watts = after_watts;
  return difference;
}

async function get(route: string): Promise<unknown> {
  const answer = await fetch(route, {cache: 'no-store', signal: AbortSignal.timeout(10_000)});
  return answer.ok ? answer.json() : undefined;
}

export async function startSolve(): Promise<string> { return text((await post('/api/jobs', {kind: 'solve'}))['id']); }

/** The newest job of this daemon that has not ended; undefined if there is none. */
export async function runningJob(): Promise<Job|undefined> {
  return listOf(await get('/api/jobs')).map(readJob).reverse().find((job) => job && !isEnded(job));
}

/** 'gone': no daemon knows it any more. */
export async function fetchJob(id: string): Promise<Job|'gone'|undefined> {
  const answer =
      await fetch(`/api/jobs/${encodeURIComponent(id)}`, {cache: 'no-store', signal: AbortSignal.timeout(10_000)});
  if (answer.status === 404) return 'gone';
  return answer.ok ? readJob(await answer.json()) : undefined;
}

export async function cancelJob(id: string): Promise<void> {
  await fetch(`/api/jobs/${encodeURIComponent(id)}`, {method: 'DELETE', signal: AbortSignal.timeout(3000)});
}

/** The plan in force; undefined before the first. */
export async function fetchPlan(): Promise<Fields|undefined> {
  const plan = await get('/api/plan').catch(() => undefined);
  return plan ? fieldsOf(plan) : undefined;
}

/** Turned heads take the daemon seconds of computing. Resolves with lines for a person. */
export async function applyPlan(plan: Fields, fade_s?: number): Promise<string> {
  return text((await post(`/api/apply${fade_s === undefined ? '' : `?fade_s=${fade_s}`}`, plan, 120_000))['text']);
}

/** Power at full level, by fixture; what is not known is absent. */
export async function fetchWatts(): Promise<Map<string, number>> {
  const answer = await fetch('/api/rig', {cache: 'no-cache'}).catch(() => undefined);
  const rig = answer?.ok ? fieldsOf(await answer.json()) : {};
  const of = new Map(listOf(rig['luminaires']).map((l) => [text(l['name']), number(l['watts'])]));
  const watts = new Map<string, number>();
  for (const fixture of listOf(rig['fixtures'])) {
    const full = of.get(text(fixture['luminaire']));
    if (full !== undefined) watts.set(text(fixture['name']), full);
  }
  return watts;
}
