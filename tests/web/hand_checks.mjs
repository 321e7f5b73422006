// A fixture in hand in the 3-D room: its spot is dragged and the predicted light follows; levels, solo, identify, park.
import assert from 'node:assert/strict';
import { eventually, openPage } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { fitsItsWidth } from './page_checks.mjs';

const WITHIN_MS = 30_000; // a software renderer beside a build
const VIEWS = {
  phone: { viewport: { width: 390, height: 844 }, colorScheme: 'light', hasTouch: true, isMobile: true },
  tablet: { viewport: { width: 820, height: 1180 }, colorScheme: 'dark', hasTouch: true, isMobile: true },
  desktop: { viewport: { width: 1280, height: 800 }, colorScheme: 'dark' },
};

/** Each metre of x adds 10 lx to the first point; nothing is reached beyond x = 9 m. */
function answer(daemon, body) {
  const [wanted] = body.fixtures;
  const status = daemon.status();
  const reached = !wanted.aim || wanted.aim[0] < 9;
  return {
    reflections: body.reflections, text: '',
    fixtures: [{ fixture: wanted.fixture, level: wanted.level, pan_deg: wanted.pan_deg ?? 7.5, tilt_deg: wanted.tilt_deg ?? 33, reached, why: reached ? '' : 'tilt 150° is needed, and it goes from -135° to 135°' }],
    points: status.points.map((p, i) => ({ name: p.name, lux: p.predicted_lux + (i === 0 ? 30 + 10 * (wanted.aim?.[0] ?? 0) : 0), ...(body.reflections ? { standard_error_lux: 1 } : {}) })),
  };
}

/** Where the spot is in the window; undefined while there is none. */
export const spotOf = async (page) => {
  const [x, y] = ((await page.locator('.room-3d').getAttribute('data-spot')) ?? '').split(' ').map(Number);
  const frame = await page.locator('.room-3d').boundingBox();
  return Number.isFinite(y) ? { x: frame.x + x, y: frame.y + y } : undefined;
};
export const steadySpot = async (page) => {
  let before;
  await eventually('the spot is there, and the picture stands still', async () => {
    const [last, now] = [before, await spotOf(page)];
    before = now;
    await new Promise((resolve) => setTimeout(resolve, 300));
    return (now !== undefined && last !== undefined && Math.hypot(now.x - last.x, now.y - last.y) < 0.5) || [last, now];
  }, WITHIN_MS);
  return before;
};

