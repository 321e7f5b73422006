// A page of another site must not change a rig through a browser that has access to the daemon.
//   node tests/web/foreign_page_test.mjs --luxrig PROGRAM
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { fileURLToPath } from 'node:url';
import { eventually, openPage, startBrowser } from './browser.mjs';

const source = (path) => fileURLToPath(new URL(`../../${path}`, import.meta.url));
const at = process.argv.indexOf('--luxrig');
const luxrig = at > 0 ? process.argv[at + 1] : source('build/release/bin/luxrig');

const daemon = spawn(luxrig, ['run', source('tests/rigs/room'), '--sim', '--port', '0', '--max-error', '0.05']);
let log = '';
for (const out of [daemon.stdout, daemon.stderr]) out.on('data', (part) => (log += part));

/** Sends everything that a page can send; runs in the page. */
async function attack(rig) {
  const body = '{"on":true}';
  const host = new URL(rig).host;
  const within = `POST /api/blackout HTTP/1.1\r\nHost: ${host}\r\nContent-Type: application/json\r\nContent-Length: ${body.length}\r\n\r\n${body}`;
  const level = '{"fixtures":["*"],"level":0}';
  const done = {};
  const tell = (name, promise) => promise.then((a) => (done[name] = a.type), (e) => (done[name] = String(e)));
  const asked = [];
  for (const type of ['text/plain', 'application/x-www-form-urlencoded', 'application/json'])
    for (const [route, text] of [['/api/blackout', body], ['/api/level', level], ['/api/blackout', within], ['/', within], ['/none', within]])
      for (const mode of ['no-cors', 'cors'])
        asked.push(tell(`${mode} ${type} ${route}`, fetch(rig + route, { method: 'POST', mode, credentials: 'include', headers: { 'Content-Type': type }, body: text })));
  // A server that refuses by the headers and then reads on takes the unread rest for the next request. That request
  // begins where the 4 KiB buffer ended, wherever that is.
  for (let head = 400; head < 1000; ++head)
    asked.push(tell(`behind ${head} bytes`, fetch(`${rig}/api/blackout`, { method: 'POST', mode: 'no-cors', credentials: 'include', body: 'x'.repeat(4096 - head) + within })));
  asked.push(tell('no type', fetch(`${rig}/api/blackout`, { method: 'POST', mode: 'no-cors', credentials: 'include', body: new Blob([body]) })));
  navigator.sendBeacon(`${rig}/api/blackout`, new Blob([within], { type: 'text/plain' }));
  for (const enctype of ['text/plain', 'application/x-www-form-urlencoded', 'multipart/form-data'])
    for (const name of [within, body]) {
      const frame = Object.assign(document.createElement('iframe'), { name: `f${Math.random()}` });
      const form = Object.assign(document.createElement('form'), { method: 'post', action: `${rig}/api/blackout`, enctype, target: frame.name });
      form.append(Object.assign(document.createElement('input'), { name, value: '\r\n' }));
      document.body.append(frame, form);
      form.submit();
    }
  const image = new Image();
  image.src = `${rig}/api/room.png`;
  const streams = [...Array(20)].map(() => new EventSource(`${rig}/api/events`, { withCredentials: true }));
  let events = 0;
  for (const stream of streams) {
    stream.onopen = () => ++events;
    stream.addEventListener('status', () => ++events);
  }
  await Promise.all(asked);
  await new Promise((resolve) => setTimeout(resolve, 1500));
  for (const stream of streams) stream.close();
  return { done, events, picture: image.naturalWidth };
}

let browser;
const foreign = createServer((_, response) => response.writeHead(200, { 'Content-Type': 'text/html' }).end('<body>hello'));
try {
  await eventually('the daemon lights the rig', () => /in [\d.]+ s; page/.test(log) || log, 60000);
  const address = /page and status: (\S+)/.exec(log)[1];
  const rig = new URL(address).origin;
  await new Promise((resolve) => foreign.listen(0, resolve));
  browser = await startBrowser();
  const { page, misdeeds, close } = await openPage(browser, address);
  await page.waitForSelector('body.ready', { timeout: 30000 });
  const status = async () => (await page.context().request.get(`${rig}/api/status`)).json();
  const untouched = async (who) => {
    const now = await status();
    assert.equal(now.blackout, false, `${who} has blacked out the rig`);
    assert.deepEqual(now.overrides, [], `${who} has set the rig by hand`);
    assert.ok(now.fixtures.some((f) => f.level > 0.05), `${who} has put out the light`);
  };
  await untouched('nobody');

  // Another site, and another port of the same host, to which the browser even sends the daemon's cookie.
  for (const host of ['localhost', '127.0.0.1']) {
    const site = `http://${host}:${foreign.address().port}/`;
    const other = await page.context().newPage();
    await other.goto(site);
    const { done, events, picture } = await other.evaluate(attack, rig);
    await untouched(site);
    assert.equal(events, 0, `${site} hears the rig's events`);
    assert.equal(picture, 0, `${site} sees the room`);
    for (const [what, answer] of Object.entries(done))
      assert.ok(answer === 'opaque' || /TypeError/.test(answer), `${site}: ${what}: ${answer}`);
    await other.close();
    console.log(`ok  ${site}: ${Object.keys(done).length + 7} requests and 20 streams, and nothing happened`);
  }

  // The page itself still works, and may do all that.
  assert.equal(await page.locator('#line').getAttribute('data-state'), 'live');
  await page.locator('#blackout').click();
  await eventually('the page itself may', async () => (await status()).blackout === true);
  assert.deepEqual(misdeeds, []);
  console.log('ok  the page itself blacks out the rig');

  // A browser without access gets the page without the rig, and instructions.
  const stranger = await browser.newContext();
  const shut = await stranger.newPage();
  await shut.goto(`${rig}/`);
  await eventually('it says what to do', async () => /luxrig page/.test(await shut.locator('#lost').innerText()), 8000);
  assert.equal((await stranger.request.get(`${rig}/api/status`)).status(), 401);
  console.log('ok  a browser that nobody opened is told how');
  await close();
} finally {
  await browser?.close();
  foreign.close();
  foreign.closeAllConnections?.();
  daemon.kill('SIGTERM');
}
