/** The live line to the daemon: it is asked five times a second what has changed. A line that is silent or broken is
 *  lost, and asked again until it answers. */

import {fetchSession, readStatus, type Status} from './api';
import {StatusFeed} from './status_feed';

export interface Line {
  state: 'connecting' | 'live' | 'lost' | 'unknown'; // unknown: this browser is, to the daemon
  ageS?: number; // since the last status arrived
}

const PERIOD_MS = 200;
/** Two seconds of silence are a lost line. */
const SILENCE_MS = 2000;
const RETRY_MS = 1000;

/** The answer as JSON; undefined if there is none in time, or a refusal. */
async function ask(route: string, within_ms = SILENCE_MS): Promise<unknown> {
  const stop = new AbortController();
  const timer = setTimeout(() => stop.abort(), within_ms);
  try {
    // The rig is kept by the browser, which asks whether it is still the same.
    const answer = await fetch(route, {cache: route === '/api/rig' ? 'no-cache' : 'no-store', signal: stop.signal});
    return answer.ok ? await answer.json() : undefined;
  } catch {
    return undefined;
  } finally {
    clearTimeout(timer);
  }
}

export function follow(onStatus: (status: Status) => void, onLine: (line: Line) => void): void {
  const feed = new StatusFeed();
  const begunAt = performance.now();
  let rig: Record<string, unknown>|undefined;
  let rigOf = '';
  let lastAt: number | undefined;
  let broken = false;
  let unknown = false;

  const next = async(): Promise<Status|undefined> => {
    const taken = feed.take(await ask(`/api/status?since=${encodeURIComponent(feed.version)}`));
    if (!taken) {
      feed.forget();
      return undefined;
    }
    if (feed.rigEtag && feed.rigEtag !== rigOf) {
      const asked = feed.rigEtag;
      const found = await ask('/api/rig', 10_000);
      if (typeof found === 'object' && found !== null) {
        rig = found as Record<string, unknown>;
        rigOf = asked;
      }
    }
    // In its first seconds a daemon cannot say yet what the rig is, apart from its state.
    return feed.rigEtag && rig && rigOf === feed.rigEtag ? readStatus(feed.status(rig)) :
                                                           readStatus(await ask('/api/status'));
  };

  const go = async(): Promise<void> => {
    const began = performance.now();
    const status = await next().catch(() => undefined);
    if (status) {
      lastAt = performance.now();
      broken = unknown = false;
      onStatus(status);
    } else {
      broken = true;
      void fetchSession().then((session) => (unknown = session?.open === false));
    }
    watch();
    const wait_ms = status ? began + PERIOD_MS - performance.now() : RETRY_MS;
    setTimeout(() => void go(), Math.max(0, wait_ms));
  };

  const watch = (): void => {
    const now = performance.now();
    const lost = broken || now - (lastAt ?? begunAt) > SILENCE_MS;
    const ageS = lastAt === undefined ? undefined : (now - lastAt) / 1000;
    onLine({ state: lost && unknown ? 'unknown' : lost ? 'lost' : lastAt === undefined ? 'connecting' : 'live', ...(ageS === undefined ? {} : { ageS }) });
  };

  void go();
  setInterval(watch, 250);
}
