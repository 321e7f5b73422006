// Drives the page in headless Chromium.
//   node tests/web/page_test.mjs --dist DIR --out DIR                      against the mock: every check, and screenshots
//   node tests/web/page_test.mjs --url URL [--screenshot FILE.png] [--leave-light]
//                                  against a running daemon (the address that luxrig page prints): the checks that hold for any; blackout on and off again,
//                                  but not with --leave-light
// Exit code 0 only if all checks held.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import { eventually, openPage, startBrowser } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { MockDaemon } from './mock_server.mjs';
import { allChecks, fitsItsWidth, showsTheRig } from './page_checks.mjs';
import { questionChecks } from './question_checks.mjs';
import { solveChecks } from './solve_checks.mjs';

const option = (name) => {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : undefined;
};
const DESKTOP = { width: 1440, height: 900 };
const PHONE = { width: 390, height: 844 };

/** Prints each check that held; the first failure ends the run. */
async function check(what, body) {
  const started = Date.now();
  try {
    await body();
  } catch (error) {
    throw new Error(`${what}: ${error.message}`);
  }
  console.log(`ok  ${what} (${Date.now() - started} ms)`);
}

async function againstDaemon(browser, url) {
  const { page, misdeeds, close } = await openPage(browser, url);
  await check(`the page shows the rig at ${url}`, () =>
    allChecks(page, url, { blackout: !process.argv.includes('--leave-light') }));
  const file = option('--screenshot');
  if (file) {
    mkdirSync(path.dirname(path.resolve(file)), { recursive: true });
    await page.screenshot({ path: file });
  }
  await page.setViewportSize(PHONE);
  await check('it fits a phone', () => fitsItsWidth(page));
  assert.deepEqual(misdeeds, []);
  await close();
}

