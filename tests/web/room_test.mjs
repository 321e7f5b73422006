// Drives the page's room in 3-D in headless Chromium, against the mock: every check, and screenshots.
//   node tests/web/room_test.mjs --dist DIR --out DIR
// Exit code 0 only if all checks held.
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import { startBrowser } from './browser.mjs';
import { MockDaemon } from './mock_server.mjs';
import { handChecks } from './hand_checks.mjs';
import { roomChecks } from './room_checks.mjs';

const option = (name) => process.argv[process.argv.indexOf(name) + 1];
const [dist, out] = [option('--dist'), option('--out')];

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

const browser = await startBrowser();
const daemon = new MockDaemon(dist);
try {
  mkdirSync(out, { recursive: true });
  const url = `http://127.0.0.1:${await daemon.listen()}/`;
  const shot = (page, name) => page.screenshot({ path: shot.path(name) });
  shot.path = (name) => path.join(out, `${name}.png`);
  await handChecks(browser, daemon, url, check, shot);
  await roomChecks(browser, daemon, url, check, shot);
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
}
// After a failure the mock daemon still listens, and would keep this process alive.
process.exit(process.exitCode ?? 0);
