/** Beside the page's main thread, which a large room must not hold up. */

import {makeRoom} from './made_room';

self.onmessage = (message: MessageEvent<ArrayBuffer>) => {
  try {
    const room = makeRoom(message.data);
    const views = [room.positions, room.edges, room.part, room.bvh.index, ...room.parts.map((p) => p.index)];
    const buffers = [...views.flatMap((view) => (view ? [view.buffer as ArrayBuffer] : [])), ...room.bvh.roots];
    self.postMessage({room}, {transfer: [...new Set(buffers)]});
  } catch (error) {
    self.postMessage({error: error instanceof Error ? error.message : String(error)});
  }
};
