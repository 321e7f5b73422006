/** Painting goals on the room's surfaces: tools, the strokes, and the daemon's answers. Loaded when it is asked for. */

import '../style/paint.css';

import {Color} from 'three';

import type {Vec3} from '../api';
import {setText} from '../dom';
import type {LuxScale} from './layers';
import {type Goal, addGoal, fetchGoals, fetchPainting, fetchPatches, putStrokes, reload, saveGoal} from './paint_api';
import {PaintDocument, type Stroke, type SurfacePlace, TOOLS, type Tool, isApart, otherRadius, strokeOf} from './paint_document';
import {PaintPanel} from './paint_panel';
import {type Patches, luxAt, takeChange} from './patches';
import {Patches3d} from './patches_3d';
import type {Painter, Room3d} from './room_3d';
import type {SurfaceHit} from './surfaces';

const AGAIN_MS = 500;
const pause = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, AGAIN_MS));

export class Paint implements Painter {
  readonly panel = new PaintPanel();
  private readonly drawn = new Patches3d();
  private readonly strokes = new PaintDocument();
  private tool: Tool = 'brush';
  private goals: Goal[] = [];
  private goal = '';
  private version = '';
  private taken: readonly Stroke[] = [];  // what the daemon has
  private patches: Patches|undefined;
  private origin: Vec3 = [0, 0, 0];
  private brushing = false;
  private sending = false;
  private hover: SurfaceHit|undefined;

  constructor(private readonly room: Room3d) {
    const {panel} = this;
    panel.onTool = (tool) => this.choose(tool);
    panel.onGoal = (goal) => void this.open(goal);
    panel.onNew = (name) => void this.told(this.addGoal(name));
    panel.onUndo = () => this.step('undo');
    panel.onRedo = () => this.step('redo');
    panel.onSave = () => void this.told(this.save());
    panel.onUse = () => void this.told(this.use());
  }

  get group(): Patches3d['group'] { return this.drawn.group; }

  get most(): number {
    let most = 0;
    for (const lux of this.patches?.lux ?? [])
      if (lux > most) most = lux;
    return most;
  }

  /** The person begins to paint. */
  async begin(): Promise<void> {
    this.room.setPainter(this);
    this.choose(this.tool);
    await this.told(this.fetchAll(this.goal));
  }

  end(): void {
    this.drawn.showRim(undefined, undefined, 0, new Color());
    this.room.setPainter(undefined);
  }

  look(scale: LuxScale|undefined, origin: Vec3): void {
    this.origin = origin;
    this.drawn.show(this.patches, origin, scale);
  }

  down(hit: SurfaceHit|undefined): void {
    if (!this.goal) return this.panel.say('Make a surface goal first: give it a name, and press Add.');
    if (!hit) return this.panel.say('There is no surface.');
    const place = this.placeOf(hit);
    if (this.tool === 'picker') return this.pick(place);
    this.strokes.add(strokeOf(this.tool, this.panel.pen, place));
    this.brushing = this.tool === 'brush';
    this.send();
  }

  move(hit: SurfaceHit|undefined, dragging: boolean): void {
    this.hover = hit;
    this.showRim();
    const path = this.strokes.last?.path;
    const last = path?.[path.length - 1];
    if (!dragging || !this.brushing || !hit || !last) return;
    const place = this.placeOf(hit);
    if (!isApart(last.position, place.position, this.panel.pen.radius_m)) return;
    this.strokes.extend(place);
    this.send();
  }

  up(taken_back: boolean): void {
    if (taken_back && this.brushing) {
      this.strokes.undo();
      this.send();
    }
    this.brushing = false;
  }

