// Accounts of a running daemon, in headless Chromium: each role logs in, sees what it may, and is refused the rest.
//   node tests/web/access_test.mjs --luxrig PROGRAM [--out FOLDER]
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { eventually, openPage, startBrowser } from './browser.mjs';
import { unreadableTexts } from './contrast.mjs';
import { fitsItsWidth } from './page_checks.mjs';

const source = (file) => fileURLToPath(new URL(`../../${file}`, import.meta.url));
const option = (name) => {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : undefined;
};
const luxrig = option('--luxrig') ?? source('build/release/bin/luxrig');
const out = option('--out');
if (out) mkdirSync(out, { recursive: true });

const folder = mkdtempSync(path.join(tmpdir(), 'luxrig-access-'));
const rig = path.join(folder, 'room');
cpSync(source('tests/rigs/room'), rig, { recursive: true });
const rigFile = path.join(rig, 'rig.toml');
writeFileSync(rigFile, readFileSync(rigFile, 'utf8').replace('[daemon]', '[daemon]\naccounts = "accounts.json"'));
const accounts = (words, password) => execFileSync(luxrig, ['accounts', rig, ...words], { input: password ? `${password}\n` : '', encoding: 'utf8', stdio: ['pipe', 'pipe', 'ignore'] });
const PEOPLE = { otto: 'look', anna: 'operate', ida: 'configure' };
for (const [name, role] of Object.entries(PEOPLE)) accounts(['add', name, '--role', role], `password of ${name}`);
const token = accounts(['token', 'ci', '--role', 'look']).trim();
assert.equal(statSync(path.join(rig, 'accounts.json')).mode & 0o777, 0o600);
assert.ok(!readFileSync(path.join(rig, 'accounts.json'), 'utf8').includes(token), 'the token is not in the file');

const daemon = spawn(luxrig, ['run', rig, '--sim', '--port', '0', '--max-error', '0.05', '--state', path.join(folder, 'state')],
  { env: { ...process.env, XDG_RUNTIME_DIR: folder } });
let log = '';
for (const stream of [daemon.stdout, daemon.stderr]) stream.on('data', (part) => (log += part));
const ended = new Promise((resolve) => daemon.once('exit', resolve));

/** As the page's own scripts could: {code, body}. */
const ask = (page, method, route, body) => page.evaluate(async ([how, where, what]) => {
  const answer = await fetch(where, { method: how, ...(what ? { headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(what) } : {}) });
  return { code: answer.status, body: await answer.json().catch(() => undefined) };
}, [method, route, body]);

async function logIn(page, name, password = `password of ${name}`) {
  await page.getByLabel('Name').fill(name);
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Log in', exact: true }).click();
}

