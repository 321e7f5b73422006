/** Points of one work: a picture has one in its middle and some at its edges, a sculpture one in front and one on top. */

import type { Point } from './api';

export interface Work {
  name: string;
  points: number[]; // indices, in the order of the rig
}

/** Two points further apart than this are of two works, whatever they are called. */
const LARGEST_WORK_M = 3;

const stemOf = (name: string): string => name.replace(/[-_. /][^-_. /]*$/, '');

/** "heath", "heath-left" and "heath-foot" are of the work "heath"; "venus-top" and "venus-front" of "venus"; a point that
 *  shares its name with no other near it stands alone. In the order of their first points. */
export function worksOf(points: readonly Point[]): Work[] {
  const stems = new Set(points.flatMap((p) => (stemOf(p.name) === p.name ? [] : [stemOf(p.name)])));
  const groups = new Map<string, Work[]>();
  const works: Work[] = [];
  points.forEach((point, index) => {
    const stem = stems.has(point.name) ? point.name : stemOf(point.name);
    const alike = groups.get(stem) ?? [];
    groups.set(stem, alike);
    let work = alike.find((w) => near(points[w.points[0]!]!, point));
    if (!work) {
      work = { name: stem, points: [] };
      alike.push(work);
      works.push(work);
    }
    work.points.push(index);
  });
  for (const work of works) if (work.points.length === 1) work.name = points[work.points[0]!]!.name;
  return works;
}

function near(a: Point, b: Point): boolean {
  if (!a.position || !b.position) return true;
  return Math.hypot(a.position[0] - b.position[0], a.position[1] - b.position[1], a.position[2] - b.position[2]) <= LARGEST_WORK_M;
}
