/** Where things lie on the drawn plan: world metres to picture pixels, and room for markers that coincide from above. */

import type { Point, Room } from './api';

export interface Spot {
  x: number; // [px] from the left
  y: number; // [px] from the top
}

export interface Scale {
  width: number; // [px] of the drawn plan
  height: number;
  at(x_m: number, y_m: number): Spot;
  px_per_m: number;
}

/** Fits the room into `width` × `maxHeight`, keeping its shape; world +y is up. */
export function scaleFor(room: Room, width: number, maxHeight: number): Scale {
  const wide_m = room.max[0] - room.min[0];
  const deep_m = room.max[1] - room.min[1];
  const px_per_m = Math.min(width / wide_m, maxHeight / deep_m);
  return {
    width: wide_m * px_per_m,
    height: deep_m * px_per_m,
    px_per_m,
    at: (x_m, y_m) => ({ x: (x_m - room.min[0]) * px_per_m, y: (room.max[1] - y_m) * px_per_m }),
  };
}

/** One place per point (undefined without a position). Points of an upright work lie over one another from above:
 *  they are unfolded away from it along its normal, the lowest nearest to it, `gap` pixels apart. */
export function unfold(points: readonly Point[], scale: Scale, gap: number): (Spot | undefined)[] {
  const places: (Spot | undefined)[] = points.map(() => undefined);
  const taken: Spot[] = [];
  const order = points
    .map((point, index) => ({ point, index }))
    .sort((a, b) => (a.point.position?.[2] ?? 0) - (b.point.position?.[2] ?? 0) || a.index - b.index);
  for (const { point, index } of order) {
    if (!point.position) continue;
    const inside = (s: Spot): Spot => ({ x: clamp(s.x, gap, scale.width - gap), y: clamp(s.y, gap, scale.height - gap) });
    const start = inside(scale.at(point.position[0], point.position[1]));
    const [nx, ny] = point.normal ?? [0, 0, 1];
    const flat = Math.hypot(nx, ny);
    // Level surfaces have no side to go to: downwards on the page.
    const step = flat > 0.3 ? { x: nx / flat, y: -ny / flat } : { x: 0, y: 1 };
    let place = start;
    for (let tries = 1; tries <= 24 && taken.some((t) => Math.hypot(t.x - place.x, t.y - place.y) < gap * 0.8); ++tries)
      place = inside({ x: start.x + step.x * gap * tries, y: start.y + step.y * gap * tries });
    taken.push(place);
    places[index] = place;
  }
  return places;
}

/** Where the name of a work stands: behind its points, as its wall sees them; below them where they only look up. In the
 *  middle of the text's foot, and turned to run along a side wall. */
export function namePlace(
  marks: readonly { spot: Spot | undefined; normal: readonly number[] | undefined }[],
  scale: Scale,
): (Spot & { turn_deg: number }) | undefined {
  const spots = marks.flatMap(({ spot }) => (spot ? [spot] : []));
  if (!spots.length) return undefined;
  const [nx, ny] = [0, 1].map((axis) => marks.reduce((sum, { normal }) => sum + (normal?.[axis] ?? 0), 0)) as [number, number];
  const span = (of: (s: Spot) => number): [number, number] => [Math.min(...spots.map(of)), Math.max(...spots.map(of))];
  const [left, right] = span((s) => s.x);
  const [top, bottom] = span((s) => s.y);
  const middle = { x: (left + right) / 2, y: (top + bottom) / 2 };
  const [gap, size] = [12, 11];
  if (Math.hypot(nx, ny) < 0.3) return { x: middle.x, y: bottom + gap + size, turn_deg: 0 };
  if (Math.abs(nx) > Math.abs(ny)) {
    // Behind is the left (normal to the right), or the right. By a wall there is no room but along it.
    if (nx > 0) return left < scale.width * 0.12 ? { x: Math.min(left - gap, 0), y: middle.y, turn_deg: -90 } : { x: middle.x, y: top - gap, turn_deg: 0 };
    return right > scale.width * 0.88 ? { x: Math.max(right + gap, scale.width), y: middle.y, turn_deg: 90 } : { x: middle.x, y: top - gap, turn_deg: 0 };
  }
  // Away from a wall, the lux of a metered point stand there already.
  return ny < 0 ? { x: middle.x, y: top < 2 * gap ? top - gap : top - gap - size, turn_deg: 0 } : { x: middle.x, y: bottom + gap + size, turn_deg: 0 };
}

const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), Math.max(low, high));

/** The beam's sign on the plan, a narrow triangle from the lamp to where it aims, with a blunt end. */
export function beamPath(from: Spot, to: Spot): string {
  const dx = to.x - from.x;
  const dy = to.y - from.y;
  const length = Math.hypot(dx, dy);
  if (length < 4) return '';
  const half = Math.min(18, Math.max(6, length * 0.16));
  const [ox, oy] = [(-dy / length) * half, (dx / length) * half];
  const f = (v: number): string => v.toFixed(1);
  return (
    `M${f(from.x)} ${f(from.y)}L${f(to.x + ox)} ${f(to.y + oy)}` +
    `A${f(half)} ${f(half)} 0 0 0 ${f(to.x - ox)} ${f(to.y - oy)}Z`
  );
}

/** The sign of where a luxmeter is held, about the origin: an arrow from its ring the way it looks; from above, a dot
 *  (up, towards the viewer) or a cross (down). `tip`: where the sign ends. */
export function meterSign(normal: readonly[number, number, number]):
    {path: string; kind: 'side' | 'up' | 'down'; tip: Spot} {
  const [nx, ny, nz] = normal;
  const flat = Math.hypot(nx, ny);
  if (flat < 0.3 * Math.hypot(nx, ny, nz) || flat === 0)
    return {path: nz < 0 ? 'M-5 -5L5 5M-5 5L5 -5' : '', kind: nz < 0 ? 'down' : 'up', tip: {x: 0, y: METER_RING}};
  const [x, y] = [nx / flat, -ny / flat];
  const along = (a: number, aside: number): string =>
      `${(x * a - y * aside).toFixed(1)} ${(y * a + x * aside).toFixed(1)}`;
  const end = METER_RING + 24;
  return {
    path: `M${along(METER_RING, 0)}L${along(end, 0)}M${along(end - 9, -7)}L${along(end, 0)}L${along(end - 9, 7)}`,
    kind: 'side',
    tip: {x: x * end, y: y * end}
  };
}
export const METER_RING = 11;

/** Marker outlines about the origin, one shape per verdict, so that the plan reads without colour. */
export const MARKER_PATHS = {
  met: 'M-6 0A6 6 0 1 1 6 0A6 6 0 1 1 -6 0Z',
  low: 'M-7 -5L7 -5L0 7Z',
  high: 'M-7 5L7 5L0 -7Z',
  over: 'M-7.5 0L0 -7.5L7.5 0L0 7.5Z',
  unknown: 'M-6 0A6 6 0 1 1 6 0A6 6 0 1 1 -6 0ZM-2.6 0A2.6 2.6 0 1 0 2.6 0A2.6 2.6 0 1 0 -2.6 0Z',
  'limit-unknown': 'M-7.5 0L0 -7.5L7.5 0L0 7.5ZM-2.6 0L0 2.6L2.6 0L0 -2.6Z',
  none: 'M-4.5 -4.5H4.5V4.5H-4.5Z',
} as const;
