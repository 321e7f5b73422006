// Checks of the page that hold with any daemon, mock or real. Each throws with a sentence on failure.
import assert from 'node:assert/strict';
import { eventually } from './browser.mjs';

/** The page's names for the daemon's phases. */
const PHASES = { idle: 'waiting', moving: 'heads turn', fading: 'fading', settling: 'letting the lamps settle',
  measuring: 'measuring', correcting: 'correcting', holding: 'holding', frozen: 'light held',
  safe_fading: 'fading to the safe look', safe: 'safe look' };

/** Asks as the page's browser does: a daemon checks the requester's access. */
const status = async (page, url) => (await page.context().request.get(new URL('/api/status', url).href)).json();
const text = (page, selector) => page.locator(selector).first().innerText();

/** Names, counts and numbers on the page are those of the daemon's status. */
export async function showsTheRig(page, url) {
  await page.waitForSelector('body.ready', { timeout: 30000 });
  const now = await status(page, url);
  assert.equal(await text(page, 'h1'), now.rig);
  assert.equal(await page.title(), `${now.rig} · Luxrig`);
  assert.equal(await page.locator('.fixtures li').count(), now.fixtures.length, 'one row per fixture');
  assert.equal(await page.locator('.points tbody tr[data-point]').count(), now.points.length, 'one row per point');
  assert.equal(await page.locator('.meters li').count(), now.luxmeters.length, 'one row per luxmeter');
  assert.equal(await page.locator('.devices li').count(), now.devices.length, 'one row per device');
  assert.deepEqual(await page.locator('.points [data-point] th').allTextContents(), now.points.map((p) => p.name));
  await eventually('the plan names every work', async () => {
    const names = await page.locator('svg.plan .work-name').allTextContents();
    return (names.length > 0 && names.every((name) => now.points.some((p) => p.name.startsWith(name)))) || names;
  });
  for (const fixture of now.fixtures.filter((f) => f.address))
    assert.ok((await page.locator('.fixtures .address').allTextContents()).includes(`${fixture.bus} ${fixture.address}`), `the address of ${fixture.name}`);
  await eventually('the plan has every fixture and point', async () => {
    const seen = [await page.locator('svg.plan .lamp').count(), await page.locator('svg.plan .point').count()];
    return (seen[0] === now.fixtures.length && seen[1] === now.points.length) || seen;
  });
  await eventually('the plan picture is loaded', () =>
    page.evaluate(async () => {
      const href = document.querySelector('svg.plan image')?.getAttribute('href');
      if (!href) return 'no picture';
      const picture = new Image();
      picture.src = href;
      await picture.decode();
      return picture.naturalWidth > 0;
    }));
  await eventually('the phase is shown', async () => {
    const [shown, { phase }] = [await text(page, '#phase'), await status(page, url)];
    return shown.startsWith(PHASES[phase]) || [shown, phase];
  });
}

/** Points with a reading show it with its age, predictions with their error, and both follow the daemon. */
export async function numbersAreLive(page, url) {
  const clock = await text(page, '#clock');
  await eventually('the clock goes on', async () => (await text(page, '#clock')) !== clock);
  assert.equal(await page.locator('#line').getAttribute('data-state'), 'live');
  const now = await status(page, url);
  const row = (name) => page.locator('.points tr[data-point]').nth(now.points.findIndex((p) => p.name === name));
  const predicted = now.points.find((p) => p.predicted_lux !== undefined && p.standard_error_lux !== undefined);
  if (predicted) assert.match(await row(predicted.name).locator('td').nth(1).innerText(), /^[\d.]+ ± [\d.]+$/);
  const measured = now.points.find((p) => p.measured_lux !== undefined);
  if (!measured) return;
  await eventually(`the measured lux of ${measured.name}`, async () => {
    const shown = await row(measured.name).locator('td').nth(2).innerText();
    const value = (await status(page, url)).points.find((p) => p.name === measured.name).measured_lux;
    const close = Math.abs(parseFloat(shown.replace(/\u202f/g, '')) - value) <= Math.max(0.6, 0.02 * value);
    return (close && /ago/.test(shown)) || [shown, value];
  });
}

/** Hovering a point shows goal, predicted and measured. */
export async function tipTellsThePoint(page, url) {
  const { points } = await status(page, url);
  const index = Math.max(0, points.findIndex((p) => p.measured_lux !== undefined));
  await page.locator('svg.plan').scrollIntoViewIfNeeded();
  await page.locator('svg.plan .point').nth(index).locator('.shape').hover({ force: true });
  await eventually('the tip is shown', () => page.locator('.tip').evaluate((tip) => tip.classList.contains('shown')));
  const shown = await text(page, '.tip');
  for (const word of [points[index].name, 'goal', 'predicted', 'measured', 'error'])
    assert.ok(shown.includes(word), `the tip has '${word}': ${shown}`);
  await page.mouse.move(1, 1);
}

/** Pressing the button reaches the daemon and shows its state, on and off; here by keyboard. Leaves the light on. */
export async function blackoutGoesBothWays(page, url) {
  const button = page.locator('#blackout');
  const before = (await status(page, url)).blackout;
  for (const on of before ? [false] : [true, false]) {
    await button.focus();
    await page.keyboard.press('Enter');
    await eventually(`the daemon's blackout is ${on}`, async () => (await status(page, url)).blackout === on, 2000);
    await eventually(`the button says ${on}`, async () => (await button.getAttribute('aria-pressed')) === String(on), 2000);
    if (on)
      await eventually('levels are shown at 0', async () => {
        const levels = await page.locator('.fixtures .level').allInnerTexts();
        return levels.every((level) => parseFloat(level) === 0) || levels;
      });
  }
}

/** At this window's width nothing overflows sideways. */
export async function fitsItsWidth(page) {
  await eventually('the content is as wide as its window', async () => {
    const [content, window_] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
    return content <= window_ || `content ${content} px in a window of ${window_} px`;
  });
}

export async function allChecks(page, url, { blackout }) {
  await showsTheRig(page, url);
  await numbersAreLive(page, url);
  await tipTellsThePoint(page, url);
  if (blackout) await blackoutGoesBothWays(page, url);
  await fitsItsWidth(page);
}
