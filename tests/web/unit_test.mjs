// The page's logic without a browser: numbers to text, verdicts, reading of answers, layout of the plan.
//   node tests/web/unit_test.mjs
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
const [format, judge, api, plan, works, reading] = await Promise.all(['format', 'judge', 'api', 'plan_layout', 'works', 'reading'].map(load));

test('lux has three digits and no false ones', () => {
  const cases = [[0, '0.00'], [0.424, '0.42'], [9.994, '9.99'], [9.996, '10.0'], [48.23, '48.2'], [99.96, '100'],
    [312.4, '312'], [9999.4, '9999'], [10400, '10\u202f400'], [1234567, '1\u202f234\u202f567'], [-3, '\u22123.00']];
  for (const [value, text] of cases) assert.equal(format.lux(value), text);
});

test('what is not known is a dash, never a zero', () => {
  for (const f of ['lux', 'percent', 'signedPercent', 'age', 'micros', 'count', 'withError'])
    assert.equal(format[f](undefined), format.UNKNOWN, f);
});

test('a value is as fine as its error, with two digits of it', () => {
  const cases = [[148.37, 1.23, '148.4 ± 1.2'], [148.37, 12.3, '148 ± 12'], [0.93, 0.021, '0.930 ± 0.021'],
    [5, 0, '5.00 ± 0'], [313.9, 130, '314 ± 130'], [2, undefined, '2.00']];
  for (const [value, error, text] of cases) assert.equal(format.withError(value, error), text);
});

test('errors carry their sign, and zero carries none', () => {
  assert.equal(format.signedPercent(0.0123), '+1.2 %');
  assert.equal(format.signedPercent(-0.007), '\u22120.7 %');
  assert.equal(format.signedPercent(-0.0001), '0.0 %');
});

test('ages grow coarse with age and never jump back', () => {
  const cases = [[0.04, '0.0 s'], [9.94, '9.9 s'], [9.96, '10 s'], [59.4, '59 s'], [59.6, '1 min 0 s'], [245, '4 min 5 s'],
    [7380, '2 h 3 min'], [86400 * 3 + 3600 * 4, '3 d 4 h'], [-1, '0.0 s']];
  for (const [seconds, text] of cases) assert.equal(format.age(seconds), text);
});

test('a point shows its limit first, then the verdict of its goal, as the daemon gives them', () => {
  const base = { name: 'p', reason: '', limit_reason: '' };
  const goal = { ...base, goal_lux: 45, measured_lux: 44 };
  const sign = (point) => judge.judge(point).verdict;
  assert.equal(sign({ ...goal, verdict: 'met', limit: 'exceeded' }), 'over');
  assert.equal(sign({ ...goal, verdict: 'met', limit: 'unknown' }), 'limit-unknown');
  assert.equal(sign({ ...goal, verdict: 'met', limit: 'kept' }), 'met');
  assert.equal(sign({ ...goal, verdict: 'unknown' }), 'unknown');
  assert.equal(sign({ ...goal, verdict: 'missed', error: -0.2 }), 'low');
  assert.equal(sign({ ...goal, verdict: 'missed', error: 0.2 }), 'high');
  assert.equal(sign({ ...base, limit: 'kept' }), 'none');
  assert.equal(sign({ ...base, measured_lux: 44 }), 'none');
  assert.equal(judge.judge({ ...goal, verdict: 'missed', reason: '9.0 % too dark: spot-3 is at 100 %' }).words, '9.0 % too dark: spot-3 is at 100 %');
  assert.match(judge.judge({ ...goal, verdict: 'unknown', reason: 'a luxmeter here would settle it' }).words, /not known: a luxmeter/);
});

test('what is not known is counted as neither met nor kept', () => {
  const point = (entry) => ({ name: 'p', ...entry });
  const status = api.readStatus({ phase: 'holding', points: [point({ goal_lux: 5, verdict: 'met', met: true }), point({ goal_lux: 5, verdict: 'unknown' }),
    point({ goal_lux: 5, verdict: 'missed' }), point({ goal_lux: 5, verdict: 'perhaps' }), point({ limit: 'kept' }), point({ limit: 'unknown' }), point({ limit: 'exceeded' })] });
  const { worst, ...sum } = judge.summarise(status);
  assert.deepEqual(sum, { goals: 3, goalsMet: 1, goalsMissed: 1, goalsUnknown: 1, limits: 3, limitsKept: 1, limitsExceeded: 1 });
});

