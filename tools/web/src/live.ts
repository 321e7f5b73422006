/** The live line to the daemon: server-sent events, watched by age. The browser's own reconnect gives up after an
 *  HTTP error and cannot see a line that is open but silent, so both are dealt with here. */

import {fetchSession, readStatus, type Status} from './api';

export interface Line {
  state: 'connecting' | 'live' | 'lost' | 'unknown'; // unknown: this browser is, to the daemon
  ageS?: number; // since the last status arrived
}

/** The daemon sends five a second: two seconds of silence are a lost line. */
const SILENCE_MS = 2000;
const RETRY_MS = 1500;

export function follow(onStatus: (status: Status) => void, onLine: (line: Line) => void): void {
  let source: EventSource | undefined;
  let openedAt = -Infinity;
  let lastAt: number | undefined;
  let broken = false;
  let unknown = false;

  const open = (): void => {
    source?.close();
    openedAt = performance.now();
    source = new EventSource('/api/events');
    source.addEventListener('status', (event) => {
      let status: Status | undefined;
      try {
        status = readStatus(JSON.parse((event as MessageEvent<string>).data));
      } catch {
        return; // cut short: the next one is 0.2 s away, and silence shows as a lost line
      }
      if (!status) return;
      lastAt = performance.now();
      broken = unknown = false;
      onStatus(status);
      watch();
    });
    source.addEventListener('error', () => {
      broken = true;
      // An event stream does not say why it was refused.
      void fetchSession().then((session) => {
        unknown = session?.open === false;
        watch();
      });
      watch();
    });
  };

  const watch = (): void => {
    const now = performance.now();
    const silentMs = now - (lastAt ?? openedAt);
    const lost = broken || silentMs > SILENCE_MS;
    if (lost && now - openedAt > RETRY_MS) open();
    const ageS = lastAt === undefined ? undefined : (now - lastAt) / 1000;
    onLine({ state: lost && unknown ? 'unknown' : lost ? 'lost' : lastAt === undefined ? 'connecting' : 'live', ...(ageS === undefined ? {} : { ageS }) });
  };

  open();
  setInterval(watch, 250);
}
