// Serves the daemon's HTTP API (tools/luxrigd/API.md) without a rig, for the page's test and for work on the page:
//   node tests/web/mock_server.mjs [--port 9620] [--dist build/release/share/luxrig/web] [--script]
// --script plays a whole show with faults in a loop; without it the rig holds.
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { FIXTURES, METERED, POINTS, room, roomPng } from './mock_rig.mjs';
import { etagOf, sceneGlb } from './mock_scene.mjs';
import { Changes, rigOf } from './mock_changes.mjs';
import { MockPlans } from './mock_plans.mjs';

const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const wobble = (seed, t) => Math.sin(seed * 12.9898 + t * 1.7) * 0.6 + Math.sin(seed * 78.233 + t * 0.31) * 0.4;
const round = (value, digits) => Number(value.toFixed(digits));

/** The scripted show: events by second. */
const SCRIPT = [
  { from: 0, phase: 'fading', share: (t) => t / 4, miss: 0.12 },
  { from: 4, phase: 'settling', miss: 0.12 },
  { from: 5, phase: 'measuring', miss: 0.12 },
  { from: 7, phase: 'correcting', round: 1, miss: 0.04 },
  { from: 9, phase: 'holding', round: 2, miss: 0 },
  { from: 22, phase: 'frozen', round: 2, miss: 0, fault: 'dmx' },
  { from: 26, phase: 'safe_fading', round: 2, miss: 0, fault: 'dmx' },
  { from: 28, phase: 'safe', round: 2, miss: 0, fault: 'dmx', safe: true },
  { from: 34, phase: 'holding', round: 2, miss: 0 },
];
const SCRIPT_S = 44;

export class MockDaemon {
  name = 'gallery';
  blackout = false;
  overrides = [];
  question = undefined; // of a client that measures by hand; a person's answer is put into it
  alarms = [];
  faulted = new Set(); // names of devices
  dark = {}; // by name of a fixture: further fields of its entry, such as parked and waits_for
  posts = []; // bodies of accepted posts
  who = { name: 'this computer\'s user', role: 'configure' }; // while it is known
  accounts = {}; // by name: { password, role }; none: nobody can log in
  changes = []; // GET /api/changes
  silent = false; // questions for the status stay open without an answer
  unknown = false; // the browser has no access, and gets no status
  plans = new MockPlans(this);
  statusBytes = 0; // of all answers to what has changed
  refuse = false; // posts are answered with 503
  scripted = false;
  scene = sceneGlb(); // GET /api/scene; undefined: the rig has none
  sceneAnswers = []; // codes of the answers to it
  #waiting = new Set(); // answers while silent
  #changes = new Changes();
  #picture = roomPng();
  #started = Date.now();

  constructor(dist) {
    this.dist = dist;
  }