export async function handChecks(browser, daemon, url, check, shot) {
  const { previews } = daemon.plans;
  daemon.plans.preview = (body) => answer(daemon, body);
  daemon.dark = { 'spot-5': { moves: true, parks: true, level: 0.4, target_level: 0.4, mount_axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] } };
  for (const [size, options] of Object.entries(VIEWS)) {
    const { page, misdeeds, close } = await openPage(browser, url, options);
    await page.waitForSelector('body.ready');
    await page.locator('#show-room').click();
    await eventually('the room is there', async () => Number(await page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS })) > 100, WITHIN_MS);
    const said = async (what, text) => eventually(what, async () => text.test(await page.locator('.hand').innerText()) || page.locator('.hand').innerText(), WITHIN_MS);

    await check(`${size}: a head is taken in hand, and its spot is where it looks`, async () => {
      await page.locator('#hand-which').selectOption('spot-5');
      await said('what to do', /Drag its spot/);
      assert.ok(await page.locator('#hand-turn').isDisabled(), 'there is no other aim yet');
      await page.locator('.room-3d').scrollIntoViewIfNeeded();
      await steadySpot(page);
    });

    if (size === 'desktop')
      await check('the spot is dragged, the predicted light follows, and the head is sent there', async () => {
        previews.length = 0;
        daemon.posts.length = 0;
        const from = await steadySpot(page);
        await page.mouse.move(from.x, from.y);
        await page.mouse.down();
        for (let i = 1; i <= 6; ++i) await page.mouse.move(from.x + 8 * i, from.y - 2 * i);
        await page.mouse.up();
        await eventually('it was asked', async () => previews.length > 0, WITHIN_MS);
        await eventually('with reflections when it rests', async () => previews.at(-1).reflections === true || previews.at(-1), WITHIN_MS);
        const { aim, level, fixture } = previews.at(-1).fixtures[0];
        assert.equal(fixture, 'spot-5');
        assert.equal(level, 0.4);
        assert.ok(aim.every(Number.isFinite) && aim[0] > -0.3 && aim[0] < 14.3 && aim[2] > -0.1, JSON.stringify(aim));
        await said('the light', /Predicted, with reflected light/);
        await said('the point', /drawing-1-1/);
        const to = await steadySpot(page);
        assert.ok(Math.abs(to.x - from.x - 48) < 3, `the spot is under the pointer: ${from.x} to ${to.x}`);
        await eventually('the scale is that of the prediction', async () => /predicted/i.test(await page.locator('.lux-scale').innerText()) || page.locator('.lux-scale').innerText());
        await shot(page, 'room-hand-desktop');
        await page.locator('#hand-turn').click();
        await eventually('it is sent', async () => daemon.posts.some((p) => p.path === '/api/aim') || daemon.posts);
        assert.deepEqual(daemon.posts.find((p) => p.path === '/api/aim').body, { fixture: 'spot-5', pan_deg: 7.5, tilt_deg: 33, level: 0.4, for_s: 60 });
        await said('for how long', /back after 60 s/);
      });

    if (size === 'desktop')
      await check('what cannot be reached says why, and is not sent', async () => {
        daemon.plans.preview = (body) => {
          const light = answer(daemon, body);
          light.fixtures[0] = { ...light.fixtures[0], reached: false, why: 'it would look into keep-out zone "stage"' };
          return light;
        };
        await page.locator('#hand-pan').fill('20');
        await said('why', /It cannot look there: it would look into keep-out zone "stage"/);
        assert.ok(await page.locator('#hand-turn').isDisabled());
        daemon.plans.preview = (body) => answer(daemon, body);
      });

    if (size === 'desktop')
      await check('levels, solo, identify, park and release are sent', async () => {
        daemon.posts.length = 0;
        await page.locator('#hand-level').fill('20');
        await eventually('its light is asked for', async () => previews.at(-1).fixtures[0].level === 0.2 || previews.at(-1));
        for (const id of ['hold', 'solo', 'identify', 'park', 'release']) {
          const before = daemon.posts.length;
          await page.locator(`#hand-${id}`).click();
          await eventually(`${id} is sent`, async () => daemon.posts.length === before + 1 || daemon.posts);
        }
        const [hold, solo, identify, park] = daemon.posts.map((p) => p.body);
        assert.deepEqual(hold, { fixtures: ['spot-5'], level: 0.2 });
        assert.equal(Object.keys(solo.levels).length, 12);
        assert.equal(solo.levels['spot-5'], 0.2);
        assert.equal(solo.levels['spot-1'], 0);
        assert.deepEqual(identify, { fixture: 'spot-5' });
        assert.deepEqual(park, { fixtures: ['spot-5'] });
        daemon.overrides = [];
        await page.locator('#hand-which').selectOption('spot-*');
        await said('a group', /A group: its levels/);
        assert.equal(await page.locator('#hand-turn').isVisible(), false);
        await page.locator('#hand-which').selectOption('spot-2');
        await said('one that cannot turn', /It cannot turn by itself/);
        await page.locator('#hand-which').selectOption('spot-5');
      });

    await check(`${size}: it fits, is readable, and choosing nothing leaves nothing in hand`, async () => {
      await page.locator('#hand-level').fill('30');
      await said('the light', /Predicted/);
      await fitsItsWidth(page);
      assert.deepEqual(await unreadableTexts(page), []);
      const cut = await page.locator('.hand button:visible, .hand select').evaluateAll((all) => all.filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.id));
      assert.deepEqual(cut, []);
      await page.locator('#plan').screenshot({ path: shot.path(`hand-${size}`) });
      await page.locator('#hand-which').selectOption('');
      await page.locator('.room-3d').scrollIntoViewIfNeeded(); // out of sight it is not drawn
      await eventually('no spot', async () => {
        const at = await page.locator('.room-3d').getAttribute('data-spot');
        return at === '' || [at, await page.locator('#hand-which').inputValue(), await page.locator('.room-3d').getAttribute('data-frames'), await page.evaluate(() => [scrollY, document.querySelector('.room-3d').getBoundingClientRect().y])];
      }, WITHIN_MS);
      await said('what to do', /Nothing moves until you say so/);
    });
    assert.deepEqual(misdeeds, []);
    await close();
  }
  daemon.dark = {};
  daemon.plans.preview = undefined;
}
