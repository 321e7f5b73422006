// The daemon and tools/luxrigd/openapi.json agree: the file is valid, and whatever is sent, the daemon answers with a
// code and a body that the file names, never with 500, and takes nothing that the file's schemas refuse.
//   node tests/web/api_property_test.mjs --luxrig PROGRAM [--requests 2000] [--seed 1]
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { ANSWERED, fc, MISDEEDS, put, requests, Values } from './api_requests.mjs';
import { eventually } from './browser.mjs';

const require = createRequire(new URL('../../tools/web/package.json', import.meta.url));
const Ajv = require('ajv/dist/2020').default;
const SwaggerParser = require('@apidevtools/swagger-parser');

const source = (file) => fileURLToPath(new URL(`../../${file}`, import.meta.url));
const option = (name, otherwise) => {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : otherwise;
};
const luxrig = option('--luxrig', source('build/release/bin/luxrig'));
const runs = Number(option('--requests', '2000'));
const seed = Number(option('--seed', '1'));
const kWorkers = 6;
const kReloads = Math.max(2, Math.min(20, runs / 1000)); // each solves the rig again

const file = JSON.parse(readFileSync(source('tools/luxrigd/openapi.json'), 'utf8'));
await SwaggerParser.validate(structuredClone(file));

const ajv = new Ajv({ strict: false, allErrors: true, validateFormats: false });
ajv.addSchema(file, 'openapi.json');
const kept = new Map();
/** The validator of a schema at this place of the file. */
function schemaAt(...place) {
  const pointer = place.map((part) => encodeURIComponent(part.replaceAll('~', '~0').replaceAll('/', '~1'))).join('/');
  if (!kept.has(pointer)) kept.set(pointer, ajv.compile({ $ref: `openapi.json#/${pointer}` }));
  return kept.get(pointer);
}
const json = 'application/json';
const operations = Object.entries(file.paths).flatMap(([route, methods]) => Object.entries(methods).map(([method, operation]) =>
  ({ schema: operation.requestBody?.content[json].schema, operation: { method, path: route, parameters: operation.parameters } })));

const folder = mkdtempSync(path.join(tmpdir(), 'luxrig-api-'));
// The smallest rig with one of everything, with a place where its head rests.
const rig = path.join(folder, 'room');
cpSync(source('tests/rigs/room'), rig, { recursive: true });
const text = readFileSync(path.join(rig, 'rig.toml'), 'utf8');
const rests = text.replace(/^(pan_range_deg = .*)$/m, '$1\npark_pan_deg = 0\npark_tilt_deg = 0');
assert.notEqual(rests, text);
writeFileSync(path.join(rig, 'rig.toml'), `${rests.replace('[daemon]', '[daemon]\naccounts = "accounts.json"')}\n[[surface_goal]]\nname = "floor"\nstrokes = "floor.json"\n`);
execFileSync(luxrig, ['accounts', rig, 'add', 'a-1', '--role', 'look'], { input: 'correct horse\n' });
execFileSync(luxrig, ['paint', rig]);
const plan = path.join(folder, 'plan.json');
execFileSync(luxrig, ['solve', rig, '-o', plan, '--max-error', '0.05']);
const daemon = spawn(luxrig, ['run', rig, '--sim', '--port', '0', '--max-error', '0.05'], { env: { ...process.env, XDG_RUNTIME_DIR: folder } });
let log = '';
for (const out of [daemon.stdout, daemon.stderr]) out.on('data', (part) => (log += part));
const ended = new Promise((resolve) => daemon.once('exit', resolve));

const agent = new http.Agent({ keepAlive: true, maxSockets: 2 * kWorkers });
/** {code, type, body}; of a stream of events the first. */
function ask(port, options, body) {
  return new Promise((resolve, reject) => {
    const request = http.request({ host: '127.0.0.1', port, agent, ...options }, (response) => {
      const parts = [];
      const type = (response.headers['content-type'] ?? '').split(';')[0];
      const done = () => resolve({ code: response.statusCode, type, etag: response.headers.etag, body: Buffer.concat(parts).toString() });
      response.on('data', (part) => {
        parts.push(part);
        if (type !== 'text/event-stream' || !Buffer.concat(parts).includes('\n\n')) return;
        done();
        response.destroy();
      });
      response.on('end', done);
      response.on('error', (error) => reject(error)); // after done() this says nothing
    });
    request.on('error', (error) => {
      // The daemon closes connections that idle; a request that met its end is sent again, as any client would.
      if (request.reusedSocket && ['ECONNRESET', 'EPIPE'].includes(error.code)) ask(port, options, body).then(resolve, reject);
      else reject(error);
    });
    request.end(body);
  });
}