  key(event: KeyboardEvent, middle: () => SurfaceHit | undefined): boolean {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key !== 'z' && key !== 'y') return false;
      this.step(key === 'y' || event.shiftKey ? 'redo' : 'undo');
      return true;
    }
    if (event.altKey) return false;
    const tool = (Object.keys(TOOLS) as Tool[]).find((one) => TOOLS[one].key === key);
    if (tool && !event.shiftKey)
      this.choose(tool);
    else if (key === '[' || key === ']') {
      this.panel.setRadius(otherRadius(this.panel.pen.radius_m, key === ']'));
      this.showRim();
    } else if (key === 'enter' || key === ' ') {
      this.hover = middle();
      this.showRim();
      this.down(this.hover);
      this.up(false);
    } else
      return false;
    return true;
  }

  private choose(tool: Tool): void {
    this.tool = tool;
    this.panel.showTool(tool);
    this.showRim();
  }

  private placeOf(hit: SurfaceHit): SurfacePlace {
    const position = hit.place.toArray().map((v, axis) => v + this.origin[axis]!) as unknown as Vec3;
    return {position, normal: hit.normal.clone().normalize().toArray() as unknown as Vec3};
  }

  private showRim(): void {
    const radius_m = this.tool === 'brush' ? this.panel.pen.radius_m : 0.08;
    const style = getComputedStyle(this.room.root);
    this.drawn.showRim(this.hover?.place, this.hover?.normal, radius_m, new Color(style.color));
  }

  private pick({position, normal}: SurfacePlace): void {
    const lux = this.patches && luxAt(this.patches, position, normal);
    if (lux === undefined) return this.panel.say('Nothing is painted there.');
    this.panel.setLux(lux);
    this.panel.say(`${Math.round(lux)} lx is taken from there.`);
  }

  private step(way: 'undo'|'redo'): void {
    this.strokes[way]();
    this.send();
  }

  /** Keeps what a person did or the daemon said in view. */
  private async told(work: Promise<string|void>): Promise<void> {
    this.panel.busy(true);
    try {
      const words = await work;
      if (words) this.panel.say(words);
    } catch (error) {
      this.panel.say(error instanceof Error ? error.message : String(error), true);
    }
    this.panel.busy(false);
    this.tell();
  }

  private async fetchAll(goal: string): Promise<void> {
    this.goals = await fetchGoals();
    const open = this.goals.find((one) => one.name === goal) ?? this.goals[0];
    this.panel.showGoals(this.goals, open?.name ?? '');
    if (open) await this.open(open.name);
  }

  private async open(goal: string): Promise<void> {
    this.goal = goal;
    this.patches = undefined;
    await this.told(this.fetchPainting(false));
  }

  /** keep: strokes that the daemon has not can be done again. */
  private async fetchPainting(keep: boolean): Promise<void> {
    const {goal} = this;
    for (;;) {
      // The version of both has to be the same: somebody may paint meanwhile.
      const [painting, patches] = [await fetchPainting(goal), await fetchPatches(goal)];
      if (goal !== this.goal) return;
      if (patches === 'wait' || patches.version !== painting.version) {
        this.panel.say('The surfaces are cut into patches …');
        await pause();
        continue;
      }
      [this.version, this.patches, this.taken] = [painting.version, patches, painting.strokes];
      if (keep)
        this.strokes.replace(painting.strokes);
      else
        this.strokes.open(painting.strokes);
      this.panel.say('');
      break;
    }
    this.room.painted();
  }

  /** The list goes to the daemon, one request at a time; what came meanwhile goes after it. */
  private send(): void {
    this.tell();
    if (!this.sending) void this.sendAll();
  }

  private async sendAll(): Promise<void> {
    this.sending = true;
    let revision = -1;
    try {
      while (revision !== this.strokes.revision) {
        const {goal, strokes: {strokes: sent}} = this;
        revision = this.strokes.revision;
        const change = await putStrokes(goal, sent, this.version);
        if (goal !== this.goal) break;
        if (change === 'wait') {
          this.panel.say('The surfaces are cut into patches …');
          await pause();
          revision = -1;
          continue;
        }
        if ('stale' in change) {
          this.brushing = false;
          await this.fetchAfterConflict();
          break;
        }
        [this.version, this.taken] = [change.version, sent];
        if (this.patches) takeChange(this.patches, change);
        const saved = this.goals.find((one) => one.name === goal);
        if (saved && change.patches.length) saved.saved = false;
        this.panel.say('');
        this.room.painted();
      }
    } catch (error) {
      // What the daemon refuses is not in the document.
      this.brushing = false;
      this.strokes.open(this.taken);
      this.panel.say(error instanceof Error ? error.message : String(error), true);
    }
    this.sending = false;
    this.tell();
  }

  private async fetchAfterConflict(): Promise<void> {
    await this.fetchPainting(true);
    this.panel.say(
        'Somebody else has painted this goal meanwhile. Their strokes are shown; Redo puts yours on top.', true);
  }

  private async addGoal(name: string): Promise<string> {
    if (!name) return 'Give the new surface goal a name.';
    await addGoal(name);
    await this.fetchAll(name);
    return `${name} is in the rig file. Paint it; Use puts it in force.`;
  }

  private async save(): Promise<string> {
    if (!this.goal) return 'There is no surface goal yet.';
    await saveGoal(this.goal);
    for (const goal of this.goals)
      if (goal.name === this.goal) goal.saved = true;
    return 'Saved beside the rig file. The light stays as it is until you press Use.';
  }

  private async use(): Promise<string> {
    await this.save();
    this.panel.say('The goals are solved; the light follows …');
    const words = await reload();
    await this.fetchAll(this.goal);
    return `In force. ${words}`;
  }

  private tell(): void {
    const goal = this.goals.find((one) => one.name === this.goal);
    this.panel.showState({
      strokes: this.strokes.strokes.length,
      can_undo: this.strokes.canUndo,
      can_redo: this.strokes.canRedo,
      saved: goal?.saved ?? true,
      in_force: goal?.in_force ?? true,
      has_goal: goal !== undefined,
    });
    setText(this.room.heard, `${this.strokes.strokes.length} strokes`);
  }
}