  async listen(port = 0) {
    this.server = createServer((request, response) => {
      this.#answer(request, response).catch((error) => {
        response.writeHead(500).end(String(error));
      });
    });
    await new Promise((resolve, reject) => {
      this.server.once('error', reject);
      this.server.listen(port, '127.0.0.1', resolve);
    });
    return this.server.address().port;
  }

  async close() {
    for (const response of this.#waiting) response.destroy();
    this.#waiting.clear();
    this.server.closeAllConnections?.();
    await new Promise((resolve) => this.server.close(resolve));
  }

  #scene(t) {
    if (!this.scripted) return { phase: 'holding', round: 2, miss: 0 };
    const at = t % SCRIPT_S;
    const scene = SCRIPT.filter((s) => s.from <= at).at(-1);
    return { ...scene, shown: scene.share ? scene.share(at - scene.from) : scene.safe ? 0.25 : 1 };
  }

  status() {
    const t = (Date.now() - this.#started) / 1000;
    const scene = this.#scene(t);
    const faulted = new Set([...this.faulted, ...(scene.fault ? [scene.fault] : [])]);
    const alarms = [...this.alarms];
    for (const device of faulted)
      alarms.push({ severe: true, device, text: `no answer for 1.2 s, bound 0.5 s: check its cable and power; the light is held, then fades to the safe look`, since_s: round(t % 60, 1) });
    const shown = this.blackout ? 0 : (scene.shown ?? 1);
    const points = POINTS.map((p, i) => {
      const predicted = p.goal * shown * (1 + 0.006 * wobble(i, 0) + (i % 11 === 7 ? -0.084 : 0) + (i === 24 ? 0.051 : 0));
      const point = { name: p.name, position: p.position, normal: p.normal, goal_lux: round(p.goal, 1),
        predicted_lux: round(predicted, 2), standard_error_lux: round(0.004 * predicted + 0.05, 3) };
      if (p.limit) point.max_lux = p.limit;
      const metered = METERED.includes(p.name);
      if (metered && !faulted.has('meters')) {
        point.measured_lux = round(p.goal * shown * (1 + 0.006 * wobble(i, t)) * (1 - scene.miss), 2);
        point.measured_age_s = round((t * 3.1 + i * 0.17) % 0.5, 2);
      }
      point.error = round((point.measured_lux ?? point.predicted_lux) / p.goal - 1, 4);
      // As in the daemon: a goal to 5 %; some points are known too little to confirm it.
      const known = point.measured_lux === undefined && i % 5 === 3 ? 0.06 : 0.02;
      const off = Math.abs(point.error);
      point.verdict = off + known <= 0.05 ? 'met' : off - known > 0.05 ? 'missed' : 'unknown';
      point.met = point.verdict === 'met';
      point.reason = point.met ? '' : point.verdict === 'unknown' ? 'by the model; a luxmeter here would settle it'
        : `${(100 * off).toFixed(1)} % too ${point.error < 0 ? 'dark' : 'bright'}${i % 11 === 7 ? ': spot-3 is at 100 %' : ''}`;
      if (p.limit) {
        point.limit = (point.measured_lux ?? point.predicted_lux) > 1.04 * p.limit ? 'exceeded' : 'kept';
        point.limit_reason = point.limit === 'kept' ? '' : `it reads ${point.measured_lux} lx`;
      }
      return point;
    });
    const good = points.filter((p) => p.measured_lux !== undefined && Math.abs(p.error) < 0.02).length;
    const meters = METERED.map((name, i) => {
      const point = points.find((p) => p.name === name);
      return { name: `meter-${i + 1}`, point: name, bus: 'meters', address: `unit ${21 + i} register 2`, position: point.position, tolerance: 0.04,
        life: faulted.has('meters') ? 'faulted' : 'active',
        ...(point.measured_lux === undefined ? {} : { lux: point.measured_lux, age_s: point.measured_age_s }) };
    });
    const device = (name, rate, both) => ({
      name, driver: name === 'dmx' ? 'sacn' : 'modbus_tcp', address: name === 'dmx' ? 'multicast' : '192.0.2.10:502',
      life: faulted.has(name) ? 'faulted' : 'active', since_s: round(t, 1),
      detail: faulted.has(name) ? 'no answer for 1.2 s, bound 0.5 s, 12 of the last 50 failed' : '',
      last_ok_s: faulted.has(name) ? 1.2 : round((t * 7) % 0.05, 3),
      sent: Math.floor(t * rate), received: both ? Math.floor(t * rate) : 0, errors: faulted.has(name) ? 12 : 0,
    });
    return {
      rig: this.name, version: '0.1.0', phase: scene.phase, detail: `${good} of ${METERED.length} meters within 2 %`,
      time_s: round(t, 2), simulated: true, blackout: this.blackout, round: scene.round ?? 0, rounds: 3,
      converged: scene.phase === 'holding' && good === METERED.length,
      fixtures: FIXTURES.map((f) => ({ name: f.name, luminaire: 'spot', max_level: 1, bus: f.bus, address: f.address, position: f.position, aim: f.aim, pan_deg: 12.5, tilt_deg: 41,
        level: round(f.level * shown, 4), drive: round(Math.sqrt(f.level * shown), 4),
        target_level: this.blackout ? 0 : f.level, gain: f.gain, gain_standard_error: 0.012,
        ...(this.dark[f.name] ? { moves: true, level: 0, drive: 0, target_level: 0, ...this.dark[f.name] } : {}) })),
      points, luxmeters: meters,
      devices: [device('dmx', 44, false), device('dimmer', 44, true), device('meters', 4, true)],
      alarms,
      overrides: this.overrides,
      ...(this.question ? { question: { ...this.question, remaining_s: 45 } } : {}),
      output: { rate_hz: 44, frames: Math.floor(t * 44), p50_us: 38, p99_us: 91, max_us: 212, realtime: true },
    };
  }

  #since(version) {
    const answer = this.#changes.since(version, this.status());
    this.statusBytes += JSON.stringify(answer).length;
    return answer;
  }

  /** A client puts a question, keeps it there, and takes it back. */
  #ask(asked, json) {
    if (asked.withdrawn) {
      if (this.question?.id === asked.id) this.question = undefined;
      return json(200, { withdrawn: true });
    }
    const { for_s: _, ...question } = asked;
    const answer = this.question?.id === asked.id ? this.question.answer : undefined;
    this.question = { ...question, ...(answer ? { answer } : {}) };
    return json(200, { asked: true, ...(answer ? { answer } : {}) });
  }

  #logInOrOut(route, { name, password }, json) {
    if (route === '/api/login' && this.accounts[name]?.password !== password) return json(401, { error: 'wrong name or password' });
    this.unknown = route === '/api/logout';
    if (!this.unknown) this.who = { name, role: this.accounts[name].role };
    return json(200, this.unknown ? { logged_out: true } : this.who);
  }

  #answerQuestion({ id, ...answer }, json) {
    if (this.question?.id !== id) return json(409, { error: 'this is not asked any more' });
    const before = this.question.answer;
    if (before && (before.what !== answer.what || before.lux !== answer.lux)) return json(409, { error: 'this has been answered already' });
    this.question = { ...this.question, answer };
    return json(200, { taken: true });
  }

  #byHand(route, asked, json) {
    if (route === '/api/release') {
      this.overrides = asked.all ? [] : this.overrides.filter((o) => !asked.names.includes(o.name));
      return json(200, { released: true, text: '1 released' });
    }
    const kind = route === '/api/level' ? 'level' : 'goal';
    if (asked.levels) return json(200, { held: true, text: '' });
    const name = (asked.fixtures ?? asked.points)[0];
    const known = kind === 'level' ? FIXTURES : POINTS;
    if (!known.some((k) => k.name === name)) return json(400, { error: `the rig has no ${name}` });
    this.overrides.push({ kind, name, age_s: 3, ...(kind === 'level' ? { level: asked.level } : { goal_lux: asked.goal_lux }),
      ...(asked.for_s ? { remaining_s: asked.for_s - 3 } : {}) });
    return json(200, { held: true, text: `${name} by hand` });
  }

  #sceneAnswer(request, response, json) {
    const etag = this.scene && etagOf(this.scene);
    const code = !this.scene ? 404 : request.headers['if-none-match'] === etag ? 304 : 200;
    this.sceneAnswers.push(code);
    if (code === 404) return json(404, { error: 'this rig has no scene' });
    response.writeHead(code, { 'Content-Type': 'model/gltf-binary', ETag: etag, 'Cache-Control': 'private, no-cache' });
    return response.end(code === 200 ? this.scene : undefined);
  }

  async #answer(request, response) {
    const url = new URL(request.url, 'http://mock');
    const json = (code, value) => response.writeHead(code, { 'Content-Type': 'application/json' }).end(JSON.stringify(value));
    if (url.pathname.startsWith('/api/') && this.plans.answers(request.method, url.pathname)) return this.plans.answer(request, url, json);
    if (request.method === 'POST') {
      let body = '';
      for await (const part of request) body += part;
      if (!['/api/blackout', '/api/level', '/api/goal', '/api/release', '/api/question', '/api/answer', '/api/aim', '/api/identify', '/api/park', '/api/login', '/api/logout'].includes(url.pathname)) return json(404, {});
      if (request.headers['content-type'] !== 'application/json') return json(415, {});
      if (url.pathname.startsWith('/api/log')) return this.#logInOrOut(url.pathname, JSON.parse(body), json);
      if (this.refuse) return json(503, {});
      this.posts.push({ path: url.pathname, body: JSON.parse(body) });
      const { body: asked } = this.posts.at(-1);
      if (url.pathname === '/api/question') return this.#ask(asked, json);
      if (url.pathname === '/api/answer') return this.#answerQuestion(asked, json);
      if (['/api/aim', '/api/identify', '/api/park'].includes(url.pathname)) return json(200, {});
      if (url.pathname !== '/api/blackout') return this.#byHand(url.pathname, asked, json);
      this.blackout = asked.on === true;
      return json(200, { on: this.blackout });
    }
    switch (url.pathname) {
      case '/api/session':
        return json(200, { open: !this.unknown, login: Object.keys(this.accounts).length > 0, ...(this.unknown ? {} : this.who) });
      case '/api/changes':
        return json(200, this.changes);
      case '/api/status':
        if (this.unknown) return json(401, { error: 'who asks?' });
        if (!url.searchParams.has('since')) return json(200, this.status());
        if (this.silent) {
          this.#waiting.add(response);
          return request.on('close', () => this.#waiting.delete(response));
        }
        return json(200, this.#since(url.searchParams.get('since')));
      case '/api/rig':
        return json(200, rigOf(this.status()));
      case '/api/room':
        return json(200, room(this.name));
      case '/api/room.png':
        return response.writeHead(200, { 'Content-Type': 'image/png' }).end(this.#picture);
      case '/api/scene':
        return this.#sceneAnswer(request, response, json);
    }
    const file = path.join(this.dist, path.normalize(url.pathname === '/' ? '/index.html' : url.pathname));
    try {
      const content = await readFile(file);
      response.writeHead(200, { 'Content-Type': TYPES[path.extname(file)] ?? 'application/octet-stream' }).end(content);
    } catch {
      response.writeHead(404).end('not found');
    }
    return undefined;
  }
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  const option = (name, otherwise) => {
    const at = process.argv.indexOf(name);
    return at > 0 ? process.argv[at + 1] : otherwise;
  };
  const dist = option('--dist', fileURLToPath(new URL('../../tools/web/dist', import.meta.url)));
  const daemon = new MockDaemon(dist);
  daemon.scripted = process.argv.includes('--script');
  const port = await daemon.listen(Number(option('--port', '9620')));
  console.log(`http://127.0.0.1:${port}/`);
}
