/** What the light would be if fixtures had other levels or looked elsewhere: POST /api/preview. */

import {type Fixture, type Vec3, fieldsOf, listOf, numbers, post, text} from './api';

export interface Change {
  fixture: string;
  level?: number;
  aim?: Vec3;
  pan_deg?: number;
  tilt_deg?: number;
}
export interface PreviewedFixture {
  fixture: string;
  reached: boolean;
  why: string;
  by_a_person: boolean;
  level?: number;
  pan_deg?: number;
  tilt_deg?: number;
}
export interface Preview {
  fixtures: PreviewedFixture[];
  points: {name: string; lux?: number; standard_error_lux?: number}[];
  reflections: boolean;
  text: string;
}

export function readPreview(value: unknown): Preview {
  const p = fieldsOf(value);
  return {
    fixtures: listOf(p['fixtures']).map((f) => ({
                                          fixture: text(f['fixture']),
                                          reached: f['reached'] === true,
                                          why: text(f['why']),
                                          by_a_person: f['by_a_person'] === true,
                                          ...numbers(f, 'level', 'pan_deg', 'tilt_deg'),
                                        })),
    points: listOf(p['points']).map((one) => ({name: text(one['name']), ...numbers(one, 'lux', 'standard_error_lux')})),
    reflections: p['reflections'] === true,
    text: text(p['text']),
  };
}

const AGAIN_MS = 200;
const AT_REST_MS = 250;

/** Asks for the newest change, one question at a time: direct light at once, with reflections when it rests. */
export class PreviewLine {
  onLight: (light: Preview) => void = () => undefined;
  onFailure: (words: string) => void = () => undefined;
  private wanted: Change[]|undefined;
  private asking = false;
  private resting: ReturnType<typeof setTimeout>|undefined;
  private readonly client = Math.random().toString(36).slice(2, 12) || 'page';

  ask(changes: Change[]): void {
    this.wanted = changes;
    clearTimeout(this.resting);
    if (!this.asking) void this.go(false);
  }

  /** Nothing is wanted any more; an answer under way is not told. */
  stop(): void {
    this.wanted = undefined;
    clearTimeout(this.resting);
  }

  private async go(reflections: boolean): Promise<void> {
    const fixtures = this.wanted;
    if (!fixtures) return;
    this.asking = true;
    let again = false;
    try {
      const light = readPreview(await post('/api/preview', {fixtures, reflections, client: this.client}, 20_000));
      if (this.wanted === fixtures) this.onLight(light);
      // Reflected light is made ready once, at the first question.
      if (reflections && !light.reflections && /made ready/.test(light.text)) again = true;
    } catch (error) {
      const words = error instanceof Error ? error.message : String(error);
      again = /ask again/.test(words);
      if (!again && this.wanted === fixtures) this.onFailure(words);
    }
    this.asking = false;
    if (this.wanted && this.wanted !== fixtures) return void this.go(false);
    if (again || !reflections)
      this.resting = setTimeout(() => !this.asking && void this.go(true), again ? 5 * AGAIN_MS : AT_REST_MS);
  }
}

/** Unit vector in the world along which a fixture looks at these angles; undefined if its mount is not known. */
export function beamOf(fixture: Fixture, pan_deg = fixture.pan_deg, tilt_deg = fixture.tilt_deg): Vec3|undefined {
  const axes = fixture.mount_axes;
  if (!axes || pan_deg === undefined || tilt_deg === undefined) return undefined;
  const [pan, tilt] = [(pan_deg * Math.PI) / 180, (tilt_deg * Math.PI) / 180];
  const beam = [-Math.sin(pan) * Math.sin(tilt), Math.cos(pan) * Math.sin(tilt), -Math.cos(tilt)];
  const along = (i: number): number => axes.reduce((sum, axis, k) => sum + axis[i]! * beam[k]!, 0);
  return [along(0), along(1), along(2)];
}

/** Names that begin alike and end in a number, as one pattern: spot-1 and spot-2 are spot-*. */
export function groupsOf(names: readonly string[]): string[] {
  const counts = new Map<string, number>();
  for (const name of names) {
    const stem = /^(.*[^0-9])[0-9]+$/.exec(name)?.[1];
    if (stem) counts.set(`${stem}*`, (counts.get(`${stem}*`) ?? 0) + 1);
  }
  return [...counts].filter(([, count]) => count > 1).map(([pattern]) => pattern);
}
