// Debian's Chromium, headless, driven by playwright-core out of the page's own packages.
import { createRequire } from 'node:module';
import { existsSync } from 'node:fs';

const { chromium } = createRequire(new URL('../../tools/web/package.json', import.meta.url))('playwright-core');

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';

export async function startBrowser() {
  if (!existsSync(CHROMIUM)) throw new Error(`no browser at ${CHROMIUM}: run tools/setup, or set CHROMIUM`);
  return chromium.launch({
    executablePath: CHROMIUM,
    headless: true,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--disable-dev-shm-usage', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
}

/** Opens the page and records its faults: errors, and requests to any server but its own. */
export async function openPage(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark', ...options });
  const page = await context.newPage();
  const origin = new URL(url).origin;
  const misdeeds = [];
  page.on('pageerror', (error) => misdeeds.push(`error in the page: ${error.message}`));
  page.on('dialog', (dialog) => {
    misdeeds.push(`the page opened a dialog: ${dialog.message()}`);
    void dialog.dismiss();
  });
  page.on('console', (message) => {
    // A lost server and a refusal are part of the test; a broken content policy or script is not.
    if (message.type() === 'error' && !/net::ERR|status of (503|400|401|404|409|412)/.test(message.text()))
      misdeeds.push(`console: ${message.text()}`);
  });
  page.on('request', (request) => {
    if (new URL(request.url()).origin !== origin) misdeeds.push(`request to elsewhere: ${request.url()}`);
  });
  await page.goto(url, { waitUntil: 'domcontentloaded' });
  return { page, misdeeds, close: () => context.close() };
}

/** Waits until `probe` (an async function) answers true; if it never does, reports its last answer. */
export async function eventually(what, probe, within_ms = 4000) {
  const end = Date.now() + within_ms;
  let last;
  for (;;) {
    last = await probe();
    if (last === true) return;
    if (Date.now() > end) throw new Error(`${what}: not within ${within_ms} ms; last: ${JSON.stringify(last)}`);
    await new Promise((resolve) => setTimeout(resolve, 25));
  }
}