test('a meter goes before the model, the daemon\'s own error before both', () => {
  const point = { name: 'p', reason: '', limit_reason: '', goal_lux: 100, predicted_lux: 90, measured_lux: 102 };
  assert.ok(Math.abs(judge.errorOf(point) - 0.02) < 1e-12);
  assert.equal(judge.errorOf({ ...point, error: 0.03 }), 0.03);
  assert.equal(judge.errorOf({ ...point, goal_lux: 0 }), undefined);
});

test('an answer that is no status is refused; numbers that are none become absent', () => {
  for (const bad of [null, 3, 'x', [], {}, { phase: 7 }]) assert.equal(api.readStatus(bad), undefined);
  const status = api.readStatus({ phase: 'idle', points: [{ name: 'p', goal_lux: '5', max_lux: null, position: [1, 2] }, 7], devices: 'none',
    fixtures: [{ name: {}, level: 0.5, aim: [0, 1, 2] }], time_s: NaN });
  assert.deepEqual(status.points[0], { name: 'p', reason: '', limit_reason: '' });
  assert.equal(status.points.length, 2);
  assert.deepEqual(status.devices, []);
  assert.deepEqual(status.fixtures[0], { name: '', bus: '', address: '', level_known: true, level: 0.5, aim: [0, 1, 2] });
  assert.ok(!('time_s' in status));
});

test('a head says why it is dark only when it is, and what it waits for only when that is known', () => {
  const fixture = (entry) => api.readStatus({ phase: 'idle', fixtures: [{ name: 'f', ...entry }] }).fixtures[0];
  assert.equal(judge.whyDark(fixture({})), '');
  assert.equal(judge.whyDark(fixture({ waits_for: 'x' })), '');
  assert.equal(judge.whyDark(fixture({ parked: 1, kept_dark: 'yes' })), '');
  assert.equal(judge.whyDark(fixture({ parked: true, waits_for: 7 })), 'parked');
  assert.equal(judge.whyDark(fixture({ parked: true, kept_dark: true, waits_for: 'the next plan' })), 'parked, waits for the next plan');
  assert.equal(judge.whyDark(fixture({ kept_dark: true, waits_for: 'another aim' })), 'kept dark, waits for another aim');
});

test('a question is read whole, and what is none is no question', () => {
  const asked = (question) => api.readStatus({ phase: 'holding', question }).question;
  for (const none of [undefined, null, 7, [], {}, { id: 'a' }, { id: 7, text: 'x' }, { id: 'a', text: '' }]) assert.equal(asked(none), undefined);
  assert.ok(!('question' in api.readStatus({ phase: 'holding' })));
  const full = { id: 'a-1', text: 'hold it', position: [1, 2, 3], normal: [0, 0, 1], fixture: 'spot', level: 0.5, step: 1, steps: 2, readings: 0,
    known_to: 0.1, known_to_worst: 0.2, answer: { what: 'reading', lux: 3 } };
  assert.deepEqual(asked({ ...full, remaining_s: 4 }), full);
  assert.deepEqual(asked({ id: 'a', text: 'x', position: [1, 2], level: 'full', answer: { what: 'dance' }, fixture: 3 }), { id: 'a', text: 'x', fixture: '' });
});

test('a reading may have a comma or a point, and never two meanings', () => {
  for (const [typed, lux] of [['182', 182], [' 182.5 ', 182.5], ['182,5', 182.5], ['182.5 lx', 182.5], ['3 Lux', 3], ['0', 0], ['0,125', 0.125], ['.5', 0.5],
    ['5.', 5], ['1234', 1234], ['1.234', 1.234], ['1234,567', 1234.567], ['200000', 200000]])
    assert.deepEqual(reading.readingOf(typed), { lux }, typed);
  for (const typed of ['', ' ', 'lx', '-1', '+5', '1e3', '0x10', 'NaN', 'Infinity', '1,2,3', '1.2.3', '1,000.5', '12 13', '200001', '1,234', '٣', '182 cd', '.'])
    assert.ok(reading.readingOf(typed).wrong, typed);
});

test('the sign of a luxmeter points the way it looks, as the plan lies', () => {
  const sign = (...normal) => plan.meterSign(normal);
  assert.deepEqual([sign(0, 0, 1).kind, sign(0, 0, -1).kind, sign(0.1, 0, 1).kind, sign(1, 0, 0).kind, sign(0.5, 0, 0.5).kind], ['up', 'down', 'up', 'side', 'side']);
  assert.ok(sign(0, -1, 0).tip.y > 30 && Math.abs(sign(0, -1, 0).tip.x) < 1e-9, 'world −y is down');
  assert.ok(sign(1, 0, 0).tip.x > 30);
  for (const { path } of [sign(1, 0, 0), sign(-0.6, 0.8, 0), sign(0, 0, -1)]) assert.match(path, /^M[-\d.]+ [-\d.]+L/);
  assert.equal(sign(0, 0, 0).kind, 'up');
});

