// Goals painted in the 3-D room, in headless Chromium, by mouse, touch and keys; read back from the daemon and from the
// files beside the rig file.
//   node tests/web/paint_test.mjs --luxrig PROGRAM --out DIR
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { appendFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { eventually, openPage, startBrowser } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { changed } from './pixels.mjs';

const WITHIN_MS = 60_000; // a software renderer beside a build
const source = (file) => fileURLToPath(new URL(`../../${file}`, import.meta.url));
const option = (name, otherwise) => (process.argv.includes(name) ? process.argv[process.argv.indexOf(name) + 1] : otherwise);
const luxrig = option('--luxrig', source('build/release/bin/luxrig'));
const out = option('--out', path.join(tmpdir(), 'luxrig-paint'));
mkdirSync(out, { recursive: true });

const folder = mkdtempSync(path.join(tmpdir(), 'luxrig-paint-'));
const rig = path.join(folder, 'room');
cpSync(source('tests/rigs/room'), rig, { recursive: true });
appendFileSync(path.join(rig, 'rig.toml'), '\n[[surface_goal]]\nname = "the floor"\nstrokes = "floor.json"\n');
execFileSync(luxrig, ['paint', rig]);
const daemon = spawn(luxrig, ['run', rig, '--sim', '--port', '0', '--max-error', '0.05'], { env: { ...process.env, XDG_RUNTIME_DIR: folder } });
let log = '';
for (const from of [daemon.stdout, daemon.stderr]) from.on('data', (part) => (log += part));
const ended = new Promise((resolve) => daemon.once('exit', resolve));

async function check(what, body) {
  const started = Date.now();
  try {
    await body();
  } catch (error) {
    throw new Error(`${what}: ${error.message}`);
  }
  console.log(`ok  ${what} (${Date.now() - started} ms)`);
}

const VIEWS = [
  ['paint-desktop-dark', { viewport: { width: 1440, height: 900 }, colorScheme: 'dark' }],
  ['paint-tablet-light', { viewport: { width: 820, height: 1180 }, colorScheme: 'light', hasTouch: true, isMobile: true }],
  ['paint-phone-dark', { viewport: { width: 360, height: 780 }, colorScheme: 'dark', hasTouch: true, isMobile: true }],
];

let browser;
try {
  await eventually('the daemon lights the rig', () => /in [\d.]+ s; page/.test(log) || log, WITHIN_MS);
  const token = (port) => readFileSync(path.join(folder, 'luxrig', `${port}.token`), 'utf8').trim();
  const address = /page and status: (\S+)/.exec(log)[1];
  const { origin, port } = new URL(address);
  const headers = { Authorization: `Bearer ${token(port)}`, 'Content-Type': 'application/json' };
  const route = `${origin}/api/surface-goals/the%20floor`;
  const painting = async () => (await fetch(route, { headers })).json();
  const put = (strokes) => fetch(route, { method: 'PUT', headers, body: JSON.stringify({ luxrig_painting: 1, strokes }) });
  const strokes = async () => (await painting()).strokes;
  const kinds = async () => (await strokes()).map((one) => one.kind).join();
  const newAddress = async () => (await (await fetch(`${origin}/api/session`, { method: 'POST', headers })).json()).address;

  browser = await startBrowser();
  const open = async (at, options) => {
    const view = await openPage(browser, at, options);
    const { page } = view;
    await page.waitForSelector('body.ready', { timeout: WITHIN_MS });
    await page.locator('#show-room').click();
    await eventually('the room is there', async () => Number(await page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS })) > 5, WITHIN_MS);
    await page.locator('#paint-mode').click();
    await eventually('its strokes are there', async () => /strokes?, (not )?saved/.test(await page.locator('.paint-state').textContent({ timeout: WITHIN_MS })) && (await page.locator('.paint-said').textContent()) === '', WITHIN_MS);
    await page.locator('[data-view=above]').click(); // the floor is in the middle
    await page.locator('.room-3d').scrollIntoViewIfNeeded();
    return view;
  };
  const { page, misdeeds, close } = await open(address, { viewport: { width: 1100, height: 900 } });
  const canvas = page.locator('.room-3d canvas');
  const at = async (x, y) => {
    const box = await canvas.boundingBox();
    return [box.x + x * box.width, box.y + y * box.height];
  };
  const said = () => page.locator('.paint-said').textContent();
  let version;

  await check('a bucket fills the floor, in the scale’s colour', async () => {
    await eventually('drawn from above', async () => Number(await page.locator('.room-3d').getAttribute('data-frames')) > 3, WITHIN_MS);
    await page.waitForFunction(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve(true)))));
    const before = await canvas.screenshot();
    await page.locator('#paint-bucket').click();
    await page.locator('#paint-preset').selectOption('500');
    assert.equal(await page.locator('#paint-lux').inputValue(), '500');
    await page.mouse.click(...(await at(0.5, 0.55)));
    await eventually('one stroke', async () => (await kinds()) === 'bucket' || (await kinds()), WITHIN_MS);
    const [stroke] = await strokes();
    assert.equal(stroke.lux, 500);
    assert.ok(stroke.path[0].normal[2] > 0.99, JSON.stringify(stroke));
    await eventually('painted', async () => changed(before, await canvas.screenshot()) > 0.05 || changed(before, await canvas.screenshot()), WITHIN_MS);
    await page.screenshot({ path: path.join(out, 'paint-bucket.png') });
  });

  await check('a brush is dragged; keys undo and redo it', async () => {
    await page.locator('#paint-brush').click();
    await page.locator('#paint-lux').fill('150');
    await page.mouse.move(...(await at(0.45, 0.5)));
    await page.mouse.down();
    for (let i = 1; i <= 6; ++i) await page.mouse.move(...(await at(0.45 + 0.02 * i, 0.5 + 0.01 * i)));
    await page.mouse.up();
    await eventually('two strokes', async () => (await kinds()) === 'bucket,brush' && (await strokes())[1].path.length > 2 || JSON.stringify(await strokes()), WITHIN_MS);
    assert.equal((await strokes())[1].lux, 150);
    await page.screenshot({ path: path.join(out, 'paint-brush.png') });
    await page.locator('.room-3d').focus();
    await page.keyboard.press('Control+z');
    await eventually('undone', async () => (await kinds()) === 'bucket' || (await kinds()), WITHIN_MS);
    await page.keyboard.press('Control+Shift+Z');
    await eventually('done again', async () => (await kinds()) === 'bucket,brush' || (await kinds()), WITHIN_MS);
  });

  await check('keys alone paint, pick and erase', async () => {
    await page.locator('.room-3d').focus();
    await page.keyboard.press('i');
    await page.keyboard.press('Enter');
    await eventually('picked', async () => /lx is taken from there/.test(await said()) || (await said()), WITHIN_MS);
    await page.keyboard.press('b');
    assert.equal(await page.locator('#paint-brush').getAttribute('aria-pressed'), 'true');
    const radius = () => page.locator('#paint-radius').inputValue().then(Number);
    const narrow = await radius();
    await page.keyboard.press(']');
    assert.ok((await radius()) > narrow);
    await page.keyboard.press('[');
    await page.keyboard.press('Enter');
    await eventually('a third', async () => (await kinds()) === 'bucket,brush,brush' || (await kinds()), WITHIN_MS);
    await page.keyboard.press('e');
    await page.keyboard.press('Enter');
    await eventually('erased', async () => (await kinds()) === 'bucket,brush,brush,eraser' || (await kinds()), WITHIN_MS);
  });

  await check('strokes of somebody else are told of and shown', async () => {
    const [first] = await strokes();
    assert.equal((await put([first])).status, 200);
    await page.keyboard.press('g');
    await page.keyboard.press('Enter');
    await eventually('told', async () => /Somebody else has painted/.test(await said()) || (await said()), WITHIN_MS);
    assert.equal(await kinds(), 'bucket');
    await eventually('shown', async () => /1 stroke, not saved/.test(await page.locator('.paint-state').textContent()), WITHIN_MS);
    await page.locator('#paint-redo').click();
    await eventually('ours on top', async () => (await strokes()).length === 2 || (await kinds()), WITHIN_MS);
  });

  await check('saved strokes and points are beside the rig file', async () => {
    await page.locator('#paint-save').click();
    await eventually('saved', async () => /, saved/.test(await page.locator('.paint-state').textContent()), WITHIN_MS);
    const file = JSON.parse(readFileSync(path.join(rig, 'floor.json'), 'utf8'));
    assert.deepEqual(file.strokes, await strokes());
    assert.ok(readFileSync(path.join(rig, 'floor.csv'), 'utf8').split('\n').length > 4);
    execFileSync(luxrig, ['check', rig]);
    version = (await painting()).version;
  });

  await check('a new goal is added to the rig file, and the show goes on with it', async () => {
    await page.locator('#paint-name').fill('North wall');
    await page.locator('#paint-add').click();
    await eventually('chosen', async () => (await page.locator('#paint-goal').inputValue()) === 'North wall' || (await said()), WITHIN_MS);
    assert.match(readFileSync(path.join(rig, 'rig.toml'), 'utf8'), /# The smallest rig[^]*\n\[\[surface_goal\]\]\nname = "North wall"\nstrokes = "north-wall.json"\n$/);
    await eventually('not in force', async () => /not in force yet/.test(await page.locator('.paint-state').textContent()), WITHIN_MS);
    await page.locator('#paint-use').click();
    await eventually('in force', async () => /^In force/.test(await said()) || (await said()), 2 * WITHIN_MS);
    const status = await (await fetch(`${origin}/api/status`, { headers })).json();
    assert.ok(status.points.some((point) => point.name.startsWith('the floor ')), 'the floor’s points are the rig’s');
    await page.screenshot({ path: path.join(out, 'paint-in-force.png') });
  });
  assert.deepEqual(misdeeds, []);
  await close();

  for (const [name, options] of VIEWS)
    await check(`${name}: is readable, and fits`, async () => {
      const view = await open(await newAddress(), options);
      if (options.hasTouch) {
        const before = (await strokes()).length;
        await view.page.locator('#paint-selective').tap();
        await view.page.locator('.room-3d').scrollIntoViewIfNeeded();
        const box = await view.page.locator('.room-3d canvas').boundingBox();
        await view.page.touchscreen.tap(box.x + 0.5 * box.width, box.y + 0.55 * box.height);
        await eventually('a finger paints', async () => (await strokes()).length === before + 1 || (await kinds()), WITHIN_MS);
      }
      await view.page.locator('#plan').scrollIntoViewIfNeeded();
      await view.page.screenshot({ path: path.join(out, `${name}.png`), fullPage: true });
      assert.deepEqual(await unreadableTexts(view.page), []);
      assert.ok(await view.page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'wider than the window');
      for (const button of await view.page.locator('.paint button').all())
        assert.ok((await button.textContent()).trim(), 'a button without a name');
      assert.deepEqual(view.misdeeds, []);
      await view.close();
    });
  assert.ok(version);
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser?.close();
  daemon.kill('SIGTERM');
  await ended;
  rmSync(folder, { recursive: true, force: true });
}
process.exit(process.exitCode ?? 0);
