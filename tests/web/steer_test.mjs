// A person steers a simulated rig from its page in headless Chromium: solves, sees how far it is, applies, reads the
// meters back; drags a head's spot, sees the predicted light change, and turns the head there.
//   node tests/web/steer_test.mjs --luxrig PROGRAM [--out FOLDER]
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { eventually, openPage, startBrowser } from './browser.mjs';
import { spotOf, steadySpot } from './hand_checks.mjs';

const source = (file) => fileURLToPath(new URL(`../../${file}`, import.meta.url));
const option = (name) => {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : undefined;
};
const luxrig = option('--luxrig') ?? source('build/release/bin/luxrig');
const out = option('--out');
if (out) mkdirSync(out, { recursive: true });
const WITHIN_MS = 60_000; // beside a build

const folder = mkdtempSync(path.join(tmpdir(), 'luxrig-steer-'));
const rig = path.join(folder, 'room');
cpSync(source('tests/rigs/room'), rig, { recursive: true });
// A person that turns a head by hand may not dim it for a limit here: the light is to be seen.
const text = readFileSync(path.join(rig, 'rig.toml'), 'utf8');
writeFileSync(path.join(rig, 'rig.toml'), text.replace('max_lx = 200\n', ''));
const daemon = spawn(luxrig, ['run', rig, '--sim', '--port', '0', '--max-error', '0.02'], { env: { ...process.env, XDG_RUNTIME_DIR: folder } });
let log = '';
for (const stream of [daemon.stdout, daemon.stderr]) stream.on('data', (part) => (log += part));
const ended = new Promise((resolve) => daemon.once('exit', resolve));
let browser;
try {
  await eventually('the daemon has a page', () => /page and status: (\S+)/.test(log) || log.slice(-500), WITHIN_MS);
  const address = /page and status: (\S+)/.exec(log)[1];
  browser = await startBrowser();
  const { page, misdeeds, close } = await openPage(browser, address, { viewport: { width: 1280, height: 900 } });
  const status = async () => (await page.context().request.get(new URL('/api/status', address).href)).json();
  const shot = (name) => out && page.screenshot({ path: path.join(out, `${name}.png`) });
  await page.waitForSelector('body.ready', { timeout: WITHIN_MS });
  await eventually('the rig holds', async () => (await status()).phase === 'holding' || (await status()).phase, WITHIN_MS);

  // 1. Solve and apply.
  await page.evaluate(() => {
    window.heard = [];
    const said = document.querySelector('.solve-state');
    new MutationObserver(() => window.heard.push(said.textContent)).observe(said, { childList: true, characterData: true, subtree: true });
  });
  await page.locator('#solve-start').click();
  await eventually('a plan is found', async () => /A plan is found/.test(await page.locator('.solve-state').innerText()) || page.locator('.solve-state').innerText(), WITHIN_MS);
  const heard = await page.evaluate(() => window.heard);
  assert.ok(heard.some((words) => /^Solving/.test(words)), `it said that it solves: ${JSON.stringify(heard)}`);
  assert.match(await page.locator('.solve-sums').innerText(), /In force[\s\S]*New plan[\s\S]*2 goals? met|of 2 goals met/);
  await page.locator('#solve-fade').selectOption('1');
  const plan = async () => (await page.context().request.get(new URL('/api/plan', address).href)).json();
  const applied_at = (await status()).time_s;
  await page.locator('#solve-apply').click();
  await eventually('it is in force', async () => /The new plan is in force/.test(await page.locator('.solve-answer').innerText()) || page.locator('.solve-answer').innerText(), WITHIN_MS);
  const planned = (await plan()).points.find((p) => p.name === 'plinth-top');
  await eventually('the simulated meter reads what the plan said', async () => {
    const now = await status();
    const { measured_lux: lux } = now.points.find((p) => p.name === 'plinth-top');
    return (now.phase === 'holding' && now.time_s > applied_at + 2 && Math.abs(lux / planned.lux - 1) < 0.1) || [now.phase, lux, planned.lux];
  }, WITHIN_MS);
  await eventually('and the page says it', async () => /measured [\d.]+ lx/.test(await page.locator('.solve-points').innerText()) || page.locator('.solve-points').innerText(), WITHIN_MS);
  await page.locator('#solve').scrollIntoViewIfNeeded();
  await shot('steer-applied');

  // 2. Drag a head's spot.
  await page.locator('#show-room').click();
  await eventually('the room is there', async () => Number(await page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS })) > 10, WITHIN_MS);
  await page.locator('#hand-which').selectOption('head-1');
  await page.locator('.room-3d').scrollIntoViewIfNeeded();
  const from = await steadySpot(page);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 8; ++i) await page.mouse.move(from.x - 6 * i, from.y - 3 * i);
  await page.mouse.up();
  const said = async (what, pattern) => eventually(what, async () => pattern.test(await page.locator('.hand').innerText()) || page.locator('.hand').innerText(), WITHIN_MS);
  await said('the light with reflections', /Predicted, with reflected light/);
  await said('what changes', /floor[\s\S]*→/);
  assert.ok(Math.hypot((await spotOf(page)).x - from.x, 0) > 20, 'the spot has moved');
  const before = (await status()).fixtures.find((f) => f.name === 'head-1');
  await shot('steer-dragged');

  // 3. Send it there.
  const [pan_deg, tilt_deg] = [await page.locator('#hand-pan').inputValue(), await page.locator('#hand-tilt').inputValue()].map(Number);
  assert.ok(Math.hypot(pan_deg - before.pan_deg, tilt_deg - before.tilt_deg) > 1, 'it would look elsewhere');
  await page.locator('#hand-turn').click();
  await eventually('the head is turned by hand', async () => {
    const head = (await status()).fixtures.find((f) => f.name === 'head-1');
    return head.aimed_by_hand === true || head;
  }, WITHIN_MS);
  await said('until when', /back after 60 s/);
  await page.locator('#hand-release').click();
  await eventually('it is released', async () => (await status()).fixtures.find((f) => f.name === 'head-1').aimed_by_hand !== true, WITHIN_MS);
  assert.deepEqual(misdeeds, []);
  await close();
  console.log('the rig was steered from its page: passed');
} catch (error) {
  console.error(`FAILED: ${error.message}\n${log.slice(-1500)}`);
  process.exitCode = 1;
} finally {
  await browser?.close();
  daemon.kill('SIGTERM');
  await ended;
  rmSync(folder, { recursive: true, force: true });
}
