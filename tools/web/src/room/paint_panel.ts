/** The tools for painting: which, how wide, how much light; and what becomes of the strokes. */

import {element, setAttribute, setText} from '../dom';

import {PRESETS} from './lux_presets';

import type {Goal} from './paint_api';
import {type Pen, TOOLS, type Tool} from './paint_document';

const MOST_LUX = 1e6;

export interface PaintState {
  strokes: number;
  can_undo: boolean;
  can_redo: boolean;
  saved: boolean;
  in_force: boolean;
  has_goal: boolean;
}

export class PaintPanel {
  readonly root = element('div', {class: 'paint', role: 'group', 'aria-label': 'Paint goals'});
  private readonly tools = new Map<Tool, HTMLButtonElement>();
  private readonly goal = element('select', {id: 'paint-goal'});
  private readonly name = element('input', {id: 'paint-name', maxlength: '100', autocomplete: 'off'});
  private readonly lux = numberInput('paint-lux', '300', '0', String(MOST_LUX), 'any');
  private readonly radius = numberInput('paint-radius', '0.3', '0.01', '10', 'any');
  private readonly soft = element('input', {id: 'paint-soft', type: 'checkbox'});
  private readonly undo = button('Undo', 'paint-undo', 'Ctrl+Z');
  private readonly redo = button('Redo', 'paint-redo', 'Ctrl+Shift+Z');
  private readonly save = button('Save', 'paint-save');
  private readonly use = button('Use', 'paint-use');
  private readonly state = element('span', {class: 'paint-state'});
  private readonly said = element('p', {class: 'paint-said', role: 'status'});
  onTool: (tool: Tool) => void = () => undefined;
  onGoal: (goal: string) => void = () => undefined;
  onNew: (name: string) => void = () => undefined;
  onUndo: () => void = () => undefined;
  onRedo: () => void = () => undefined;
  onSave: () => void = () => undefined;
  onUse: () => void = () => undefined;

  constructor() {
    const tools = element('div', {class: 'filters', role: 'group', 'aria-label': 'Tool'});
    for (const tool of Object.keys(TOOLS) as Tool[]) {
      const {name, key, does} = TOOLS[tool];
      const one = element(
          'button', {
            type: 'button',
            id: `paint-${tool}`,
            'aria-pressed': 'false',
            title: does,
            'aria-keyshortcuts': key.toUpperCase()
          },
          name, element('kbd', {'aria-hidden': 'true'}, key.toUpperCase()));
      one.addEventListener('click', () => this.onTool(tool));
      this.tools.set(tool, one);
      tools.append(one);
    }
    const presets: HTMLSelectElement = element(
        'select', {id: 'paint-preset', 'aria-label': 'Light that standards name'},
        element('option', {value: ''}, 'as standards say …'),
        ...PRESETS.map(
            ({source, presets: some}) => element(
                'optgroup', {label: source},
                ...some.map(({lux, words}) => element('option', {value: String(lux)}, `${lux} lx, ${words}`)))));
    presets.addEventListener('change', () => {
      if (presets.value) this.lux.value = presets.value;
    });
    this.lux.addEventListener('input', () => void (presets.value = ''));
    this.goal.addEventListener('change', () => this.onGoal(this.goal.value));
    const made = element(
        'form', {class: 'paint-new'}, label('paint-name', 'New goal'), this.name,
        element('button', {type: 'submit', id: 'paint-add'}, 'Add'));
    made.addEventListener('submit', (event) => {
      event.preventDefault();
      this.onNew(this.name.value.trim());
      this.name.value = '';
    });
    this.undo.addEventListener('click', () => this.onUndo());
    this.redo.addEventListener('click', () => this.onRedo());
    this.save.addEventListener('click', () => this.onSave());
    this.use.addEventListener('click', () => this.onUse());
    this.root.append(
        tools,
        row(together(label('paint-lux', 'Light'), this.lux, 'lx', presets),
            together(
                label('paint-radius', 'Radius'), this.radius, 'm',
                element('label', {class: 'paint-soft'}, this.soft, 'soft edge'))),
        row(this.undo, this.redo, this.save, this.use, this.state), this.said,
        row(label('paint-goal', 'Surface goal'), this.goal, made),
        element(
            'details', {class: 'room-keys'}, element('summary', {}, 'How to paint'),
            element(
                'p', {},
                'Drag on a surface with the left button or one finger. The right button, or two fingers, move the room; the arrow keys turn it.'),
            element(
                'p', {},
                'By keys alone: bring the place into the middle of the picture, then Enter. B, G, S, E and I choose a tool; [ and ] the radius; Ctrl+Z and Ctrl+Shift+Z undo and redo.'),
            element(
                'p', {},
                'Save writes strokes and points beside the rig file. Use saves, reads the rig again and solves its goals: the light follows, unless a plan that a person applied is in force.')));
  }

  get pen(): Pen {
    return {
      lux: within(this.lux, 300, 0, MOST_LUX),
      radius_m: within(this.radius, 0.3, 0.01, 10),
      falloff: this.soft.checked ? 0.5 : 0,
    };
  }

  setLux(lux: number): void { this.lux.value = String(Number(lux.toPrecision(4))); }
  setRadius(radius_m: number): void { this.radius.value = String(radius_m); }

  showTool(tool: Tool): void {
    for (const [name, one] of this.tools) setAttribute(one, 'aria-pressed', String(name === tool));
  }

  showGoals(goals: readonly Goal[], chosen: string): void {
    this.goal.replaceChildren(...goals.map(({name}) => element('option', {value: name}, name)));
    this.goal.value = chosen;
    this.goal.disabled = goals.length === 0;
  }

  showState(state: PaintState): void {
    this.undo.disabled = !state.can_undo;
    this.redo.disabled = !state.can_redo;
    this.save.disabled = state.saved;
    this.use.disabled = !state.has_goal;
    const strokes = state.strokes === 1 ? '1 stroke' : `${state.strokes} strokes`;
    setText(
        this.state,
        !state.has_goal ?
            'This rig has no surface goal yet.' :
            `${strokes}, ${state.saved ? 'saved' : 'not saved'}${state.in_force ? '' : '; not in force yet'}`);
  }

  busy(on: boolean): void { setAttribute(this.root, 'aria-busy', String(on)); }

  say(words: string, bad = false): void {
    setText(this.said, words);
    this.said.classList.toggle('bad', bad);
  }
}

function numberInput(id: string, value: string, min: string, max: string, step: string): HTMLInputElement {
  return element('input', {id, type: 'number', inputmode: 'decimal', value, min, max, step});
}
function button(words: string, id: string, keys?: string): HTMLButtonElement {
  return element('button', {type: 'button', id, ...(keys ? {title: keys} : {})}, words);
}
function label(of: string, words: string): HTMLLabelElement {
  return element('label', {for: of
  }, words);
}
function row(...parts: (Node|string)[]): HTMLElement { return element('div', {class: 'paint-row'}, ...parts); }
function together(...parts: (Node|string)[]): HTMLElement {
  return element('div', {class: 'paint-together'}, ...parts);
}
/** What is typed, if it is a number in this range. */
function within(input: HTMLInputElement, otherwise: number, low: number, high: number): number {
  const value = input.valueAsNumber;
  return Number.isFinite(value) ? Math.min(high, Math.max(low, value)) : otherwise;
}
