// One definition of met, missed and unknown: the output of solve and run, their JSON, their exit codes and the page
// agree, for every shipped rig and for rigs made wrong on purpose.
//   node tests/web/verdicts_test.mjs --luxrig PROGRAM
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const source = (path) => fileURLToPath(new URL(`../../${path}`, import.meta.url));
const at = process.argv.indexOf('--luxrig');
const luxrig = at > 0 ? process.argv[at + 1] : source('build/release/bin/luxrig');
const { build } = createRequire(new URL('../../tools/web/package.json', import.meta.url))('esbuild');
const load = async (name) => {
  const { outputFiles } = await build({ entryPoints: [source(`tools/web/src/${name}.ts`)], bundle: true, format: 'esm', write: false,
    logLevel: 'error' });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
};
const [{ judge, summarise }, { readStatus }] = await Promise.all(['judge', 'api'].map(load));
const folder = mkdtempSync(join(tmpdir(), 'verdicts-'));
after(() => rmSync(folder, { recursive: true, force: true }));

const started = (words) => new Promise((done) => {
  const child = spawn(luxrig, words);
  let out = '', err = '';
  child.stdout.on('data', (part) => (out += part));
  child.stderr.on('data', (part) => (err += part));
  child.on('close', (code) => done({ code, out, err }));
});