try {
  const line = /page and status: (\S+)/;
  await eventually('the daemon has a page', () => line.test(log) || log, 60000);
  const port = Number(new URL(line.exec(log)[1]).port);
  const token = readFileSync(path.join(folder, 'luxrig', `${port}.token`), 'utf8').trim();
  const access = { Authorization: `Bearer ${token}` };
  const status = async () => JSON.parse((await ask(port, { path: '/api/status', headers: access })).body);
  await eventually('the light is there', async () => ((await status()).fixtures ?? []).some((f) => f.level > 0.05), 60000);
  await eventually('the room is drawn', async () => (await ask(port, { path: '/api/room', headers: access })).code === 200, 60000);

  const first = await status();
  const named = (list) => list.map((one) => one.name);
  const [fixtures, points, meters] = [named(first.fixtures), named(first.points), named(first.luxmeters)];
  const values = new Values(file,
    { fixture: fixtures, fixtures: [...fixtures, '*', `${fixtures[0].slice(0, 2)}*`], points: [...points, '*'],
      anything: [...fixtures, ...points, '*'], devices: [...fixtures, ...meters], 'surface goal': ['floor'] },
    { Plan: [JSON.parse(readFileSync(plan, 'utf8'))] });

  const seen = new Map(); // "POST /api/level 200" -> how often
  const known = { name: 'floor' }; // values of parameters, from the last answer
  let reloads = 0;
  const one = async ({ operation, sent, parameters, misdeed }) => {
    let { method } = operation;
    const given = put(operation, parameters, known);
    let route = given.path;
    if (route === '/api/reload' && !misdeed && ++reloads > kReloads) return;
    const { value } = sent;
    let { body } = sent;
    const headers = { ...access, ...given.headers };
    if (body === undefined && misdeed !== undefined && method === 'post') body = '{}';
    if (body !== undefined) headers['Content-Type'] = json;
    let owed = MISDEEDS[misdeed];
    switch (misdeed) {
      case 'stranger': delete headers.Authorization; break;
      case 'wrong token': headers.Authorization = `Bearer ${token.slice(1)}0`; break;
      case 'other host': headers.Host = 'rig.example'; break;
      case 'other origin': headers.Origin = `http://127.0.0.1:${port + 1}`; break;
      case 'other site': headers['Sec-Fetch-Site'] = 'cross-site'; break;
      case 'other method': method = 'patch'; break;
      case 'other path': route = `/api/none${route.slice(4)}`; break;
      case 'other type':
        if (!body) body = '{}'; // a body of no bytes has no type
        headers['Content-Type'] = 'text/plain';
        break;
      case 'too long': body = ' '.repeat((file.paths[operation.path][method].requestBody?.['x-max-bytes'] ?? 16384) + 1); break;
      case 'long headers': headers['X-Long'] = 'x'.repeat(9000); break;
    }
    if (misdeed === 'too long') headers['Content-Type'] = json;
    const open = file.paths[operation.path][operation.method].security.length === 0;
    if (owed === 401 && open) owed = undefined;
    if (body !== undefined) headers['Content-Length'] = Buffer.byteLength(body);
    const what = `${operation.method.toUpperCase()} ${operation.path}`;
    const answer = await ask(port, { method: method.toUpperCase(), path: route, headers }, body);
    const told = `${what} (${misdeed ?? 'as it should be'}) ${String(body).slice(0, 600)}\n-> ${answer.code} ${answer.body.slice(0, 600)}`;
    seen.set(`${what} ${answer.code}`, (seen.get(`${what} ${answer.code}`) ?? 0) + 1);

    // A computer that stands still for a second is told of with 500, as it should be; nothing else is.
    if (answer.code === 500) assert.match(answer.body, /has not taken it yet|the control loop did not answer/, told);
    // Two large bodies at once are taken, and more are asked to try again before their length is looked at.
    if (misdeed === 'too long' && answer.code === 503) owed = 503;
    if (owed !== undefined) assert.equal(answer.code, owed, told);
    // A path that does not exist is in no file; its refusal looks like all others.
    let place = ['paths', operation.path, operation.method, 'responses', String(answer.code)];
    if (misdeed === 'other path') {
      place = ['components', 'schemas', 'Refusal'];
    } else {
      let response = file.paths[operation.path][operation.method].responses[answer.code];
      if (response?.$ref) {
        place = response.$ref.split('/').slice(1);
        response = file.components.responses[place.at(-1)];
      }
      assert.ok(response, `the file does not name this code: ${told}`);
      if (answer.code === 304) assert.equal(answer.body, '', told);
      else assert.ok(response.content[answer.type], `the file does not name this type, ${answer.type}: ${told}`);
      place.push('content', answer.type, 'schema');
    }
    if (answer.etag) known['If-None-Match'] = answer.etag;
    if (answer.etag && operation.path === '/api/surface-goals/{name}') known['If-Match'] = answer.etag;
    if (answer.type === json) {
      const validate = schemaAt(...place);
      assert.ok(validate(JSON.parse(answer.body)), `the file does not name this body: ${told}\n${JSON.stringify(validate.errors)}`);
      if (operation.path === '/api/status') known.since = JSON.parse(answer.body).version;
      if (operation.path === '/api/jobs' && answer.code === 200 && operation.method === 'post') known.id = JSON.parse(answer.body).id;
    } else if (answer.type === 'text/event-stream') {
      const validate = schemaAt('components', 'schemas', 'Status');
      const event = /^event: status\ndata: (.*)\n\n/.exec(answer.body);
      assert.ok(event && validate(JSON.parse(event[1])), `no status: ${told}\n${JSON.stringify(validate.errors)}`);
    }
    if (misdeed === undefined && sent.body !== undefined) {
      const allowed = value !== undefined && schemaAt('paths', operation.path, operation.method, 'requestBody', 'content', json, 'schema')(JSON.parse(body));
      if (!allowed) assert.ok(answer.code === 400 || answer.code === 503 || (answer.code === 413 && body.length > 1024), `taken although the file's schema refuses it: ${told}`);
    }
  };

  // The test would say nothing if all were refused. So each operation is done first, with each key that it takes, and
  // refused once.
  const question = { id: 'a-1', text: 'hold it here', position: [1, 2, 0.8], normal: [0, 0, 1], step: 1, steps: 2, readings: 0, for_s: 600 };
  const onFloor = (x, y) => ({ position: [x, y, 0], normal: [0, 0, 1] });
  await eventually('the surfaces are cut into patches', async () => (await ask(port, { path: '/api/surface-patches/floor', headers: access })).code === 200, 60000);
  const good = {
    'POST /api/blackout': [{ on: true }, { on: false }],
    'POST /api/identify': [{ fixture: fixtures[0], seconds: 0.1 }, { fixture: fixtures[0] }],
    'POST /api/aim': [{ fixture: 'head-1', pan_deg: 10, tilt_deg: 40, level: 0.5, for_s: 0.1 }],
    'POST /api/preview': [{ fixtures: [{ fixture: 'spot*', level: 0.5 }, { fixture: 'head-1', aim: [1, 2, 0] }], reflections: true, client: 'a-1' }, { fixtures: [{ fixture: 'head-1', pan_deg: 10, tilt_deg: 40, level: 1 }] }],
    'POST /api/park': [{ fixtures: ['head-1'] }, {}],
    'POST /api/apply': [JSON.parse(readFileSync(plan, 'utf8'))],
    'POST /api/level': [{ fixtures: ['spot*'], level: 0.5, for_s: 1, fade_s: 0.1 }, { levels: { 'spot-1': 0.5, 'head-1': 1 }, for_s: 1, fade_s: 0.1, measuring: false }],
    'POST /api/goal': [{ points: [points[0]], goal_lux: 50, for_s: 1, fade_s: 0.1 }],
    'POST /api/release': [{ names: [points[0]], all: false, fade_s: 1 }, { all: true, fade_s: 600 }],
    'POST /api/bypass': [{ names: [meters[0]], on: true }, { names: [meters[0]], on: false }],
    'POST /api/question': [{ ...question, fixture: fixtures[0], level: 0.5, known_to: 0.1, known_to_worst: 0.2, withdrawn: false }, { id: 'a-1', withdrawn: true }, question],
    'POST /api/answer': [{ id: 'a-1', what: 'reading', lux: 182.5 }],
    'POST /api/jobs': [{ kind: 'solve' }],
    'POST /api/login': [{ name: 'a-1', password: 'correct horse' }],
    'POST /api/surface-goals': [{ name: 'wall', max_lux: 200 }],
    'PUT /api/surface-goals/{name}': [{ luxrig_painting: 1, strokes: [
      { kind: 'brush', lux: 300, radius_m: 0.3, falloff: 0.5, path: [onFloor(1, 1), onFloor(1.2, 1)] },
      { kind: 'bucket', lux: 120, path: [onFloor(1, 1)] }, { kind: 'selective', lux: 50, path: [onFloor(1, 1)] }, { kind: 'eraser', path: [onFloor(1, 1)] }] }],
    'POST /api/save-painting': [{ goals: ['floor'] }, {}],
  };
  for (const { operation, schema } of operations) {
    const what = `${operation.method.toUpperCase()} ${operation.path}`;
    const bodies = schema ? good[what].map((value) => ({ value, body: JSON.stringify(value) })) : [{}];
    for (const sent of bodies) {
      const parameters = Object.fromEntries((operation.parameters ?? []).map(({ name }) => [name, ANSWERED]));
      const before = seen.get(`${what} 200`) ?? 0;
      await one({ operation, sent, parameters });
      assert.equal(seen.get(`${what} 200`), before + 1, `${what} ${sent.body} was not done: ${JSON.stringify([...seen])}`);
      const again = file.paths[operation.path][operation.method].responses[304];
      if (again) await one({ operation, sent, parameters });
      if (again) assert.equal(seen.get(`${what} 304`), 1, `${what} is another one each time`);
    }
    if (!schema) continue;
    await one({ operation, sent: { value: [], body: '[]' }, parameters: {} });
    assert.equal(seen.get(`${what} 400`), 1, `${what} takes []`);
    for (const form of schema.anyOf ?? [schema])
      for (const [key, of] of Object.entries(form.properties ?? {}))
        if (of !== false) assert.ok(good[what].some((value) => key in value), `${what}: add ${key} to a body above`);
  }

  const memory = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${daemon.pid}/status`, 'utf8'))[1]);
  const before = memory();
  const begun = Date.now();
  const each = Math.ceil(runs / kWorkers);
  await Promise.all([...Array(kWorkers).keys()].map((worker) =>
    fc.assert(fc.asyncProperty(requests(operations, values), one), { numRuns: each, seed: seed * 1000 + worker, verbose: 0 })));
  const seconds = (Date.now() - begun) / 1000;

  assert.equal(daemon.exitCode, null, `the daemon has ended: ${log.slice(-2000)}`);
  const last = await status();
  assert.ok(schemaAt('components', 'schemas', 'Status')(last), JSON.stringify(last).slice(0, 500));
  const codes = {};
  for (const [what, count] of seen) codes[what.split(' ').at(-1)] = (codes[what.split(' ').at(-1)] ?? 0) + count;
  console.log(`${kWorkers * each} requests in ${seconds.toFixed(0)} s, answers by code ${JSON.stringify(codes)}, memory of the daemon ${(before / 1024).toFixed(0)} -> ${(memory() / 1024).toFixed(0)} MiB, output p99 ${last.output.p99_us} us, max ${last.output.max_us} us`);
} finally {
  agent.destroy();
  daemon.kill('SIGTERM');
  await ended;
  rmSync(folder, { recursive: true, force: true });
}