test('a room without extent is refused, and its picture is this server\'s own', () => {
  const room = (url, max = [4, 3]) => api.readRoom({ name: 'r', plan: { url, min: [0, 0], max } });
  assert.equal(room('/api/room.png').picture, '/api/room.png');
  for (const url of ['//elsewhere/x.png', 'http://elsewhere/x.png', 'javascript:alert(1)', 5]) assert.ok(!('picture' in room(url)), String(url));
  assert.equal(room('/api/room.png', [0, 3]), undefined);
});

test('world x goes right and world y up, to scale', () => {
  const scale = plan.scaleFor({ name: 'r', min: [-2, -1], max: [6, 3] }, 800, 300);
  assert.deepEqual([scale.width, scale.height, scale.px_per_m], [600, 300, 75]);
  assert.deepEqual(scale.at(-2, 3), { x: 0, y: 0 });
  assert.deepEqual(scale.at(6, -1), { x: 600, y: 300 });
});

test('points over one another are unfolded along their normal, lowest nearest, and stay inside', () => {
  const scale = plan.scaleFor({ name: 'r', min: [0, 0], max: [10, 10] }, 1000, 1000);
  const points = [2, 1, 3].map((z) => ({ name: `z${z}`, position: [5, 9.9, z], normal: [0, -1, 0], reason: '', limit_reason: '' }));
  const places = plan.unfold(points, scale, 15);
  assert.ok(places[1].y < places[0].y && places[0].y < places[2].y, JSON.stringify(places));
  for (const [i, a] of places.entries()) {
    assert.ok(a.x >= 0 && a.x <= 1000 && a.y >= 0 && a.y <= 1000);
    for (const b of places.slice(i + 1)) assert.ok(Math.hypot(a.x - b.x, a.y - b.y) >= 12);
  }
  assert.equal(plan.unfold([{ name: 'nowhere', reason: '', limit_reason: '' }], scale, 15)[0], undefined);
});

test('points of one work go together by name and place, and one alone keeps its name', () => {
  const point = (name, x) => ({ name, position: [x, 0, 1], reason: '', limit_reason: '' });
  const names = (points) => works.worksOf(points).map((w) => [w.name, ...w.points]);
  assert.deepEqual(names([point('heath', 0), point('heath-left', 0.4), point('harbour', 5), point('harbour-foot', 5), point('door', 9)]),
    [['heath', 0, 1], ['harbour', 2, 3], ['door', 4]]);
  assert.deepEqual(names([point('venus-top', 0), point('venus-front', 0.2), point('heath-left', 9)]), [['venus', 0, 1], ['heath-left', 2]]);
  assert.deepEqual(names([point('desk-1', 0), point('desk-2', 8)]), [['desk-1', 0], ['desk-2', 1]], 'too far apart to be one work');
  assert.deepEqual(names([{ name: 'a-1', reason: '', limit_reason: '' }, { name: 'a-2', reason: '', limit_reason: '' }]), [['a', 0, 1]]);
  assert.deepEqual(names([]), []);
});

test('the name of a work stands behind its points, along a side wall where there is no room', () => {
  const scale = plan.scaleFor({ name: 'r', min: [0, 0], max: [10, 10] }, 1000, 1000);
  const at = (x, y, normal) => plan.namePlace([{ spot: { x, y }, normal }], scale);
  assert.deepEqual(at(500, 4, [0, -1, 0]), { x: 500, y: -8, turn_deg: 0 });
  assert.deepEqual(at(6, 300, [1, 0, 0]), { x: -6, y: 300, turn_deg: -90 });
  assert.deepEqual(at(994, 300, [-1, 0, 0]), { x: 1006, y: 300, turn_deg: 90 });
  assert.deepEqual(at(500, 500, [0, 0, 1]), { x: 500, y: 523, turn_deg: 0 });
  assert.equal(plan.namePlace([{ spot: undefined, normal: [0, 0, 1] }], scale), undefined);
});

test('phases and lives are told in words of a person', () => {
  assert.equal(format.phase('safe_fading'), 'fading to the safe look');
  assert.equal(format.phase('new_thing'), 'new thing');
  assert.equal(format.life('active'), 'works');
  assert.equal(format.life(''), 'not known');
  assert.equal(format.gives(0.922, 0.039), '92 ± 4 %');
});

test('a beam onto its own lamp is no beam', () => {
  assert.equal(plan.beamPath({ x: 5, y: 5 }, { x: 6, y: 5 }), '');
  assert.match(plan.beamPath({ x: 0, y: 0 }, { x: 100, y: 0 }), /^M0\.0 0\.0L/);
});
