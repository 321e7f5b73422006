// Jobs and plans of the mock daemon: a solve that runs until the test lets it end.

export class MockPlans {
  job = undefined; // {id, kind, state, stage?, doing?, can_be_taken?, why?, plan?}
  inForce = { luxrig_plan: 1, rig: 'gallery', tasks: [], points: [] };
  applied = []; // {fade_s, plan}
  previews = []; // bodies
  preview = undefined; // answers a body; undefined: 503
  #count = 0;

  constructor(daemon) {
    this.daemon = daemon;
  }

  answers(method, path) {
    return path.startsWith('/api/jobs') || path === '/api/plan' || path === '/api/apply' || path === '/api/preview';
  }

  /** The plan that a solve finds: all goals as they are, but one that no lamp reaches. */
  plan() {
    const status = this.daemon.status();
    return {
      luxrig_plan: 1, rig: status.rig, tasks: [{ name: 'levels', kind: 'emittance', lights: status.fixtures.map((f, i) => ({ name: f.name, luminaire: 'spot', level: i === 2 ? 1 : 0.5, watts: 6 })) }],
      points: status.points.map((p, i) => ({ name: p.name, position: p.position, normal: p.normal, goal_lux: p.goal_lux, lux: p.goal_lux * (i === 7 ? 0.8 : 1),
        direct_lux: 1, standard_error_lux: 0.5, verdict: i === 7 ? 'missed' : 'met', reason: i === 7 ? '20 % too dark: spot-3 is at 100 %; another lamp on it would mend it' : '' })),
      limits: [],
    };
  }

  end(state, more = {}) {
    this.job = { id: this.job.id, kind: 'solve', state, has_plan: 'plan' in more, ...more };
  }

  async answer(request, url, json) {
    let body = '';
    for await (const part of request) body += part;
    const { method } = request;
    if (url.pathname === '/api/preview') {
      this.previews.push(JSON.parse(body));
      return this.preview ? json(200, this.preview(this.previews.at(-1))) : json(503, { error: 'ask again' });
    }
    if (url.pathname === '/api/plan') return json(200, this.inForce);
    if (url.pathname === '/api/apply') {
      this.applied.push({ fade_s: url.searchParams.get('fade_s'), plan: JSON.parse(body) });
      this.inForce = this.applied.at(-1).plan;
      return json(200, { applied: true, text: '' });
    }
    if (url.pathname === '/api/jobs' && method === 'POST') {
      this.job = { id: `00000000-00000${++this.#count}`, kind: 'solve', state: 'runs', stage: 'levels', doing: 'error 12 %', has_plan: false };
      return json(200, { id: this.job.id });
    }
    const { plan: _, ...short } = this.job ?? {};
    if (url.pathname === '/api/jobs') return json(200, this.job ? [short] : []);
    if (this.job?.id !== url.pathname.split('/').at(-1)) return json(404, { error: 'there is no such job' });
    if (method === 'DELETE') this.end('cancelled', this.job.can_be_taken ? { plan: this.plan() } : {});
    return json(200, this.job);
  }
}
