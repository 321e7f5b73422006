/** The daemon's HTTP API (tools/luxrigd/API.md) as types, and the reading of it. What arrives is not trusted:
 *  a number that is missing or not finite becomes undefined, a list that is no list becomes empty. */

import {roleOf, type Role} from './role';

export type Vec3 = readonly [number, number, number];

export interface Fixture {
  name: string;
  bus: string;
  address: string; // on its bus, as a technician writes it: "1.3-4", "unit 10 register 2"
  position?: Vec3; // [m] world
  aim?: Vec3; // [m] world
  level?: number; // 0…1 of rated output, now
  target_level?: number; // where the fade goes
  level_known: boolean; // false: its device does not answer; `level` is the last that it took
  drive?: number; // 0…1 on the wire
  gain?: number; // estimated true output over rated
  gain_standard_error?: number;
  pan_deg?: number;
  tilt_deg?: number;
  max_level?: number;            // 0…1
  mount_axes?: readonly Vec3[];  // x, y and z of its mount in the world
  moves?: true;                  // a head
  parks?: true;                  // it has a place to rest
  identified?: true;             // it shows which one it is
  aimed_by_hand?: true;
  parked?: true; // it rests, dark
  kept_dark?: true; // its beam could meet a keep-out zone
  waits_for?: string; // parked or kept dark: what lights it again
}

export interface Point {
  name: string;
  position?: Vec3;
  normal?: Vec3;
  goal_lux?: number;
  max_lux?: number;
  predicted_lux?: number;
  standard_error_lux?: number;
  measured_lux?: number;
  measured_age_s?: number;
  error?: number; // fraction of the goal, signed
  verdict?: 'met' | 'missed' | 'unknown'; // of its goal
  reason: string; // of that verdict; empty when met
  limit?: 'kept' | 'exceeded' | 'unknown';
  limit_reason: string;
}

export interface Luxmeter {
  name: string;
  point: string;
  bus: string;
  address: string;
  lux?: number;
  age_s?: number;
  tolerance?: number;
  life: string;
}

export interface Device {
  name: string;
  driver: string; // of a bus
  address: string; // of a bus: host, port, path
  life: string;
  detail: string;
  since_s?: number;
  last_ok_s?: number;
  sent?: number;
  received?: number;
  errors?: number;
}

export interface Alarm {
  severe: boolean;
  device: string;
  text: string;
  since_s?: number;
}

/** A level or goal that a person holds. */
export interface Override {
  kind: 'level' | 'goal';
  name: string;
  level?: number; // 0…1
  goal_lux?: number;
  age_s?: number;
  remaining_s?: number; // else until it is released
  of_plan?: true; // written into the plan in force
  why?: string; // what keeps it from being so
}

export type AnswerWhat = 'reading'|'skip'|'other_place'|'end';

/** What a client that measures by hand asks of a person in the room. */
export interface Question {
  id: string;    // of this question alone
  text: string;  // where to hold the luxmeter
  position?: Vec3;
  normal?: Vec3;    // which way the meter looks
  fixture: string;  // that is lit; empty: every lamp is dark
  level?: number;   // of that fixture
  step?: number;    // of this place
  steps?: number;
  readings?: number;  // so far
  known_to?: number;  // the light at the goals: relative error so far
  known_to_worst?: number;
  answer?: {what: AnswerWhat; lux?: number};
}

export interface Output {
  rate_hz?: number;
  frames?: number;
  p50_us?: number;
  p99_us?: number;
  max_us?: number;
  realtime?: boolean;
}

export interface Status {
  rig: string;
  version: string;
  phase: string;
  detail: string;
  time_s?: number;
  simulated: boolean;
  blackout: boolean;
  round?: number;
  rounds?: number;
  converged: boolean;
  fixtures: Fixture[];
  points: Point[];
  luxmeters: Luxmeter[];
  devices: Device[];
  alarms: Alarm[];
  overrides: Override[];
  question?: Question;
  output: Output;
}

export interface Room {
  name: string;
  min: readonly [number, number]; // [m] world x, y of the picture's lower left
  max: readonly [number, number];
  picture?: string; // path on this server
}

export type Fields = Record<string, unknown>;

export const fieldsOf = (value: unknown): Fields =>
    typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Fields) : {};