/** A copy of tests/rigs/room with its file changed. */
function room(name, change) {
  const rig = join(folder, name);
  cpSync(source('tests/rigs/room'), rig, { recursive: true });
  const text = change(readFileSync(join(rig, 'rig.toml'), 'utf8'));
  writeFileSync(join(rig, 'rig.toml'), text);
  return rig;
}
const without = (text, table, name) => {
  const parts = text.split(/^(?=\[)/m);
  return parts.filter((part) => !(part.startsWith(`[[${table}]]`) && part.includes(`name = "${name}"`))).join('');
};
const WALL = `
[[scene.object]]
name = "screen"
box_m = [3.9, 0.02, 2.9]
position_m = [0.0, -0.7, 0.0]
`;
const BROKEN = {
  'a goal that nothing reaches': (t) => t.replace('goal_lx = 120', 'goal_lx = 5000'),
  'a point behind a wall that its goal ignores': (t) => t.replace('[[luminaire]]', `${WALL}\n[[luminaire]]`)
    .replace('position_m = [1.5, -1.0, 0.0]\nnormal = [0, 0, 1]', 'position_m = [1.5, -0.68, 0.5]\nnormal = [0, -1, 0]'),
  'no luxmeter': (t) => without(without(t, 'luxmeter', 'meter-1'), 'luxmeter', 'meter-2'),
  'no goal': (t) => t.replace(/goal_lx = \d+\n/g, ''),
  'a goal beyond its own limit': (t) => t.replace('goal_lx = 150\nmax_lx = 200', 'goal_lx = 300\nmax_lx = 60'),
  'lamps that may give next to nothing': (t) => t.replace('max_level = 1.0', 'max_level = 0.02').replace('safe_level = 0.2', 'safe_level = 0.01')
    .replace('\nlevel = 0.1', '\nlevel = 0.01'),
  'two goals that contradict one another': (t) => t.replace('[[camera]]', `[[point]]
name = "beside"
position_m = [1.05, 0.5, 1.0]
normal = [0, 0, 1]
goal_lx = 900

[[camera]]`),
  'darkness wanted beside light': (t) => t.replace('[[camera]]', `[[point]]
name = "dark"
position_m = [1.5, -1.05, 0.0]
normal = [0, 0, 1]
goal_lx = 0.5

[[camera]]`),
  'a luxmeter that is hardly one': (t) => t.replace('tolerance = 0.04', 'tolerance = 0.4'),
  'a tolerance finer than the luxmeter': (t) => t.replace('tolerance = 0.02', 'tolerance = 0.02\ngoal_tolerance = 0.01'),
};
const EXPECTED = {
  'a goal that nothing reaches': { missed: ['floor'] },
  'a point behind a wall that its goal ignores': { missed: ['floor'] },
  'no luxmeter': { unknown: ['plinth-top', 'floor'] },
  'no goal': { goals: 0 },
  'a goal beyond its own limit': { missed: ['plinth-top'] },
  'lamps that may give next to nothing': { missed: ['plinth-top', 'floor'] },
  'darkness wanted beside light': { missed: ['dark'] },
  'a luxmeter that is hardly one': { unknown: ['plinth-top'] },
  'a tolerance finer than the luxmeter': { unknown: ['plinth-top'] },
};

const counted = (points, verdict) => points.filter((p) => p.verdict === verdict).length;

function agree(what, points, status) {
  for (const p of points) {
    assert.equal(p.goal_lux === undefined, p.verdict === undefined, `${what}: ${p.name}: a goal has a verdict`);
    assert.equal(p.met === true, p.verdict === 'met', `${what}: ${p.name}: met is verdict == met`);
    if (p.verdict === 'met') assert.ok(!p.reason, `${what}: ${p.name}: ${p.reason}`);
    if (p.verdict && p.verdict !== 'met') assert.ok(p.reason, `${what}: ${p.name} is ${p.verdict} without a word why`);
  }
  if (!status) return;
  for (const verdict of ['met', 'missed', 'unknown']) assert.equal(status.goals[verdict], counted(points, verdict), `${what}: ${verdict}`);
  // The page's own reading of the same JSON.
  const shown = readStatus({ phase: 'holding', ...status });
  for (const point of shown.points) {
    const sign = judge(point).verdict;
    const said = { met: ['met'], missed: ['low', 'high'], unknown: ['unknown'] }[point.verdict] ?? ['none'];
    assert.ok([...said, 'over', 'limit-unknown'].includes(sign), `${what}: the page shows ${point.name} as ${sign}, it is ${point.verdict}`);
    assert.equal(sign === 'over', point.limit === 'exceeded', `${what}: ${point.name}: limit ${point.limit}, page ${sign}`);
  }
  const sum = summarise(shown);
  assert.deepEqual([sum.goals, sum.goalsMet, sum.goalsMissed, sum.goalsUnknown],
    [status.goals.met + status.goals.missed + status.goals.unknown, status.goals.met, status.goals.missed, status.goals.unknown], what);
  assert.equal(sum.limitsKept, status.limits.kept, what);
}

async function check(what, rig, expected = {}) {
  const table = join(folder, `${what.replace(/\W/g, '-')}.json`);
  const [solved, run] = await Promise.all([
    started(['solve', rig, '--json', '--max-error', '0.05']),
    started(['run', rig, '--sim', '--once', '--port', '0', '--max-error', '0.05', '--json', table]),
  ]);
  const plan = JSON.parse(solved.out || 'null');
  assert.ok(plan, `${what}: ${solved.err}`);
  agree(`${what}, solve`, plan.points);
  assert.equal(solved.code, counted(plan.points, 'missed') > 0 || plan.limits.some((l) => !l.met) ? 1 : 0, `${what}, solve's exit code`);

  const status = JSON.parse(readFileSync(table, 'utf8'));
  agree(`${what}, run`, status.points, status);
  assert.equal(run.code, status.goals.missed > 0 || status.limits.exceeded > 0 || status.limit_violations_in_truth > 0 ? 1 : 0,
    `${what}, run's exit code\n${run.out}`);
  assert.equal(status.goals_met, status.goals.missed + status.goals.unknown === 0, what);
  // A goal called met is near in the simulator's truth; a missed one is not.
  for (const p of status.points) {
    if (!p.goal_lux) continue;
    const off = Math.abs(p.truth_lux / p.goal_lux - 1);
    if (p.verdict === 'met') assert.ok(off <= status.goals.tolerance, `${what}: ${p.name} is called met, in truth it is off by ${off}`);
    if (p.verdict === 'missed') assert.ok(off > status.goals.tolerance, `${what}: ${p.name} is called missed, in truth it is off by ${off}`);
  }
  for (const verdict of ['missed', 'unknown'])
    for (const name of expected[verdict] ?? [])
      assert.equal(status.points.find((p) => p.name === name)?.verdict, verdict, `${what}: ${name}\n${run.out}`);
  if (expected.goals !== undefined) assert.equal(status.goals.met + status.goals.missed + status.goals.unknown, expected.goals);
  return { solved, run, status };
}

for (const name of ['gallery', 'reading-room', 'stage', 'studio', 'studio/can.toml', 'frieze'])
  test(`rigs/${name}: exit codes, JSON and page agree`, async () => {
    const { run } = await check(`rigs-${name}`, source(`rigs/${name}`));
    if (name === 'stage') assert.equal(run.code, 0, `a rig without luxmeters can end well:\n${run.out}`);
  });
for (const [what, change] of Object.entries(BROKEN))
  test(`${what}: exit codes, JSON and page agree`, () => check(what, room(what.replace(/\W/g, '-'), change), EXPECTED[what]));
