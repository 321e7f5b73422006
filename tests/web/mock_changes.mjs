// GET /api/status?since= and GET /api/rig of the mock daemon, made of its whole status as the real one makes them.

/** What only a reload changes. */
const FIXED = {
  fixtures: ['name', 'bus', 'address', 'luminaire', 'position', 'moves', 'max_level', 'parks', 'mount_axes'],
  points: ['name', 'position', 'normal', 'max_lux', 'goal_tolerance'],
  luxmeters: ['name', 'bus', 'address', 'position', 'tolerance', 'point'],
  devices: [],
};
const AGES = { age_s: 'at_s', since_s: 'since_at_s', last_ok_s: 'last_ok_at_s', measured_age_s: 'measured_at_s', shown_age_s: 'shown_at_s', phase_s: 'phase_at_s' };
const KEPT = 50; // versions

const pick = (from, keys, wanted) => Object.fromEntries(Object.entries(from).filter(([key]) => keys.includes(key) === wanted));

function instants(value, now) {
  if (Array.isArray(value)) return value.map((one) => instants(one, now));
  if (typeof value !== 'object' || value === null) return value;
  return Object.fromEntries(Object.entries(value).map(([key, one]) =>
    typeof one === 'number' && AGES[key] ? [AGES[key], Number((now - one).toFixed(2))]
      : key === 'remaining_s' ? ['until_at_s', Number((now + one).toFixed(2))] : [key, instants(one, now)]));
}

export const rigOf = (status) => ({
  name: status.rig, luminaires: [{ name: 'spot', lumens: 800, watts: 12, colour_rgb: [1, 1, 1] }],
  ...Object.fromEntries(Object.keys(FIXED).filter((list) => list !== 'devices').map((list) => [list, status[list].map((one) => pick(one, FIXED[list], true))])),
});

export class Changes {
  #versions = new Map(); // version -> {key: text}, {list: [text]}
  #count = 0;

  since(version, status) {
    const { time_s: now, ...all } = status;
    const rest = {}, lists = {};
    for (const [key, value] of Object.entries(all))
      if (FIXED[key]) lists[key] = value.map((one, index) => JSON.stringify({ ...instants(pick(one, FIXED[key], false), now), index }));
      else rest[key] = JSON.stringify(instants(value, now));
    const before = this.#versions.get(version);
    const mine = `v${++this.#count}`;
    this.#versions.set(mine, { rest, lists });
    if (this.#versions.size > KEPT) this.#versions.delete(this.#versions.keys().next().value);
    const changed = {};
    for (const [key, text] of Object.entries(rest)) if (text !== before?.rest[key]) changed[key] = JSON.parse(text);
    for (const key of Object.keys(before?.rest ?? {})) if (!(key in rest)) changed[key] = null;
    const answer = { version: mine, whole: !before, time_s: now, rig_etag: `rig-${status.rig.length}`, changed };
    for (const [key, texts] of Object.entries(lists)) {
      const news = texts.filter((text, i) => text !== before?.lists[key][i]);
      if (news.length || !before) answer[key] = news.map((text) => JSON.parse(text));
    }
    return answer;
  }
}