export const listOf = (value: unknown): Fields[] => (Array.isArray(value) ? value.map(fieldsOf) : []);
export const text = (value: unknown): string => (typeof value === 'string' ? value : '');
export const number = (value: unknown): number|undefined =>
    typeof value === 'number' && Number.isFinite(value) ? value : undefined;

function vector(value: unknown): Vec3 | undefined {
  if (!Array.isArray(value) || value.length !== 3) return undefined;
  const [x, y, z] = value.map(number);
  return x === undefined || y === undefined || z === undefined ? undefined : [x, y, z];
}

export const isVec3 = (value: unknown): value is Vec3 => vector(value) !== undefined;

/** Copies the named numbers that are there; an absent one stays absent. */
export function numbers<K extends string>(from: Fields, ...keys: K[]): Partial<Record<K, number>> {
  const found: Partial<Record<K, number>> = {};
  for (const key of keys) {
    const value = number(from[key]);
    if (value !== undefined) found[key] = value;
  }
  return found;
}

function vectors<K extends string>(from: Fields, ...keys: K[]): Partial<Record<K, Vec3>> {
  const found: Partial<Record<K, Vec3>> = {};
  for (const key of keys) {
    const value = vector(from[key]);
    if (value !== undefined) found[key] = value;
  }
  return found;
}

function axes(value: unknown): {mount_axes?: readonly Vec3[]} {
  if (!Array.isArray(value) || value.length !== 3) return {};
  const all = value.map(vector);
  return all.every((one) => one !== undefined) ? {mount_axes: all as Vec3[]} : {};
}

/** Copies the named keys that are true. */
function flags<K extends string>(from: Fields, ...keys: K[]): Partial<Record<K, true>> {
  return Object.fromEntries(keys.filter((key) => from[key] === true).map((key) => [key, true])) as
      Partial<Record<K, true>>;
}

/** One of these words; any other is none. */
export function oneOf<K extends string, W extends string>(
    from: Fields, key: K, words: readonly W[]): Partial<Record<K, W>> {
  const found = words.find((word) => word === from[key]);
  return found === undefined ? {} : ({ [key]: found } as Record<K, W>);
}

function readQuestion(value: unknown): Question|undefined {
  const q = fieldsOf(value);
  const [id, words] = [text(q['id']), text(q['text'])];
  if (!id || !words) return undefined;
  const answer = fieldsOf(q['answer']);
  const {what} = oneOf(answer, 'what', ['reading', 'skip', 'other_place', 'end'] as const);
  return {
    id,
    text: words,
    fixture: text(q['fixture']),
    ...vectors(q, 'position', 'normal'),
    ...numbers(q, 'level', 'step', 'steps', 'readings', 'known_to', 'known_to_worst'),
    ...(what ? {answer: {what, ...numbers(answer, 'lux')}} : {}),
  };
}

