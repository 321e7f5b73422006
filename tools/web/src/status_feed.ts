/** The status from what has changed: GET /api/status?since= says only that, and GET /api/rig what never changes. Put
 *  together they are as GET /api/status. Ages come as instants, since an age changes all the time. */

type Fields = Record<string, unknown>;

const LISTS = ['fixtures', 'points', 'luxmeters', 'devices'] as const;
/** Instants, and the age each is in the status. */
const AGES: Record<string, string> = {
  at_s: 'age_s',
  since_at_s: 'since_s',
  last_ok_at_s: 'last_ok_s',
  measured_at_s: 'measured_age_s',
  shown_at_s: 'shown_age_s',
  phase_at_s: 'phase_s',
};

const isFields = (value: unknown): value is Fields =>
    typeof value === 'object' && value !== null && !Array.isArray(value);
const listOf = (value: unknown): Fields[] => (Array.isArray(value) ? value.filter(isFields) : []);

/** Instants become ages, in lists and objects within, too. */
function aged(value: unknown, now_s: number): unknown {
  if (Array.isArray(value)) return value.map((one) => aged(one, now_s));
  if (!isFields(value)) return value;
  const out: Fields = {};
  for (const [key, one] of Object.entries(value)) {
    if (typeof one !== 'number')
      out[key] = aged(one, now_s);
    else if (key === 'until_at_s')
      out['remaining_s'] = Math.max(0, one - now_s);
    else if (AGES[key])
      out[AGES[key]] = Math.max(0, now_s - one);
    else
      out[key] = one;
  }
  return out;
}

export class StatusFeed {
  version = '';  // of the last answer taken; what to ask since
  rigEtag = '';  // of the rig that belongs to it
  private rest: Fields = {};
  private readonly lists = new Map<string, Fields[]>();

  /** False if this is no such answer: nothing is taken. */
  take(answer: unknown): boolean {
    if (!isFields(answer) || typeof answer['version'] !== 'string' || !isFields(answer['changed'])) return false;
    if (answer['whole'] === true) {
      this.rest = {};
      this.lists.clear();
    } else if (!this.version)
      return false;
    this.version = answer['version'];
    this.rigEtag = typeof answer['rig_etag'] === 'string' ? answer['rig_etag'] : '';
    for (const [key, value] of Object.entries(answer['changed']))
      if (value === null)
        delete this.rest[key];
      else
        this.rest[key] = value;
    this.rest['time_s'] = answer['time_s'];
    for (const name of LISTS) {
      const list = this.lists.get(name) ?? [];
      for (const entry of listOf(answer[name])) {
        const index = entry['index'];
        if (typeof index === 'number' && Number.isInteger(index) && index >= 0 && index <= list.length)
          list[index] = entry;
      }
      this.lists.set(name, list);
    }
    return true;
  }

  /** Asks for all the next time. */
  forget(): void { this.version = ''; }

  /** As GET /api/status answers. rig: what GET /api/rig answered. */
  status(rig: Fields): Fields {
    const now_s = typeof this.rest['time_s'] === 'number' ? this.rest['time_s'] : 0;
    const out = aged(this.rest, now_s) as Fields;
    for (const name of LISTS) {
      const fixed = listOf(rig[name]);
      out[name] =
          (this.lists.get(name) ?? []).map((entry, index) => ({...fixed[index], ...(aged(entry, now_s) as Fields)}));
    }
    return out;
  }
}
