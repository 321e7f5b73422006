// The page of luxrig-sim in headless Chromium, on a simulator that this test starts.
//   node tests/web/sim_page_test.mjs --sim PROGRAM [--url ADDRESS] [--out FOLDER]
// --url: a simulator that runs already, of any rig; the test changes nothing there.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { eventually, openPage, startBrowser } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { fitsItsWidth } from './page_checks.mjs';

const source = (path) => fileURLToPath(new URL(`../../${path}`, import.meta.url));
const option = (name) => {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : undefined;
};
const out = option('--out');
if (out) mkdirSync(out, { recursive: true });

async function startSim() {
  const given = option('--url');
  if (given) return { url: given, stop() {} };
  const program = option('--sim') ?? source('build/release/bin/luxrig-sim');
  const sim = spawn(program, [source('tests/rigs/room'), '--deviations', 'none', '--max-error', '0.2']);
  let log = '';
  for (const stream of [sim.stdout, sim.stderr]) stream.on('data', (part) => (log += part));
  await eventually('the simulator is ready', async () => log.includes('ready ') || log, 60000);
  return { url: /http:\/\/127\.0\.0\.1:\d+\//.exec(log)[0], stop: () => sim.kill() };
}

/** Asks as a program would. */
const ask = async (page, route) => (await page.context().request.get(new URL(route, page.url()).href)).json();

async function showsEverything(page) {
  const [rig, truth] = [await ask(page, '/rig'), await ask(page, '/truth')];
  assert.equal(await page.locator('h1').innerText(), rig.rig);
  for (const list of ['points', 'fixtures', 'luxmeters'])
    assert.deepEqual(await page.locator(`#${list} tbody tr`).count(), truth[list].length, `a row for each of ${list}`);
  assert.equal(await page.locator('.bus').count(), rig.buses.length);
  for (const bus of rig.buses)
    assert.ok((await page.locator('.bus code').allInnerTexts()).includes(bus.path ?? `${bus.host}:${bus.port}`), bus.name);
  assert.equal(await page.locator('#devices details').count(), rig.devices.length);
}

async function faultsAreSwitched(page) {
  const { devices } = await ask(page, '/rig');
  const meter = devices.find((device) => device.kind === 'luxmeter');
  const details = page.locator('#devices details').nth(devices.indexOf(meter));
  await details.locator('summary').click();
  assert.equal(await details.locator('.switch').count(), meter.faults.length);
  const row = details.locator('.switch').nth(meter.faults.indexOf('slow'));
  await row.locator('input[type=number]').fill('20');
  await row.locator('input[type=checkbox]').check();
  await eventually('the fault is on', async () => {
    const { faults } = await ask(page, '/truth');
    return (faults.length === 1 && faults[0].device === meter.name && faults[0].value === 20) || faults;
  });
  await eventually('and the page lists it', async () => (await page.locator('#faults-on li').allInnerTexts()).join().includes(`${meter.name}: slow 20`));
  await row.locator('input[type=number]').fill('-5');
  await row.locator('input[type=number]').blur();
  await eventually('a value out of range is refused in words', async () => (await page.locator('#refused').innerText()).includes('out of range'));
  await page.locator('#clear-faults').click();
  await eventually('all faults are off', async () => (await ask(page, '/truth')).faults.length === 0);
  await eventually('and so is the switch', async () => !(await row.locator('input[type=checkbox]').isChecked()));
  assert.ok(await page.locator('#refused').isHidden(), 'the refusal is gone after the next success');
  await details.locator('summary').click();
}

async function shadeIsSet(page) {
  const slider = page.locator('#points tbody input[type=range]').first();
  await slider.focus();
  await page.keyboard.press('Home');
  await eventually('the point gets no light', async () => (await ask(page, '/truth')).points[0].shade === 0);
  await page.keyboard.press('End');
  await eventually('the point gets all light', async () => (await ask(page, '/truth')).points[0].shade === undefined);
}

async function takesAPicture(page) {
  if ((await ask(page, '/rig')).cameras.length === 0) return;
  await page.locator('#camera-list button').first().click();
  await eventually('the picture is there', async () =>
    (await page.locator('#camera-list canvas').first().isVisible()) || page.locator('#camera-list').innerText(), 60000);
}

const sim = await startSim();
let browser;
try {
  browser = await startBrowser();
  for (const colorScheme of ['dark', 'light']) {
    for (const width of [390, 820, 1280]) {
      const { page, misdeeds, close } = await openPage(browser, sim.url, { viewport: { width, height: 900 }, colorScheme });
      await page.waitForSelector('body.ready', { timeout: 30000 });
      await showsEverything(page);
      await fitsItsWidth(page);
      if (width === 1280 && !option('--url')) {
        await faultsAreSwitched(page);
        await shadeIsSet(page);
        if (colorScheme === 'dark') await takesAPicture(page);
      }
      await page.locator('#devices summary').first().click();
      await fitsItsWidth(page);
      assert.deepEqual(await unreadableTexts(page), [], `contrast in ${colorScheme}`);
      if (out) await page.screenshot({ path: join(out, `sim-page-${width}-${colorScheme}.png`), fullPage: true });
      assert.deepEqual(misdeeds, []);
      await close();
    }
  }
  console.log('the page of the simulator: passed');
} finally {
  await browser?.close();
  sim.stop();
}