/** undefined if this is no status at all. */
export function readStatus(value: unknown): Status | undefined {
  const s = fieldsOf(value);
  if (typeof s['phase'] !== 'string') return undefined;
  const output = fieldsOf(s['output']);
  const question = readQuestion(s['question']);
  return {
    rig: text(s['rig']),
    version: text(s['version']),
    phase: s['phase'],
    detail: text(s['detail']),
    simulated: s['simulated'] === true,
    blackout: s['blackout'] === true,
    converged: s['converged'] === true,
    ...numbers(s, 'time_s', 'round', 'rounds'),
    fixtures: listOf(s['fixtures']).map((f) => ({
                                          name: text(f['name']),
                                          bus: text(f['bus']),
                                          address: text(f['address']),
                                          ...vectors(f, 'position', 'aim'),
                                          ...numbers(
                                              f, 'level', 'target_level', 'drive', 'gain', 'gain_standard_error',
                                              'pan_deg', 'tilt_deg', 'max_level'),
                                          ...axes(f['mount_axes']),
                                          ...flags(f, 'moves', 'parks', 'identified', 'aimed_by_hand'),
                                          level_known: f['level_known'] !== false,
                                          ...(f['parked'] === true ? {parked: true as const} : {}),
                                          ...(f['kept_dark'] === true ? {kept_dark: true as const} : {}),
                                          ...(text(f['waits_for']) ? {waits_for: text(f['waits_for'])} : {}),
                                        })),
    points: listOf(s['points']).map((p) => ({
                                      name: text(p['name']),
                                      reason: text(p['reason']),
                                      limit_reason: text(p['limit_reason']),
                                      ...oneOf(p, 'verdict', ['met', 'missed', 'unknown'] as const),
                                      ...oneOf(p, 'limit', ['kept', 'exceeded', 'unknown'] as const),
                                      ...vectors(p, 'position', 'normal'),
                                      ...numbers(
                                          p, 'goal_lux', 'max_lux', 'predicted_lux', 'standard_error_lux',
                                          'measured_lux', 'measured_age_s', 'error'),
                                    })),
    luxmeters: listOf(s['luxmeters']).map((m) => ({
                                            name: text(m['name']),
                                            point: text(m['point']),
                                            bus: text(m['bus']),
                                            address: text(m['address']),
                                            life: text(m['life']),
                                            ...numbers(m, 'lux', 'age_s', 'tolerance'),
                                          })),
    devices: listOf(s['devices']).map((d) => ({
                                        name: text(d['name']),
                                        driver: text(d['driver']),
                                        address: text(d['address']),
                                        life: text(d['life']),
                                        detail: text(d['detail']),
                                        ...numbers(d, 'since_s', 'last_ok_s', 'sent', 'received', 'errors'),
                                      })),
    alarms: listOf(s['alarms']).map((a) => ({
                                      severe: a['severe'] === true,
                                      device: text(a['device']),
                                      text: text(a['text']),
                                      ...numbers(a, 'since_s'),
                                    })),
    overrides: listOf(s['overrides']).map((o) => ({
                                            kind: o['kind'] === 'goal' ? ('goal' as const) : ('level' as const),
                                            name: text(o['name']),
                                            ...numbers(o, 'level', 'goal_lux', 'age_s', 'remaining_s'),
                                            ...(o['of_plan'] === true ? {of_plan: true as const} : {}),
                                            ...(text(o['why']) ? {why: text(o['why'])} : {}),
                                          })),
    ...(question ? {question} : {}),
    output: {
      ...numbers(output, 'rate_hz', 'frames', 'p50_us', 'p99_us', 'max_us'),
      ...(typeof output['realtime'] === 'boolean' ? {realtime: output['realtime']} : {}),
    },
  };
}

export function readRoom(value: unknown): Room | undefined {
  const room = fieldsOf(value);
  const plan = fieldsOf(room['plan']);
  const corner = (v: unknown): readonly [number, number] | undefined => {
    if (!Array.isArray(v) || v.length < 2) return undefined;
    const x = number(v[0]);
    const y = number(v[1]);
    return x === undefined || y === undefined ? undefined : [x, y];
  };
  const bounds = fieldsOf(room['bounds']);
  const min = corner(plan['min']) ?? corner(bounds['min']);
  const max = corner(plan['max']) ?? corner(bounds['max']);
  if (!min || !max || !(max[0] > min[0]) || !(max[1] > min[1])) return undefined;
  const url = text(plan['url']);
  return {
    name: text(room['name']),
    min,
    max,
    // Of this server only, whatever the answer says.
    ...(/^\/[\w./-]+$/.test(url) && !url.startsWith('//') ? { picture: url } : {}),
  };
}

export async function fetchRoom(): Promise<Room | undefined> {
  const answer = await fetch('/api/room', { cache: 'no-store' });
  return answer.ok ? readRoom(await answer.json()) : undefined;
}

/** The room's geometry as binary glTF; 'none' if the rig has no scene. The browser keeps it, and asks each time whether
 *  it is still the same. Rejects with a sentence for a person. */
export async function fetchScene(): Promise<{glb: ArrayBuffer; etag: string}|'none'> {
  const answer = await fetch('/api/scene', {cache: 'no-cache'}).catch(() => {
    throw new Error('The room cannot be fetched.');
  });
  if (answer.status === 404) return 'none';
  if (!answer.ok) {
    const said = text(fieldsOf(await answer.json().catch(() => undefined))['error']);
    throw new Error(`The room cannot be shown: ${said || `the daemon answered ${answer.status}`}.`);
  }
  return {glb: await answer.arrayBuffer(), etag: answer.headers.get('ETag') ?? ''};
}

