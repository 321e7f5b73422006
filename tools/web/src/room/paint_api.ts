/** Painting by the daemon's HTTP API (tools/luxrigd/API.md). What arrives is not trusted. */

import {type Fields, fieldsOf, isVec3, listOf, number, post, text} from '../api';
import type {Stroke, SurfacePlace} from './paint_document';
import {type Patches, readPatches} from './patches';

export interface Goal {
  name: string;
  saved: boolean;
  in_force: boolean;
  trouble: string;
}

export interface Painting {
  version: string;
  strokes: Stroke[];
}

/** Patches whose lux changed; NaN: no longer painted. */
export interface Change {
  version: string;
  patches: number[];
  lux: number[];
}

const routeOf = (goal: string, what = 'surface-goals'): string => `/api/${what}/${encodeURIComponent(goal)}`;
const refusal = (said: Fields, status: number): Error =>
    new Error(text(said['error']) || `the daemon answered ${status}`);
async function ask(route: string, options: RequestInit = {}): Promise<Response> {
  try {
    return await fetch(route, {cache: 'no-store', ...options});
  } catch {
    throw new Error('the daemon cannot be reached');
  }
}
const bodyOf = async(answer: Response): Promise<Fields> => fieldsOf(await answer.json().catch(() => undefined));

function readStroke(value: Fields): Stroke|undefined {
  const kind = (['brush', 'bucket', 'selective', 'eraser'] as const).find((one) => one === value['kind']);
  const path: SurfacePlace[] = [];
  for (const place of listOf(value['path'])) {
    const [position, normal] = [place['position'], place['normal']];
    if (!isVec3(position) || !isVec3(normal)) return undefined;
    path.push({position, normal});
  }
  if (!kind || !path.length) return undefined;
  const stroke: Stroke = {kind, path};
  for (const key of ['lux', 'radius_m', 'falloff'] as const) {
    const size = number(value[key]);
    if (size !== undefined) stroke[key] = size;
  }
  return stroke;
}

function readPainting(said: Fields): Painting {
  const strokes = listOf(said['strokes']).map(readStroke);
  if (strokes.includes(undefined)) throw new Error('the strokes that the daemon has cannot be read');
  return {version: text(said['version']), strokes: strokes as Stroke[]};
}

export async function fetchGoals(): Promise<Goal[]> {
  const answer = await ask('/api/surface-goals');
  if (!answer.ok) throw refusal(await bodyOf(answer), answer.status);
  return listOf(await answer.json()).map((goal) => ({
                                           name: text(goal['name']),
                                           saved: goal['saved'] === true,
                                           in_force: goal['in_force'] === true,
                                           trouble: text(goal['trouble']),
                                         }));
}

export async function fetchPainting(goal: string): Promise<Painting> {
  const answer = await ask(routeOf(goal));
  const said = await bodyOf(answer);
  if (!answer.ok) throw refusal(said, answer.status);
  return readPainting(said);
}

/** 'wait': the daemon has them in a second. */
export async function fetchPatches(goal: string): Promise<Patches|'wait'> {
  const answer = await ask(routeOf(goal, 'surface-patches'), {cache: 'no-cache'});
  if (answer.status === 503) return 'wait';
  if (!answer.ok) throw refusal(await bodyOf(answer), answer.status);
  return readPatches(await answer.arrayBuffer());
}

/** The whole list. 'wait' as above; stale: somebody else painted, and this is what there is. */
export async function putStrokes(goal: string, strokes: readonly Stroke[], version: string): Promise < Change|'wait'|{
  stale: Painting;
  words: string
}
> {
  const answer = await ask(routeOf(goal), {
    method: 'PUT',
    headers: {'Content-Type': 'application/json', 'If-Match': `"${version}"`},
    body: JSON.stringify({luxrig_painting: 1, strokes}),
  });
  if (answer.status === 503) return 'wait';
  const said = await bodyOf(answer);
  if (answer.status === 412) return {stale: readPainting(said), words: text(said['error'])};
  if (!answer.ok) throw refusal(said, answer.status);
  const list = (key: string): unknown[] => (Array.isArray(said[key]) ? said[key] : []);
  return {
    version: text(said['version']),
    patches: list('patches').map((patch) => number(patch) ?? -1),
    lux: list('lux').map((lux) => number(lux) ?? NaN),
  };
}

export async function saveGoal(goal: string): Promise<void> { await post('/api/save-painting', {goals: [goal]}, 30_000); }
export async function addGoal(name: string): Promise<void> { await post('/api/surface-goals', {name}, 30_000); }
/** The rig's files are read again and solved: that may take minutes. A sentence about what is in force. */
export async function reload(): Promise<string> { return text((await post('/api/reload', {}, 600_000))['text']); }
