// The room in 3-D, in headless Chromium (WebGL by SwiftShader), against the mock.
import assert from 'node:assert/strict';
import { eventually, openPage } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { METERED, POINTS } from './mock_rig.mjs';
import { fitsItsWidth } from './page_checks.mjs';
import { changed, variety } from './pixels.mjs';

const WITHIN_MS = 30_000; // a software renderer beside a build
const VIEWS = [
  ['phone-dark', { viewport: { width: 360, height: 780 }, colorScheme: 'dark', hasTouch: true, isMobile: true }],
  ['phone-light', { viewport: { width: 360, height: 780 }, colorScheme: 'light', hasTouch: true, isMobile: true }],
  ['tablet-light', { viewport: { width: 820, height: 1180 }, colorScheme: 'light', hasTouch: true, isMobile: true }],
  ['desktop-dark', { viewport: { width: 1440, height: 900 }, colorScheme: 'dark' }],
  ['desktop-light', { viewport: { width: 1440, height: 900 }, colorScheme: 'light' }],
];

async function openRoom(browser, url, options) {
  const view = await openPage(browser, url, options);
  await view.page.waitForSelector('body.ready');
  await view.page.locator('#show-room').click();
  await eventually('the room is there', async () => {
    const [triangles, said] = [await view.page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS }), await view.page.locator('.room-said').textContent()];
    return (Number(triangles) > 100 && said === '') || [triangles, said];
  }, WITHIN_MS);
  return view;
}

const frames = (page) => page.locator('.room-3d').getAttribute('data-frames').then(Number);
/** Until a frame is drawn that was not begun when this was called. */
async function drawn(page) {
  const before = await frames(page);
  await eventually('another frame', async () => (await frames(page)) >= before + 2 || (await frames(page)), WITHIN_MS);
}
/** The picture alone, without the page's text on it. */
async function picture(page) {
  await page.evaluate(() => document.querySelector('.room-labels').style.setProperty('visibility', 'hidden'));
  const png = await page.locator('.room-3d canvas').screenshot();
  await page.evaluate(() => document.querySelector('.room-labels').style.removeProperty('visibility'));
  return png;
}
const chosenRow = (page) => page.locator('.points tr.chosen th').allTextContents();