/** Who this browser is to the daemon. */
export interface Session {
  open: boolean;  // the daemon knows it
  name: string;
  role: Role;
  login: boolean;   // there are accounts to log in with
  problem: string;  // why the newest accounts or certificate are not used
}

/** Nothing while the daemon does not answer. */
export async function fetchSession(): Promise<Session|undefined> {
  try {
    const answer = await fetch('/api/session', {cache: 'no-store', signal: AbortSignal.timeout(2000)});
    if (!answer.ok) return undefined;
    const said = fieldsOf(await answer.json());
    return {
      open: said['open'] !== false,
      name: text(said['name']),
      role: roleOf(text(said['role']) || 'configure'),
      login: said['login'] === true,
      problem: text(said['problem'])
    };
  } catch {
    return undefined;
  }
}

/** A line of the log of changes. */
export interface Change {
  at: string;  // local time
  who: string;
  from: string;
  what: string;  // for a person
}

const MAX_CHANGE_LETTERS = 300;

export function readChange(value: unknown): Change {
  const change = fieldsOf(value);
  const at = new Date(text(change['at']));
  const pairs = Object.entries(fieldsOf(change['changed'])).map(([what, pair]) => {
    const [was, is] = Array.isArray(pair) ? pair : [];
    return `${what} ${JSON.stringify(was ?? null)} → ${JSON.stringify(is ?? null)}`;
  });
  const asked = pairs.length || change['asked'] === undefined ? '' : ` ${JSON.stringify(change['asked'])}`;
  const did = text(change['did']).replace(/^POST \/api\//, '').replace('/api/', '');
  return {
    at: Number.isNaN(at.getTime()) ? '' : at.toLocaleString(),
    who: text(change['who']),
    from: text(change['from']),
    what: `${did}${asked}${pairs.length ? `: ${pairs.join(', ')}` : ''}`.slice(0, MAX_CHANGE_LETTERS)
  };
}

export async function fetchChanges(): Promise<Change[]|undefined> {
  const answer = await fetch('/api/changes', {cache: 'no-store'});
  const said: unknown = answer.ok ? await answer.json() : undefined;
  return Array.isArray(said) ? said.map(readChange) : undefined;
}

/** Resolves with the daemon's answer once it has acknowledged; rejects with a sentence for a person. */
export async function post(route: string, body: Fields, within_ms = 3000): Promise<Fields> {
  const stop = new AbortController();
  const timer = setTimeout(() => stop.abort(), within_ms);
  try {
    const answer = await fetch(route, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify(body),
      signal: stop.signal,
    });
    const said = fieldsOf(await answer.json().catch(() => undefined));
    if (!answer.ok) throw new Error(text(said['error']) || `the daemon answered ${answer.status}`);
    return said;
  } catch (error) {
    if (stop.signal.aborted) throw new Error(`the daemon did not answer within ${within_ms / 1000} s`);
    if (error instanceof TypeError) throw new Error('the daemon cannot be reached');
    throw error;
  } finally {
    clearTimeout(timer);
  }
}

export async function postLogin(name: string, password: string): Promise<void> {
  await post('/api/login', {name, password}, 20_000);  // its hash is slow by intent, and made at low priority
}
export async function postLogout(): Promise<void> { await post('/api/logout', {}); }

export async function postBlackout(on: boolean): Promise<void> {
  await post('/api/blackout', { on });
}

/** Names may have * and ?; for_s: else until released. Each resolves with a line for a person. */
export async function postLevel(fixtures: string[], level: number, for_s?: number): Promise<string> {
  return text((await post('/api/level', { fixtures, level, ...(for_s === undefined ? {} : { for_s }) }))['text']);
}
export async function postGoal(points: string[], goal_lux: number, for_s?: number): Promise<string> {
  return text((await post('/api/goal', { points, goal_lux, ...(for_s === undefined ? {} : { for_s }) }))['text']);
}
/** lux: of a reading. Rejects if the question is not asked any more, or was answered already. */
export async function postAnswer(id: string, what: AnswerWhat, lux?: number): Promise<void> {
  await post('/api/answer', {id, what, ...(lux === undefined ? {} : {lux})});
}
/** No names: everything. */
export async function postRelease(names: string[] | undefined): Promise<string> {
  return text((await post('/api/release', names ? { names } : { all: true }))['text']);
}
