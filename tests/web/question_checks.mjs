// What somebody with a luxmeter in the hand is asked on the page, and how it is answered there.
import assert from 'node:assert/strict';
import { eventually, openPage } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { POINTS } from './mock_rig.mjs';
import { fitsItsWidth } from './page_checks.mjs';

const place = (name) => POINTS.find((p) => p.name === name);
const question = (id, name, more = {}) => ({ id, text: `Hold the luxmeter at "${name}": x ${place(name).position[0].toFixed(2)} m, y ${place(name).position[1].toFixed(2)} m, `
  + `${place(name).position[2].toFixed(2)} m high, facing ${place(name).normal[2] ? 'up' : '-y'}.`,
  position: place(name).position, normal: place(name).normal, step: 1, steps: 3, readings: 3, known_to: 0.12, known_to_worst: 0.2, ...more });
const DARK = question('q-1', 'bronze-top');
const LIT = question('q-2', 'bronze-top', { step: 2, fixture: 'spot-7', level: 0.62, readings: 4 });
const WALL = question('q-3', 'textile-2', { step: 1, steps: 2, readings: 5, known_to: 0.081, known_to_worst: 0.13 });

const VIEWS = [
  ['desktop-dark', { viewport: { width: 1280, height: 800 }, colorScheme: 'dark' }],
  ['desktop-light', { viewport: { width: 1280, height: 800 }, colorScheme: 'light' }],
  ['tablet-light', { viewport: { width: 820, height: 1180 }, colorScheme: 'light', hasTouch: true, isMobile: true }],
  ['phone-dark', { viewport: { width: 390, height: 844 }, colorScheme: 'dark', hasTouch: true, isMobile: true }],
  ['phone-light', { viewport: { width: 390, height: 844 }, colorScheme: 'light', hasTouch: true, isMobile: true }],
];