export async function roomChecks(browser, daemon, url, check, shot) {
  // Small, since the processor draws it.
  const { page, misdeeds, close } = await openPage(browser, url, { viewport: { width: 1100, height: 720 } });
  const key = async (...keys) => {
    for (const one of keys) await page.keyboard.press(one);
  };
  let place; // of a point, from the picture's upper left
  const scripts = [];
  page.on('response', (response) => scripts.push(new URL(response.url()).pathname));

  await check('the room in 3-D is fetched when it is asked for, not before', async () => {
    await page.waitForSelector('body.ready');
    assert.deepEqual(scripts.filter((file) => /room_3d|scene/.test(file)), []);
    daemon.sceneAnswers.length = 0;
    await page.locator('#show-room').click();
    await eventually('it is there', async () => Number(await page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS })) > 100, WITHIN_MS);
    await eventually('nothing more is said', async () => (await page.locator('.room-said').isVisible()) === false, WITHIN_MS);
    assert.deepEqual(daemon.sceneAnswers, [200]);
    assert.equal(await page.locator('svg.plan').isVisible(), false);
  });

  await check('it draws: many colours, none of them nearly everything', async () => {
    await drawn(page);
    const { colours, commonest } = variety(await picture(page));
    assert.ok(colours > 20 && commonest < 0.7, JSON.stringify({ colours, commonest }));
    await shot(page, 'room-verdict');
  });

  await check('keys turn, zoom and bring it back', async () => {
    await page.locator('.room-3d').focus();
    const before = await picture(page);
    await key('ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowUp', '+');
    await eventually('another picture', async () => {
      const share = changed(before, await picture(page));
      return share > 0.15 || share;
    }, WITHIN_MS);
    await key('0');
    await eventually('as before', async () => {
      const share = changed(before, await picture(page));
      return share < 0.03 || share;
    }, WITHIN_MS);
  });

  await check('each way to look is another picture', async () => {
    let before = await picture(page);
    for (const [view, words] of [['walk', 'Walk'], ['above', 'From above'], ['side', 'From the front'], ['side', 'From the right'], ['orbit', 'Around']]) {
      await page.locator(`[data-view=${view}]`).click();
      assert.equal(await page.locator(`[data-view=${view}]`).innerText(), words);
      assert.equal(await page.locator('.room-tools [aria-pressed=true]').count(), 1);
      await eventually(`${words} is drawn`, async () => {
        const now = await picture(page);
        const [share, { colours }] = [changed(before, now), variety(now)];
        return (share > 0.1 && colours > 10) || { share, colours };
      }, WITHIN_MS);
      before = await picture(page);
      await shot(page, `room-${words.replaceAll(' ', '-').toLowerCase()}`);
    }
  });

  await check('what is chosen in a table is marked in the room, and named', async () => {
    // The event alone: to hover, the page would be scrolled to the table, and a room out of sight is not drawn.
    await page.locator('.room-3d').scrollIntoViewIfNeeded();
    const row = page.locator('.points tr[data-point]', { hasText: 'bronze-top' });
    await row.dispatchEvent('pointerenter');
    await eventually('named', async () => (await page.locator('.room-label.chosen:visible').allTextContents()).join() === 'bronze-top', WITHIN_MS);
    // Its name stands 26 px above it.
    const [label, canvas] = [await page.locator('.room-label.chosen').boundingBox(), await page.locator('.room-3d canvas').boundingBox()];
    place = { x: label.x + label.width / 2 - canvas.x, y: label.y + label.height / 2 + 26 - canvas.y };
    await page.locator('.fixtures li').nth(4).dispatchEvent('pointerenter');
    await eventually('a fixture too', async () => (await page.locator('.room-label.chosen:visible').allTextContents()).join() === 'spot-5', WITHIN_MS);
    await page.locator('.fixtures li').nth(4).dispatchEvent('pointerleave');
    await eventually('no longer', async () => (await page.locator('.room-label.chosen:visible').count()) === 0, WITHIN_MS);
  });

  await check('what the keys or the pointer are on is marked in the table, with its card', async () => {
    await page.locator('.room-3d').scrollIntoViewIfNeeded();
    await page.locator('.room-3d').focus();
    const canvas = await page.locator('.room-3d canvas').boundingBox();
    const at = { x: canvas.x + place.x, y: canvas.y + place.y };
    const wanted = POINTS.findIndex((p) => p.name === 'bronze-top');
    await key(...Array.from({ length: wanted + 1 }, () => 'n'));
    await eventually('by keys', async () => (await chosenRow(page)).join() === 'bronze-top' || (await chosenRow(page)), WITHIN_MS);
    assert.match(await page.locator('.room-stage [role=status]').textContent(), /^bronze-top: .*Goal 300 lux, predicted .* ± .*, measured \d/);
    await eventually('its card by keys', async () => /bronze-top/.test(await page.locator('.room-3d .tip').innerText()), WITHIN_MS);
    await key('Escape');
    await eventually('nothing is chosen', async () => (await chosenRow(page)).length === 0, WITHIN_MS);
    await page.mouse.move(at.x + 2, at.y - 2);
    await eventually('by the pointer', async () => (await chosenRow(page)).join() === 'bronze-top' || (await chosenRow(page)), WITHIN_MS);
    const tip = page.locator('.room-3d .tip');
    await eventually('its card', async () => {
      const words = (await tip.isVisible()) ? await tip.innerText() : '';
      return ['bronze-top', 'goal', '300 lx', 'predicted', '±', 'measured', 'ago'].every((word) => words.includes(word)) || words;
    }, WITHIN_MS);
    await shot(page, 'room-probe');
    await page.mouse.move(2, 2);
    await eventually('gone with the pointer', async () => !(await tip.isVisible()) && (await chosenRow(page)).length === 0, WITHIN_MS);
  });

  await check('beside a point, the card tells the surface', async () => {
    await page.locator('[data-view=above]').click();
    await drawn(page);
    const box = await page.locator('.room-3d canvas').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height * 0.62);
    await eventually('the floor', async () => {
      const words = await page.locator('.room-3d .tip').innerText();
      return /oak floor.*reflectance\s*26 %.*height\s*0\.00 m/s.test(words) || words;
    }, WITHIN_MS);
    await page.mouse.move(2, 2);
    await page.locator('[data-view=orbit]').click();
  });

  await check('layers in lux: one scale for goal, predicted and measured, with round numbers', async () => {
    const scale = page.locator('.lux-scale');
    assert.equal(await scale.isVisible(), false, 'a verdict has none');
    const ticks = {};
    let before = await picture(page);
    for (const layer of ['goal', 'predicted', 'measured', 'difference', 'uncertainty']) {
      await page.locator('#room-layer').selectOption(layer);
      await eventually(`the scale of ${layer}`, async () => {
        ticks[layer] = await page.locator('.lux-ticks span').allTextContents();
        return (await scale.isVisible()) && ticks[layer].length >= 3 && new RegExp(layer === 'difference' ? 'above or below' : layer === 'uncertainty' ? 'standard error' : layer).test(await scale.innerText());
      }, WITHIN_MS);
      const values = ticks[layer].map((t) => Number(t.replace('\u2212', '-')));
      values.slice(1).forEach((v, i) => assert.ok(v > values[i], `${values}`));
      await drawn(page);
      const now = await picture(page);
      if (layer === 'goal' || layer === 'difference') assert.ok(changed(before, now) > 0.0005, `${layer} looks another way: ${changed(before, now)}`);
      before = now;
      await shot(page, `room-${layer}`);
    }
    assert.deepEqual(ticks.goal, ticks.predicted);
    assert.deepEqual(ticks.goal, ticks.measured);
    assert.deepEqual(ticks.goal, ['0', '50', '100', '150', '200', '250', '300', '350']);
    assert.equal(ticks.difference.length % 2, 1);
    assert.equal(ticks.difference[(ticks.difference.length - 1) / 2], '0');
    await page.locator('#room-layer').selectOption('measured');
    await eventually('numbers of the points with a meter alone', async () => {
      const count = await page.locator('.room-label.lux:visible').count();
      return (count > 0 && count <= METERED.length) || count;
    }, WITHIN_MS);
    await page.locator('#room-layer').selectOption('verdict');
    await eventually('no scale', async () => !(await scale.isVisible()), WITHIN_MS);
  });

  await check('a question by hand is marked where it is asked', async () => {
    daemon.question = { id: 'q-9', text: 'Hold the luxmeter at "bench".', position: POINTS.find((p) => p.name === 'bench').position, normal: [0, 0, 1] };
    await eventually('marked', async () => (await page.locator('.room-label.asked:visible').allTextContents()).join() === 'luxmeter here', WITHIN_MS);
    daemon.question = undefined;
    await eventually('no longer', async () => (await page.locator('.room-label.asked:visible').count()) === 0, WITHIN_MS);
  });

  await check('a frame costs the page little of its own, whatever the renderer does', async () => {
    const session = await page.context().newCDPSession(page);
    await session.send('Performance.enable', { timeDomain: 'threadTicks' });
    const spent = async () => (await session.send('Performance.getMetrics')).metrics.find((m) => m.name === 'ScriptDuration').value;
    await page.locator('.room-3d').focus();
    const [before_s, before] = [await spent(), await frames(page)];
    for (let i = 0; i < 12; ++i) {
      await key('ArrowLeft');
      await drawn(page);
    }
    const [count, used_s] = [(await frames(page)) - before, (await spent()) - before_s];
    console.log(`    ${((1000 * used_s) / count).toFixed(1)} ms of the main thread's time for scripts in each of ${count} frames (with the calls of WebGL)`);
    assert.ok(used_s / count < 0.05, `${used_s} s in ${count} frames`);
    await session.detach();
  });

  await check('the plan comes back, and 3-D is remembered; the geometry is not fetched twice', async () => {
    await page.locator('#show-plan').click();
    assert.ok(await page.locator('svg.plan').isVisible());
    assert.equal(await page.locator('.room-3d').isVisible(), false);
    await page.locator('#show-room').click();
    assert.ok(await page.locator('.room-3d').isVisible());
    daemon.sceneAnswers.length = 0;
    await page.reload();
    await eventually('shown at once', async () => Number(await page.locator('.room-3d').getAttribute('data-triangles', { timeout: WITHIN_MS })) > 100, WITHIN_MS);
    assert.deepEqual(daemon.sceneAnswers, [304]);
  });

  await check('a rig without a scene, and a broken one: lamps and points alone, and it says so', async () => {
    const whole = daemon.scene;
    for (const [scene, words] of [[undefined, /no scene: lamps and points are shown alone/], [whole.subarray(0, 500), /cannot be read: its JSON is cut off.*shown alone/]]) {
      daemon.scene = scene;
      await page.reload();
      await eventually('it says so', async () => words.test(await page.locator('.room-said').innerText()) || (await page.locator('.room-said').innerText()), WITHIN_MS);
      await drawn(page);
      assert.ok(variety(await picture(page)).colours > 4, 'the lamps and points are drawn');
    }
    daemon.scene = whole;
  });
  // A 404 is the daemon's answer here, and Chromium notes it.
  assert.deepEqual(misdeeds.filter((m) => !/status of 404/.test(m)), []);
  await close();

  await check('without WebGL the plan stays, and a sentence says why', async () => {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const bare = await context.newPage();
    await bare.addInitScript(() => {
      const get = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
        return /webgl/.test(kind) ? null : get.call(this, kind, ...more);
      };
    });
    const asked = [];
    bare.on('request', (request) => asked.push(request.url()));
    await bare.goto(url);
    await bare.waitForSelector('body.ready');
    await bare.locator('#show-room').click();
    await eventually('the sentence', async () => /cannot draw in 3-D .no WebGL 2|has no WebGL 2/.test(await bare.locator('.room-said').innerText()));
    assert.ok(await bare.locator('svg.plan').isVisible());
    assert.equal(await bare.locator('#show-plan').getAttribute('aria-pressed'), 'true');
    assert.deepEqual(asked.filter((address) => /room_3d/.test(address)), [], 'three is not fetched for nothing');
    await context.close();
  });

  for (const [name, options] of VIEWS)
    await check(`3-D on ${name}: fits, readable, no text cut`, async () => {
      const view = await openRoom(browser, url, options);
      await view.page.locator('#room-layer').selectOption('predicted');
      await view.page.locator('.room-keys summary').click();
      await drawn(view.page);
      await fitsItsWidth(view.page);
      assert.deepEqual(await unreadableTexts(view.page), []);
      const cut = await view.page.locator('#plan button:visible, #plan label, #plan dd, .lux-title, .room-said:visible').evaluateAll((all) =>
        all.filter((e) => e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).display !== 'inline').map((e) => e.textContent));
      assert.deepEqual(cut, []);
      const outside = await view.page.locator('.lux-ticks span, .room-label:visible').evaluateAll((all) =>
        all.filter((e) => { const b = e.getBoundingClientRect(); return b.left < 0 || b.right > window.innerWidth; }).map((e) => e.textContent));
      assert.deepEqual(outside, []);
      await view.page.locator('.room-keys summary').click();
      await view.page.locator('.room-tools').scrollIntoViewIfNeeded();
      if (options.hasTouch) await touches(view.page);
      await shot(view.page, `room-${name}`);
      assert.deepEqual(view.misdeeds, []);
      await view.close();
    });
}

/** Two fingers move the room, a finger that is held shows what is under it. */
async function touches(page) {
  await page.evaluate(() => document.querySelector('.room-3d').scrollIntoView({ block: 'center' }));
  await drawn(page);
  const session = await page.context().newCDPSession(page);
  const touch = (type, ...places) => session.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
  const box = await page.locator('.room-3d canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];

  await touch('touchStart', [x, y + 0.2 * box.height]);
  await eventually('the card under a finger that is held', async () => (await page.locator('.room-3d .tip').isVisible()), WITHIN_MS);
  await touch('touchEnd');

  const before = await picture(page);
  await touch('touchStart', [x - 30, y], [x + 30, y]);
  for (let i = 1; i <= 6; ++i) await touch('touchMove', [x - 30 - 10 * i, y], [x + 30 + 10 * i, y]);
  await touch('touchEnd');
  await eventually('two fingers change the picture', async () => {
    const share = changed(before, await picture(page));
    return share > 0.1 || share;
  }, WITHIN_MS);
  await session.detach();
}