let browser;
try {
  const line = /page and status: (\S+)/;
  await eventually('the daemon has a page', () => line.test(log) || log, 60000);
  const url = new URL('/', line.exec(log)[1]).href;
  browser = await startBrowser();

  for (const [name, role] of Object.entries(PEOPLE)) {
    const { page, misdeeds, close } = await openPage(browser, url);
    await page.waitForSelector('#login:not([hidden])');
    assert.deepEqual((await ask(page, 'GET', '/api/status')).code, 401);
    await eventually('the blackout button says to log in', async () => /Log in first/.test(await page.locator('#blackout').innerText()));
    assert.ok(!(await page.locator('#blackout').isEnabled()), 'nobody is there who may');
    if (role === 'look') {
      await logIn(page, name, 'wrong');
      await eventually('a wrong password is told', async () => /wrong name or password/.test(await page.locator('#login-wrong').innerText()) || (await page.locator('#login-wrong').innerText()), 30000);
      for (const [size, width] of [['phone', 390], ['tablet', 820], ['desktop', 1280]]) {
        await page.setViewportSize({ width, height: 900 });
        await fitsItsWidth(page);
        assert.deepEqual(await unreadableTexts(page), []);
        if (out) await page.screenshot({ path: path.join(out, `login-${size}.png`) });
      }
    }
    await logIn(page, name);
    await page.waitForSelector('body.ready', { timeout: 30000 });
    await eventually('the form is gone', () => page.locator('#login').isHidden(), 30000);
    await eventually('it says who is here', async () => (await page.locator('#who').textContent()) === `You are ${name}, and may ${role}.`, 10000);

    const blackout = page.locator('#blackout');
    const may = role !== 'look';
    assert.equal(await blackout.isEnabled(), may, `${role}: the blackout button`);
    assert.equal(await page.locator('#by-hand-name').isEnabled(), may, `${role}: by hand`);
    if (!may) assert.match(await blackout.innerText(), /otto may look; this is for those who may operate/);
    const refused = await ask(page, 'POST', '/api/level', { fixtures: ['spot-1'], level: 0.2 });
    assert.equal(refused.code, may ? 200 : 403, JSON.stringify(refused));
    if (!may) assert.match(refused.body.error, /otto may look, and this is for those who may operate/);
    const reload = await ask(page, 'POST', '/api/session', {});
    assert.equal(reload.code, role === 'configure' ? 200 : 403, JSON.stringify(reload));
    if (may) {
      await blackout.click();
      await eventually('one touch takes all light off', async () => (await ask(page, 'GET', '/api/status')).body.blackout === true, 10000);
      await blackout.click();
      await eventually('and brings it back', async () => (await ask(page, 'GET', '/api/status')).body.blackout === false, 10000);
      const changes = (await ask(page, 'GET', '/api/changes')).body;
      const held = changes.filter((one) => one.did === 'POST /api/level').at(-1);
      assert.equal(held.who, name);
      assert.equal(held.from, '127.0.0.1');
      if (role === 'operate') assert.deepEqual(held.changed, { 'held spot-1': [null, 0.2] });
      await eventually('the page lists it', async () => (await page.locator('#changes').textContent()).includes(name), 15000);
    }
    for (const [size, width] of [['phone', 390], ['tablet', 820], ['desktop', 1280]]) {
      await page.setViewportSize({ width, height: 900 });
      await fitsItsWidth(page);
      assert.deepEqual(await unreadableTexts(page), [], `contrast for who may ${role}`);
      if (out) await page.screenshot({ path: path.join(out, `role-${role}-${size}.png`), fullPage: true });
    }
    await page.evaluate(() => (document.getElementById('changes').open = true));
    if (role === 'operate') {
      accounts(['add', name, '--role', 'look'], 'another password');
      await page.waitForSelector('#login:not([hidden])', { timeout: 15000 });
      assert.equal((await ask(page, 'GET', '/api/status')).code, 401, 'a changed account is logged out');
    } else {
      await page.getByRole('button', { name: 'Log out' }).click();
      await page.waitForSelector('#login:not([hidden])');
      assert.equal((await ask(page, 'GET', '/api/status')).code, 401);
    }
    assert.deepEqual(misdeeds.filter((one) => !/status of 40[13]/.test(one)), []);
    await close();
  }

  const script = async (method, route) => (await fetch(new URL(route, url), { method, headers: { Authorization: `Bearer ${token}`, 'Content-Type': 'application/json' },
    ...(method === 'POST' ? { body: '{"on":true}' } : {}) })).status;
  assert.equal(await script('GET', '/api/status'), 200);
  assert.equal(await script('POST', '/api/blackout'), 403);
  accounts(['remove', 'ci']);
  await eventually('a removed token is worth nothing', async () => (await script('GET', '/api/status')) === 401, 15000);

  // Commands on this computer need no account.
  const port = new URL(url).port;
  const here = (...words) => execFileSync(luxrig, [...words, '--port', port], { env: { ...process.env, XDG_RUNTIME_DIR: folder }, encoding: 'utf8' });
  here('blackout');
  here('blackout', 'off');
  assert.match(here('log'), /this computer's user.*blackout/);
  const lines = readFileSync(path.join(folder, 'state', 'changes.jsonl'), 'utf8').trim().split('\n').map((text) => JSON.parse(text));
  assert.ok(lines.length >= 6 && lines.every((one) => one.at && one.who && one.did), JSON.stringify(lines));
  assert.ok(!JSON.stringify(lines).includes('password'), 'no password is in the log');
  console.log('accounts: passed');
} finally {
  await browser?.close();
  daemon.kill('SIGTERM');
  await ended;
  rmSync(folder, { recursive: true, force: true });
}
