// How much a browser fetches, compressed by gzip: what is there before a person presses anything, and all code.
//   node tests/web/size_test.mjs --dist DIR
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { gzipSync } from 'node:zlib';

const FIRST_BYTES = 60_000;
const ALL_BYTES = 300_000;

const dist = process.argv[process.argv.indexOf('--dist') + 1];
const size = (file) => gzipSync(readFileSync(path.join(dist, file)), { level: 9 }).length;
const files = ['', 'assets/'].flatMap((folder) => readdirSync(path.join(dist, folder)).map((file) => folder + file)).filter((file) => /[.](html|js|css|svg)$/.test(file));
const sizes = Object.fromEntries(files.map((file) => [file, size(file)]));
for (const [file, bytes] of Object.entries(sizes).sort((a, b) => b[1] - a[1])) console.log(`${(bytes / 1000).toFixed(1).padStart(8)} kB  ${file}`);

const named = readFileSync(path.join(dist, 'index.html'), 'utf8');
const first = Object.entries(sizes).filter(([file]) => file === 'index.html' || named.includes(file)).reduce((sum, [, bytes]) => sum + bytes, 0);
const all = Object.values(sizes).reduce((sum, bytes) => sum + bytes, 0);
console.log(`first load ${(first / 1000).toFixed(1)} kB of ${FIRST_BYTES / 1000}, all ${(all / 1000).toFixed(1)} kB of ${ALL_BYTES / 1000}`);
assert.ok(files.some((file) => /room_3d/.test(file)), 'the 3-D room is a file of its own');
assert.ok(!/room_3d|scene_worker/.test(named), 'and is not fetched at first');
assert.ok(first <= FIRST_BYTES, 'the first load is too large');
assert.ok(all <= ALL_BYTES, 'all code is too large');