export async function questionChecks(browser, daemon, url, check, shot) {
  const { page, misdeeds, close } = await openPage(browser, url, { viewport: { width: 1280, height: 800 } });
  await page.waitForSelector('body.ready');
  const card = page.locator('#question');
  const field = page.getByLabel('The meter shows');
  // Forced: a button may be there, but not to be pressed.
  const press = (name) => card.getByRole('button', { name }).click({ force: true });
  const shown = (pattern) => eventually(String(pattern), async () => pattern.test(await card.innerText()) || (await card.innerText()), 2000);
  const heard = (pattern) => eventually(`heard: ${pattern}`, async () => {
    const said = await page.locator('.question-room [role=status]').textContent();
    return pattern.test(said) || said;
  }, 2000);
  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const answers = () => daemon.posts.filter((p) => p.path === '/api/answer').map((p) => p.body);
  daemon.posts.length = 0;

  await check('without a question there is no card', async () => {
    assert.equal(await card.isVisible(), false);
    assert.equal(await page.locator('.asked *').count(), 0);
  });

  await check('a question says where to hold the meter, what is lit, and how well the light is known', async () => {
    daemon.question = DARK;
    await shown(/Hold the luxmeter at "bronze-top": x 3\.60 m, y 4\.40 m, 1\.60 m high, facing up\.\s*Every lamp is dark now/);
    assert.match(await card.innerText(), /known to 12\.0 % so far, at the worst to 20\.0 %; 3 readings/);
    assert.match(await card.innerText(), /1 of 3 here/);
    await heard(/^Hold the luxmeter at "bronze-top".*Every lamp is dark now\.$/);
    daemon.question = LIT;
    await shown(/Lit now: spot-7 alone, at 62 %/);
    await heard(/^Lit now: spot-7/);
    assert.equal(await page.locator('.beam.asked-lamp').count(), 1);
  });

  await check('the plan marks the place, its height, and the way the meter looks', async () => {
    const middle = async (selector) => {
      const box = await page.locator(selector).boundingBox();
      return [box.x + box.width / 2, box.y + box.height / 2];
    };
    const index = POINTS.findIndex((p) => p.name === 'bronze-top');
    const [a, b] = [await middle('.asked > circle:not([class])'), await middle(`svg.plan .point >> nth=${index} >> .shape`)];
    assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 8, `marker at ${a}, point at ${b}`);
    assert.equal(await page.locator('.asked').getAttribute('data-looks'), 'up');
    assert.equal(await page.locator('.asked text').textContent(), '1.60 m high');
    daemon.question = WALL;
    await eventually('it looks to the side', async () => (await page.locator('.asked').getAttribute('data-looks')) === 'side', 2000);
    const arrow = await page.locator('.asked path:not([class])').boundingBox();
    const ring = await middle('.asked > circle:not([class])');
    assert.ok(arrow.y + arrow.height / 2 > ring[1], 'world −y is down on the plan');
    daemon.question = LIT;
    await shown(/spot-7/);
  });

  await check('a number that is typed outlives updates, and the focus stays', async () => {
    await field.focus();
    await page.keyboard.type('182,');
    await wait(700);
    await page.keyboard.type('5');
    assert.equal(await field.inputValue(), '182,5');
    assert.equal(await field.evaluate((e) => e === document.activeElement), true);
    assert.equal(await field.getAttribute('inputmode'), 'decimal');
  });

  await check('Enter sends it with the id of the question, once, and the page says that it was taken', async () => {
    await page.keyboard.press('Enter');
    await page.keyboard.press('Enter');
    await shown(/Taken: 182\.5 lx\. The next lamp is being lit/);
    await heard(/^Taken: 182\.5 lx/);
    assert.deepEqual(answers(), [{ id: 'q-2', what: 'reading', lux: 182.5 }]);
    assert.equal(await field.inputValue(), '');
    await press('Take reading');
    await press('Skip this lamp');
    assert.equal(answers().length, 1, 'nothing is sent while the next lamp is lit');
    assert.equal(await card.getByRole('button', { name: 'Skip this lamp' }).getAttribute('aria-disabled'), 'true');
    await field.focus();
    daemon.question = WALL;
    await shown(/textile-2/);
    assert.equal(await field.evaluate((e) => e === document.activeElement), true, 'the next reading can be typed at once');
  });

  await check('what is no reading is said beside the field, and not sent', async () => {
    const before = answers().length;
    for (const [typed, words] of [['', /Type what the meter shows/], ['bright', /no number of lux/], ['1,234', /1234 or 1\.234/], ['-3', /no number/], ['900000', /More than/]]) {
      await field.fill(typed);
      await press('Take reading');
      await eventually(typed, async () => words.test(await page.locator('#question-wrong').innerText()), 1000);
      assert.equal(await field.getAttribute('aria-invalid'), 'true');
      assert.equal(await field.inputValue(), typed);
    }
    assert.equal(answers().length, before);
    await field.fill('20');
    assert.equal(await page.locator('#question-wrong').innerText(), '');
  });

  await check('a question answered elsewhere takes what was typed with it, and says so', async () => {
    daemon.question = { ...WALL, answer: { what: 'reading', lux: 21 } };
    await shown(/Taken: 21 lx/);
    daemon.question = { ...WALL, id: 'q-4', step: 2, fixture: 'spot-4', level: 1 };
    await shown(/What was typed here is gone/);
    assert.equal(await field.inputValue(), '');
  });

  await check('an answer that comes too late is refused, and the number stays', async () => {
    const { status } = daemon;
    const old = daemon.status();
    daemon.status = () => old; // the page has not heard yet
    daemon.question = { ...WALL, id: 'q-5' };
    await field.fill('33');
    await press('Take reading');
    await eventually('refused', async () => /Not taken: this is not asked any more/.test(await page.locator('#question-wrong').innerText()), 2000);
    assert.equal(await field.inputValue(), '33');
    assert.equal(daemon.question.answer, undefined);
    daemon.status = status;
    await shown(/Every lamp is dark now[^]*What was typed here is gone/);
  });

  await check('skip, another place, and end, which asks once more', async () => {
    await press('Skip this lamp');
    await shown(/Skipped/);
    daemon.question = { ...WALL, id: 'q-6' };
    await eventually('a new one', async () => (await card.getByRole('button', { name: 'Another place' }).getAttribute('aria-disabled')) === 'false', 2000);
    await press('Another place');
    await shown(/Another place is being looked for/);
    daemon.question = { ...WALL, id: 'q-7' };
    await eventually('a new one', async () => (await card.getByRole('button', { name: 'End' }).getAttribute('aria-disabled')) === 'false', 2000);
    await press('End');
    await heard(/Press again to end/);
    assert.equal(answers().at(-1).what, 'other_place', 'not yet');
    await press('Press again to end');
    await shown(/Ended/);
    assert.deepEqual(answers().slice(-3), [{ id: 'q-5', what: 'skip' }, { id: 'q-6', what: 'other_place' }, { id: 'q-7', what: 'end' }]);
    daemon.question = undefined;
    await eventually('no card', async () => !(await card.isVisible()), 2000);
    assert.equal(await page.locator('.asked *').count(), 0);
  });

  await check('markup in a question is text', async () => {
    daemon.question = { ...LIT, id: 'q-8', text: '<img src=x onerror=alert(1)>', fixture: '<b>spot</b>' };
    await shown(/<img src=x onerror=alert\(1\)>\s*Lit now: <b>spot<\/b> alone/);
    assert.equal(await page.locator('#question img, #question b').count(), 0);
  });
  assert.deepEqual(misdeeds, []);
  await close();

  for (const [name, options] of VIEWS)
    await check(`a question on ${name}: fits, readable, fingers hit its buttons, the place beside it`, async () => {
      daemon.question = name.startsWith('phone') ? { ...WALL, id: name } : { ...LIT, id: name };
      const view = await openPage(browser, url, options);
      await view.page.waitForSelector('.asked text');
      await eventually('the card', () => view.page.locator('#question').isVisible());
      await fitsItsWidth(view.page);
      assert.deepEqual(await unreadableTexts(view.page), []);
      for (const button of await view.page.locator('#question button, #question-lux').all())
        assert.ok((await button.boundingBox()).height >= 44);
      const [box, plan] = [await view.page.locator('#question').boundingBox(), await view.page.locator('svg.plan').boundingBox()];
      assert.ok(box.y < 200 && box.y + box.height <= options.viewport.height, `the card at ${box.y}, ${box.height} px high`);
      const gap = plan.y - (box.y + box.height);
      assert.ok(gap >= 0 && gap < 120, `the plan ${gap} px below the card`);
      await shot(view.page, `question-${name}`, { fullPage: options.isMobile === true });
      if (name === 'phone-dark') {
        await view.page.locator('#question-lux').fill('1,234');
        await view.page.locator('#question-take').tap();
        await view.page.locator('#question-end').tap();
        await fitsItsWidth(view.page);
        assert.deepEqual(await unreadableTexts(view.page), []);
        await shot(view.page, 'question-phone-wrong');
      }
      assert.deepEqual(view.misdeeds, []);
      await view.close();
    });
  daemon.question = undefined;
}
