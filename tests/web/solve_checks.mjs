// The page solves, compares and applies; against the mock daemon.
import assert from 'node:assert/strict';
import { eventually, openPage } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { fitsItsWidth } from './page_checks.mjs';

const SIZES = { desktop: { width: 1440, height: 900 }, tablet: { width: 820, height: 1180 }, phone: { width: 390, height: 844 } };
const press = (page, id) => page.locator(`#${id}`).click();
const state = async (page) => page.locator('.solve-state').innerText();
const shows = (what, page, text, selector = '.solve-state') =>
  eventually(what, async () => text.test(await page.locator(selector).innerText()) || page.locator(selector).innerText(), 6000);

export async function solveChecks(browser, daemon, url, check, shot) {
  const { plans } = daemon;
  const { page, misdeeds, close } = await openPage(browser, url);
  await page.waitForSelector('body.ready');

  await check('a solve shows its progress, and can be stopped with the best so far', async () => {
    await press(page, 'solve-start');
    await shows('the progress', page, /Solving\. levels: error 12 %/);
    plans.job.doing = 'error 3 %';
    plans.job.can_be_taken = true;
    await shows('the best so far', page, /error 3 %/);
    await shows('what stopping does', page, /take the best so far/, '#solve-cancel');
    await shot(page, 'desktop-dark-solving');
    await press(page, 'solve-cancel');
    await shows('it is cancelled', page, /the best so far/);
    assert.ok(await page.locator('.solve-result').isVisible());
  });

  await check('a plan is compared with the light in force, what is missed first and in words', async () => {
    await press(page, 'solve-start');
    await eventually('it runs', async () => plans.job.state === 'runs');
    plans.end('done', { plan: plans.plan() });
    await shows('a plan is found', page, /A plan is found\. Nothing changes/);
    assert.equal(plans.applied.length, 0);
    await shows('both counted', page, /In force[\s\S]*goals met[\s\S]*W[\s\S]*New plan[\s\S]*35 of 36 goals met, 1 missed; 78 W/, '.solve-sums');
    assert.match(await page.locator('.solve-points li').first().innerText(), /missed[\s\S]*another lamp on it would mend it/);
    await fitsItsWidth(page);
    await page.locator('#solve').scrollIntoViewIfNeeded();
    await shot(page, 'desktop-dark-compared');
  });

  await check('it is applied with a fade, readings come in beside it, and the plan before comes back', async () => {
    const before = plans.inForce;
    await page.locator('#solve-fade').selectOption('5');
    await press(page, 'solve-apply');
    await shows('it is in force', page, /The new plan is in force/, '.solve-answer');
    assert.equal(plans.applied.at(-1).fade_s, '5');
    assert.equal(plans.applied.at(-1).plan.points.length, 36);
    await shows('readings', page, /measured [\d.]+ lx/, '.solve-points');
    await press(page, 'solve-back');
    await eventually('back', async () => plans.applied.length === 2 || plans.applied.length);
    assert.deepEqual(plans.applied.at(-1).plan, before);
  });

  await check('a failed and a lost job are said to be so', async () => {
    await press(page, 'solve-start');
    await eventually('it runs', async () => plans.job.state === 'runs');
    plans.end('failed', { why: 'no lamp reaches "fern"' });
    await shows('failed', page, /No plan: no lamp reaches "fern"/);
    await press(page, 'solve-start');
    await shows('the next', page, /Solving/);
    plans.end('lost', { why: 'the daemon that had it has ended' });
    await shows('lost', page, /this job is lost\. Solve again/);
    await press(page, 'solve-start');
    await shows('the next', page, /Solving/);
    plans.job = undefined;
    await eventually('forgotten', async () => /^Finds a plan/.test(await state(page)) || state(page));
  });
  assert.deepEqual(misdeeds, []);
  await close();

  for (const [size, viewport] of Object.entries(SIZES))
    await check(`${size}: a solve of another client is shown, fits and is readable`, async () => {
      plans.job = { id: '00000000-0000aa', kind: 'solve', state: 'runs', stage: 'levels', doing: 'error 2 %', has_plan: false };
      const view = await openPage(browser, url, { viewport, colorScheme: 'light', ...(size === 'phone' ? { hasTouch: true, isMobile: true } : {}) });
      await shows('it is seen', view.page, /error 2 %/);
      plans.end('done', { plan: plans.plan() });
      await shows('a plan', view.page, /A plan is found/);
      await view.page.locator('.solve-result summary').evaluateAll((all) => all.forEach((one) => (one.parentElement.open = true)));
      await fitsItsWidth(view.page);
      assert.deepEqual(await unreadableTexts(view.page), []);
      await view.page.locator('#solve').screenshot({ path: shot.path(`solve-${size}`) });
      assert.deepEqual(view.misdeeds, []);
      await view.close();
    });
  plans.job = undefined;
}