async function againstMock(browser, dist, out) {
  const daemon = new MockDaemon(dist);
  const port = await daemon.listen();
  const url = `http://127.0.0.1:${port}/`;
  const shot = (page, name, options = {}) => page.screenshot({ path: path.join(out, `${name}.png`), ...options });
  shot.path = (name) => path.join(out, `${name}.png`);
  mkdirSync(out, { recursive: true });

  const { page, misdeeds, close } = await openPage(browser, url);
  await check('it shows the rig, live, and blackout goes both ways', () => allChecks(page, url, { blackout: true }));
  await check('blackout posts exactly what the API says', () =>
    assert.deepEqual(daemon.posts, [
      { path: '/api/blackout', body: { on: true } },
      { path: '/api/blackout', body: { on: false } },
    ]));
  await shot(page, 'desktop-dark');

  await check('in a blackout the button says so', async () => {
    daemon.blackout = true;
    await eventually('shown', async () => /BLACKOUT IS ON/.test(await page.locator('#blackout').innerText()));
    assert.match(await page.locator('#phase').innerText(), /^blackout: /);
    const color = (selector) => page.locator(selector).evaluate((e) => getComputedStyle(e).color);
    assert.notEqual(await color('.phase-name'), await color('.tile[data-tone=good] strong'), 'the header is not green');
    await shot(page, 'desktop-dark-blackout');
    daemon.blackout = false;
    await eventually('shown to be over', async () => (await page.locator('#blackout').getAttribute('aria-pressed')) === 'false');
  });

  await check('a refused blackout is said, and the button shows the truth', async () => {
    daemon.refuse = true;
    await page.locator('#blackout').click();
    await eventually('the refusal is shown', async () =>
      /not confirmed.*503/.test(await page.locator('.blackout-failure').innerText()));
    await eventually('the button is up', async () => (await page.locator('#blackout').getAttribute('aria-pressed')) === 'false');
    daemon.refuse = false;
  });

  await check('an alarm is shown within 2 s, first, and goes when it is over', async () => {
    daemon.faulted.add('meters');
    await eventually('the alarm', async () => /meters.*no answer/s.test(await page.locator('#alarms[role=alert]').innerText()), 2000);
    const first = page.locator('.devices li').first();
    assert.match(await first.innerText(), /failed/, 'the failed device leads the list');
    const above = (await page.locator('.alarm:visible').first().boundingBox()).y < (await page.locator('main').boundingBox()).y;
    assert.ok(above, 'alarms stand above the rest');
    await shot(page, 'desktop-dark-alarm');
    daemon.faulted.clear();
    await eventually('the alarm is gone', async () => (await page.locator('#alarms .alarm').count()) === 0, 2000);
  });

  await check('a head that is parked or kept dark says so, and what it waits for', async () => {
    daemon.dark = {
      'spot-2': { parked: true, waits_for: 'the next plan' },
      'spot-5': { kept_dark: true, waits_for: 'its beam to be clear of keep-out zone "stage"' },
    };
    const row = (name) => page.locator('.fixtures li', { has: page.getByText(name, { exact: true }) });
    await eventually('parked', async () => /parked, waits for the next plan/.test(await row('spot-2').innerText()), 2000);
    assert.match(await row('spot-5').innerText(), /kept dark, waits for its beam to be clear of keep-out zone "stage"/);
    assert.equal(await page.locator('.fixtures .why-dark:visible').count(), 2, 'the others say nothing');
    await fitsItsWidth(page);
    await row('spot-5').scrollIntoViewIfNeeded();
    await shot(page, 'desktop-dark-parked');
    daemon.dark = {};
    await eventually('over', async () => (await page.locator('.fixtures .why-dark:visible').count()) === 0, 2000);
  });

  await check('a level and a goal set by hand are sent, shown with their age, and released', async () => {
    daemon.posts.length = 0;
    const card = page.locator('#by-hand');
    const hold = async (name, value, seconds) => {
      await page.locator('#by-hand-name').fill(name);
      await page.locator('#by-hand-value').fill(value);
      await page.locator('#by-hand-duration').selectOption(seconds);
      await card.getByRole('button', { name: 'Hold' }).click();
    };
    const point = (await (await fetch(new URL('/api/status', url))).json()).points[0].name;
    await hold('spot-2', '5', '0');
    await eventually('the level', async () => /spot-2.*5\.0 %.*for 3\.0 s, until released/s.test(await card.innerText()), 2000);
    await hold(point, '150', '600');
    await eventually('the goal', async () => /150 lx.*for 3\.0 s, 9 min 57 s left/s.test(await card.innerText()), 2000);
    daemon.overrides[0].why = 'the limit of point "fern" (50 lx) wins: 0.031 is the most';
    await eventually('why not', async () => /not so at present: the limit of point "fern"/.test(await card.innerText()), 2000);
    await fitsItsWidth(page);
    await card.scrollIntoViewIfNeeded();
    await shot(page, 'desktop-dark-by-hand');
    await hold('nobody', '5', '0');
    await eventually('the refusal', async () => /Not done: the rig has no nobody/.test(await card.innerText()), 2000);
    await card.getByRole('button', { name: 'release spot-2' }).click();
    await eventually('one is left', async () => (await page.locator('.by-hand li').count()) === 1, 2000);
    await page.locator('#by-hand-all').click();
    await eventually('none is left', async () => /Nothing is set by hand/.test(await card.innerText()), 2000);
    assert.deepEqual(daemon.posts, [
      { path: '/api/level', body: { fixtures: ['spot-2'], level: 0.05 } },
      { path: '/api/goal', body: { points: [point], goal_lux: 150, for_s: 600 } },
      { path: '/api/level', body: { fixtures: ['nobody'], level: 0.05 } },
      { path: '/api/release', body: { names: ['spot-2'] } },
      { path: '/api/release', body: { all: true } },
    ]);
  });

  await check('a silent line is a lost line: it says so, with the age, and greys the numbers', async () => {
    daemon.silent = true;
    await eventually('lost', async () => (await page.locator('#line').getAttribute('data-state')) === 'lost');
    await eventually('the age goes on', async () => /last update [34]\.\d s ago/.test(await page.locator('#lost').innerText()));
    assert.ok(await page.locator('body').evaluate((body) => body.classList.contains('stale')));
    await shot(page, 'desktop-dark-lost');
    daemon.silent = false;
    await eventually('live again', async () => (await page.locator('#line').getAttribute('data-state')) === 'live');
    assert.equal(await page.locator('#lost').isVisible(), false);
  });

  await check('a daemon that was gone is found again by itself', async () => {
    await daemon.close();
    await eventually('lost', async () => (await page.locator('#line').getAttribute('data-state')) === 'lost');
    await daemon.listen(port);
    await eventually('live again', async () => (await page.locator('#line').getAttribute('data-state')) === 'live', 6000);
  });

  await check('markup in names and alarms is text', async () => {
    const evil = '<img src=x onerror=alert(1)><script>alert(2)</script>"\'&amp;';
    daemon.name = evil;
    daemon.alarms = [{ severe: false, device: evil, text: evil, since_s: 1 }];
    await eventually('the name as it is', async () => (await page.locator('h1').innerText()) === evil);
    await eventually('the alarm as it is', async () => (await page.locator('#alarms').innerText()).includes(evil));
    assert.equal(await page.locator('img, #app script').count(), 0);
    daemon.name = 'gallery';
    daemon.alarms = [];
    await eventually('back', async () => (await page.locator('h1').innerText()) === 'gallery');
  });

  await check('filters leave only what they say', async () => {
    await page.getByRole('button', { name: /with a meter/ }).click();
    assert.equal(await page.locator('.points [data-point]:visible').count(), 6);
    await page.getByRole('button', { name: /^all/ }).click();
    assert.equal(await page.locator('.points [data-point]:visible').count(), 36);
  });

  await check('a work folds its points up and shows the worst of them', async () => {
    const work = page.locator('.points .work', { hasText: 'drawing-2' });
    assert.match(await work.innerText(), /4 points.*1 of 4: [\d.]+ % too dark/s);
    await work.getByRole('button').click();
    assert.equal(await page.locator('.points [data-point]:visible').count(), 32);
    await work.getByRole('button').click();
    assert.equal(await page.locator('.points [data-point]:visible').count(), 36);
  });

  await check('names of fixtures are whole and on one line', async () => {
    const broken = await page.locator('.fixtures .name').evaluateAll((names) =>
      names.filter((n) => n.scrollWidth > n.clientWidth || n.getClientRects().length > 1 || n.offsetHeight > 24).map((n) => n.textContent));
    assert.deepEqual(broken, []);
  });

  await check('the theme button goes dark, light, system, and is remembered', async () => {
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme ?? 'system');
    const seen = [];
    for (let i = 0; i < 3; ++i) {
      await page.locator('.theme').click();
      seen.push(await theme());
    }
    assert.deepEqual(seen, ['dark', 'light', 'system']);
    await page.locator('.theme').click();
    await page.locator('.theme').click();
    await page.reload();
    assert.equal(await theme(), 'light');
  });
  assert.deepEqual(misdeeds, []);
  await close();

  for (const [name, options] of [
    ['desktop-light', { viewport: DESKTOP, colorScheme: 'light' }],
    ['phone-dark', { viewport: PHONE, colorScheme: 'dark', hasTouch: true, isMobile: true }],
    ['phone-light', { viewport: PHONE, colorScheme: 'light', hasTouch: true, isMobile: true }],
  ])
    await check(`${name}: fits, readable, blackout in reach`, async () => {
      daemon.faulted.add('dmx');
      daemon.alarms = [{ severe: false, device: 'meter-4', text: 'drifts from the model by 9 %: clean or recalibrate it', since_s: 75 }];
      const view = await openPage(browser, url, options);
      await showsTheRig(view.page, url);
      await eventually('the alarms', async () => (await view.page.locator('#alarms .alarm').count()) === 2);
      await fitsItsWidth(view.page);
      assert.deepEqual(await unreadableTexts(view.page), []);
      if (options.isMobile) {
        const tall = await view.page.evaluate(() => document.documentElement.scrollHeight);
        assert.ok(tall < 2500, `a phone's page of ${tall} px`);
        await view.page.locator('.points .work button').first().tap();
        assert.equal(await view.page.locator('.points [data-point]:visible').count(), 4 + 3, 'of one work, and those that stand alone');
        await view.page.locator('#fixtures summary').tap();
        assert.equal(await view.page.locator('.fixtures li:visible').count(), 12);
        await fitsItsWidth(view.page);
        assert.deepEqual(await unreadableTexts(view.page), []);
      }
      const button = await view.page.locator('#blackout').boundingBox();
      assert.ok(button.height >= 44 && button.y >= 0 && button.y + button.height <= options.viewport.height, JSON.stringify(button));
      daemon.faulted.clear();
      daemon.alarms = [];
      await eventually('no alarm', async () => (await view.page.locator('#alarms .alarm').count()) === 0);
      await shot(view.page, name);
      assert.deepEqual(view.misdeeds, []);
      await view.close();
    });
  await solveChecks(browser, daemon, url, check, shot);
  await questionChecks(browser, daemon, url, check, shot);
  await daemon.close();
}

const url = option('--url');
const dist = option('--dist');
if (!url && !dist) {
  console.error('page_test.mjs: give --dist DIR (and --out DIR), or --url URL');
  process.exit(2);
}
const browser = await startBrowser();
try {
  if (url) await againstDaemon(browser, url);
  else await againstMock(browser, dist, option('--out') ?? path.join(dist, '..', 'web-test'));
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
}
// After a failure the mock daemon still listens, and would keep this process alive.
process.exit(process.exitCode ?? 0);
