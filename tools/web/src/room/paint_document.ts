/** What a person paints: a list of strokes is the document, as the daemon's API has it. */

import type {Vec3} from '../api';

export interface SurfacePlace {
  position: Vec3;  // [m] world
  normal: Vec3;    // unit, to the side that is meant
}

export const TOOLS = {
  brush: {key: 'b', name: 'Brush', does: 'paints along a path'},
  bucket: {key: 'g', name: 'Bucket', does: 'fills a whole surface'},
  selective: {
    key: 's',
    name: 'Selective fill',
    does: 'shares a surface out among its clicks: each part has the nearest one’s light'
  },
  eraser: {key: 'e', name: 'Eraser', does: 'takes away the uppermost stroke at a place'},
  picker: {key: 'i', name: 'Picker', does: 'takes the light from a place'},
} as const;
export type Tool = keyof typeof TOOLS;

export interface Stroke {
  kind: 'brush'|'bucket'|'selective'|'eraser';
  lux?: number;
  radius_m?: number;
  falloff?: number;
  path: SurfacePlace[];
}

export interface Pen {
  lux: number;
  radius_m: number;
  falloff: number;
}

export function strokeOf(kind: Stroke['kind'], pen: Pen, place: SurfacePlace): Stroke {
  const {lux, radius_m, falloff} = pen;
  if (kind === 'eraser') return {kind, path: [place]};
  return kind === 'brush' ? {kind, lux, radius_m, falloff, path: [place]} : {kind, lux, path: [place]};
}

const same = (a: Stroke|undefined, b: Stroke|undefined): boolean => JSON.stringify(a) === JSON.stringify(b);

export class PaintDocument {
  private all: Stroke[] = [];
  private undone: Stroke[] = [];
  /** Another one after each change. */
  revision = 0;

  get strokes(): readonly Stroke[] { return this.all; }
  get last(): Stroke|undefined { return this.all[this.all.length - 1]; }
  get canUndo(): boolean { return this.all.length > 0; }
  get canRedo(): boolean { return this.undone.length > 0; }

  add(stroke: Stroke): void { this.set([...this.all, stroke], []); }

  /** The brush at the end goes on. */
  extend(place: SurfacePlace): void {
    const {last} = this;
    if (last?.kind === 'brush') this.set([...this.all.slice(0, -1), {...last, path: [...last.path, place]}], []);
  }

  undo(): void {
    if (this.last) this.set(this.all.slice(0, -1), [...this.undone, this.last]);
  }

  redo(): void {
    const next = this.undone[this.undone.length - 1];
    if (next) this.set([...this.all, next], this.undone.slice(0, -1));
  }

  /** What the daemon has now. Strokes of ours that it has not can be done again. */
  replace(strokes: readonly Stroke[]): void {
    let common = 0;
    while (common < strokes.length && same(strokes[common], this.all[common])) ++common;
    const ours = this.all.slice(common).reverse();
    this.set([...strokes], ours.length ? ours : this.undone);
  }

  /** Another document, or what was refused is gone. */
  open(strokes: readonly Stroke[]): void { this.set([...strokes], []); }

  private set(all: Stroke[], undone: Stroke[]): void {
    [this.all, this.undone] = [all, undone];
    ++this.revision;
  }
}

/** A brush's path needs no more places than its width shows. */
export function isApart(a: Vec3, b: Vec3, radius_m: number): boolean {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) >= Math.max(0.03, radius_m / 4);
}

/** The next radius by the keys [ and ]. */
export function otherRadius(radius_m: number, wider: boolean): number {
  const next = radius_m * (wider ? 1.25 : 0.8);
  return Number(Math.min(10, Math.max(0.05, next)).toPrecision(2));
}
