// What has changed becomes the status, and plans are compared with it; without a browser.
//   node tests/web/steer_unit_test.mjs
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const web = new URL('../../tools/web/', import.meta.url);
const { build } = createRequire(new URL('package.json', web))('esbuild');
async function load(name) {
  const { outputFiles } = await build({ entryPoints: [fileURLToPath(new URL(`src/${name}.ts`, web))], bundle: true,
    format: 'esm', write: false, logLevel: 'error' });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
}
const [{ StatusFeed }, plans, api] = await Promise.all(['status_feed', 'plans', 'api'].map(load));

const RIG = { name: 'hall', points: [{ name: 'a', position: [0, 0, 1] }, { name: 'b' }], fixtures: [{ name: 'spot', max_level: 0.8 }] };
const whole = () => ({ version: 'v1', whole: true, time_s: 20, rig_etag: 'r',
  changed: { rig: 'hall', phase: 'holding', alarms: [{ text: 'x', since_at_s: 15 }], question: { id: 'q', until_at_s: 50 } },
  points: [{ index: 0, lux: 5, measured_at_s: 19 }, { index: 1, lux: 6 }], fixtures: [{ index: 0, level: 0.5 }],
  devices: [{ index: 0, name: 'dmx', last_ok_at_s: 19.5, since_at_s: 0 }] });

test('what the rig is and how it is become one status, with ages', () => {
  const feed = new StatusFeed();
  assert.equal(feed.take(whole()), true);
  const status = feed.status(RIG);
  assert.deepEqual(status.points[0], { name: 'a', position: [0, 0, 1], index: 0, lux: 5, measured_age_s: 1 });
  assert.deepEqual(status.fixtures[0], { name: 'spot', max_level: 0.8, index: 0, level: 0.5 });
  assert.deepEqual(status.devices[0], { index: 0, name: 'dmx', last_ok_s: 0.5, since_s: 20 });
  assert.deepEqual(status.alarms, [{ text: 'x', since_s: 5 }]);
  assert.equal(status.question.remaining_s, 30);
  assert.equal(status.time_s, 20);
});

test('only what changed is changed, ages go on, and null takes a key away', () => {
  const feed = new StatusFeed();
  feed.take(whole());
  assert.equal(feed.take({ version: 'v2', whole: false, time_s: 22, rig_etag: 'r', changed: { question: null, phase: 'fading' }, points: [{ index: 1, lux: 7 }] }), true);
  const status = feed.status(RIG);
  assert.equal(feed.version, 'v2');
  assert.equal(status.phase, 'fading');
  assert.ok(!('question' in status));
  assert.deepEqual(status.points.map((p) => [p.name, p.lux, p.measured_age_s]), [['a', 5, 3], ['b', 7, undefined]]);
});

test('a whole answer forgets what was; one that is none changes nothing', () => {
  const feed = new StatusFeed();
  assert.equal(feed.take({ version: 'v2', whole: false, changed: {} }), false, 'a change to nothing');
  feed.take(whole());
  for (const bad of [undefined, null, 3, [], {}, { version: 4, changed: {} }, { version: 'v', changed: [] }]) assert.equal(feed.take(bad), false);
  assert.equal(feed.version, 'v1');
  feed.take({ version: 'v9', whole: true, time_s: 1, changed: { phase: 'idle' }, points: [{ index: 0, lux: 1 }, { index: 7, lux: 2 }, { index: -1 }, { index: 'x' }] });
  assert.deepEqual(feed.status(RIG).points.map((p) => p.lux), [1], 'an index that is none is left out');
  assert.ok(!('alarms' in feed.status(RIG)));
});

const STATUS = api.readStatus({ phase: 'holding',
  fixtures: [{ name: 'spot', level: 0.5, target_level: 0.4 }, { name: 'head', level: 1, moves: true, pan_deg: 0, tilt_deg: 30 }],
  points: [{ name: 'a', goal_lux: 100, predicted_lux: 90, verdict: 'missed' }, { name: 'b', goal_lux: 50, predicted_lux: 50, measured_lux: 52, verdict: 'met' }, { name: 'c' }] });
const PLAN = { tasks: [{ lights: [{ name: 'spot', level: 0.1 }, { name: 'head', level: 0.9 }] }, { lights: [{ name: 'head', level: 1, pan_deg: 10, tilt_deg: 30 }] }],
  points: [{ name: 'b', goal_lux: 50, lux: 50, verdict: 'met' }, { name: 'a', goal_lux: 100, lux: 80, standard_error_lux: 1, verdict: 'missed', reason: '20 % too dark' }, { name: 'c', lux: 3 }] };

test('a plan is compared with the light in force: what it misses first, the last task of a fixture counts', () => {
  const d = plans.differenceOf(STATUS, PLAN, new Map([['spot', 100], ['head', 50]]));
  assert.deepEqual(d.points.map((p) => p.name), ['a', 'b'], 'with a goal, and missed first');
  assert.equal(d.points[0].reason, '20 % too dark');
  assert.equal(d.points[0].before_lux, 90);
  assert.deepEqual([d.points[1].before_lux, d.points[1].before_measured], [52, true]);
  assert.deepEqual(d.before, { met: 1, missed: 1, unknown: 0, watts: 90 });
  assert.deepEqual(d.after, { met: 1, missed: 1, unknown: 0, watts: 60 });
  assert.deepEqual(d.lights, [{ name: 'head', before: 1, after: 1, turns: true }, { name: 'spot', before: 0.4, after: 0.1, turns: false }]);
});

test('power is said only if that of every lamp is known; a plan of rubbish compares to nothing', () => {
  assert.ok(!('watts' in plans.differenceOf(STATUS, PLAN, new Map([['spot', 100]])).after));
  const none = plans.differenceOf(STATUS, { tasks: 'x', points: [7, null] }, new Map());
  assert.deepEqual(none.points, []);
  assert.deepEqual(none.lights, []);
});

test('a job that is none is no job', () => {
  for (const bad of [null, [], { id: 'x' }, { state: 'runs' }, { id: 'x', state: 'odd' }]) assert.equal(plans.readJob(bad), undefined);
  assert.deepEqual(plans.readJob({ id: 'x', state: 'lost', why: 'gone' }), { id: 'x', state: 'lost', stage: '', doing: '', why: 'gone', can_be_taken: false });
});
