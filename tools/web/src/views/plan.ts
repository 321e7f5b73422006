/** The room from above: picture, beams, fixtures with their level, measurement points by error. */

import type {Question, Room, Status} from '../api';
import {element, setAttribute, setText, svg} from '../dom';
import { lux, percent } from '../format';
import { judge } from '../judge';
import {type Scale, type Spot, MARKER_PATHS, METER_RING, beamPath, meterSign, namePlace, scaleFor, unfold} from '../plan_layout';
import type { Selection } from '../selection';
import { worksOf } from '../works';
import { fixtureTip, pointTip, placeTip } from './tip';

/** Round the room, for the names of works on its walls. */
const MARGIN = 20;
const LABEL_PER_LETTER = 7.4;
const LAMP_RADIUS = 9;
const RING_RADIUS = 11.5;
const RING = 2 * Math.PI * RING_RADIUS;

interface FixtureMark {
  beam: SVGPathElement;
  line: SVGLineElement;
  glow: SVGCircleElement;
  ring: SVGCircleElement;
}

interface PointMark {
  group: SVGGElement;
  shape: SVGPathElement;
  label: SVGTextElement;
}

export class PlanView {
  readonly root: HTMLElement;
  readonly legend = legend();
  private readonly stage = element('div', { class: 'plan-stage' });
  private readonly tip = element('div', { class: 'tip', 'aria-hidden': 'true' });
  private readonly drawing = svg('svg', { class: 'plan', role: 'img', 'aria-label': 'The room from above' });
  private room: Room | undefined;
  private status: Status | undefined;
  private scale: Scale | undefined;
  private drawnFor = '';
  private fixtures: FixtureMark[] = [];
  private points: PointMark[] = [];
  private readonly asked = svg('g', {class: 'asked'});
  private askedFor = '';
  private hovered: { kind: 'fixture' | 'point'; index: number; at: Spot } | undefined;

  constructor(private readonly selection: Selection) {
    this.stage.append(this.drawing, this.tip);
    this.root = this.stage;
    new ResizeObserver(() => this.update()).observe(this.stage);
    selection.onChange(() => this.showSelection());
  }

  setRoom(room: Room): void {
    this.room = room;
    this.drawnFor = '';
    this.update();
  }

  show(status: Status): void {
    this.status = status;
    this.update();
  }

  private update(): void {
    if (!this.room || !this.status) return;
    const width = this.stage.clientWidth;
    if (width < 50) return;
    // What the drawing's skeleton depends on; only levels and verdicts change between two updates.
    const key = JSON.stringify([
      width,
      window.innerHeight,
      this.status.fixtures.map((f) => [f.name, f.position, f.aim]),
      this.status.points.map((p) => [p.name, p.position]),
    ]);
    if (key !== this.drawnFor) {
      this.drawnFor = key;
      this.draw(this.room, this.status, width);
    }
    this.refresh(this.status);
  }

  private draw(room: Room, status: Status, width: number): void {
    const scale = scaleFor(room, width - 2 * MARGIN, Math.max(320, window.innerHeight * 0.7));
    this.scale = scale;
    const { drawing } = this;
    drawing.replaceChildren();
    const [whole_width, whole_height] = [scale.width + 2 * MARGIN, scale.height + 2 * MARGIN];
    setAttribute(drawing, 'viewBox', `${-MARGIN} ${-MARGIN} ${whole_width.toFixed(1)} ${whole_height.toFixed(1)}`);
    drawing.style.width = `${whole_width}px`;
    drawing.style.height = `${whole_height}px`;
    if (room.picture)
      drawing.append(
        svg('image', { href: room.picture, width: scale.width, height: scale.height, preserveAspectRatio: 'none', class: 'plan-picture' }),
      );
    drawing.append(svg('rect', { class: 'plan-veil', width: scale.width, height: scale.height }));
    const marks = width < 500 ? 0.72 : 1;
    const [beams, leaders, lamps, markers, labels] = [svg('g'), svg('g', { class: 'leaders' }), svg('g'), svg('g'), svg('g')];
    // Points over lamps: where both are at one place, the lux matter more.
    drawing.append(beams, leaders, lamps, markers, labels, this.asked);
    this.askedFor = '';

    this.fixtures = status.fixtures.map((fixture, index) => {
      const at = fixture.position ? scale.at(fixture.position[0], fixture.position[1]) : undefined;
      const aim = fixture.aim ? scale.at(fixture.aim[0], fixture.aim[1]) : undefined;
      const beam = svg('path', { class: 'beam', d: at && aim ? beamPath(at, aim) : '', fill: `url(#beam-${index})` });
      if (at && aim) beams.append(fading(`beam-${index}`, at, aim));
      const line = svg('line', { class: 'aim', x1: at?.x ?? 0, y1: at?.y ?? 0, x2: aim?.x ?? at?.x ?? 0, y2: aim?.y ?? at?.y ?? 0 });
      const glow = svg('circle', { class: 'lamp-glow', r: LAMP_RADIUS - 1.5 });
      const ring = svg('circle', { class: 'lamp-ring', r: RING_RADIUS, transform: 'rotate(-90)' });
      const group = svg(
        'g',
        { class: 'lamp', transform: `${moved(at)} scale(${marks})` },
        svg('circle', { class: 'lamp-body', r: RING_RADIUS + 2 }),
        svg('circle', { class: 'lamp-track', r: RING_RADIUS }),
        ring,
        glow,
      );
      if (at) this.watch(group, 'fixture', index, at);
      beams.append(beam, line);
      lamps.append(group);
      return { beam, line, glow, ring };
    });

    const places = unfold(status.points, scale, width < 500 ? 11 : 15);
    this.points = status.points.map((point, index) => {
      const place = places[index];
      const shape = svg('path', { class: 'shape' });
      // Beside the marker, on the side where the neighbours of an upright work are not.
      const [nx, ny] = point.normal ?? [0, 0];
      const beside = Math.abs(ny) > Math.abs(nx) && Math.abs(ny) > 0.3;
      const left = (place?.x ?? 0) > scale.width - 60;
      const transform = `${moved(place)} scale(${marks})`;
      const label = svg('text', beside
        ? { class: 'lux-label', transform, x: left ? -13 : 13, y: 4, 'text-anchor': left ? 'end' : 'start' }
        : { class: 'lux-label', transform, y: -12, 'text-anchor': 'middle' });
      labels.append(label);
      const group = svg('g', { class: 'point', transform });
      if (point.max_lux !== undefined) group.append(svg('circle', { class: 'limit-mark', r: 10.5 }));
      group.append(shape, svg('circle', { class: 'meter-mark', r: 2.6 }));
      if (place && point.position) {
        const true_place = scale.at(point.position[0], point.position[1]);
        if (Math.hypot(true_place.x - place.x, true_place.y - place.y) > 1)
          leaders.append(svg('line', { x1: true_place.x, y1: true_place.y, x2: place.x, y2: place.y }));
        this.watch(group, 'point', index, place);
      }
      markers.append(group);
      return { group, shape, label };
    });
    for (const work of worksOf(status.points)) {
      const at = namePlace(work.points.map((index) => ({ spot: places[index], normal: status.points[index]!.normal })), scale);
      if (!at) continue;
      const turned = at.turn_deg === 0 ? '' : ` rotate(${at.turn_deg})`;
      labels.append(svg('text', { class: 'work-name', transform: `translate(${at.x.toFixed(1)} ${at.y.toFixed(1)})${turned}`, 'text-anchor': 'middle' },
        document.createTextNode(work.name)));
    }
    this.showSelection();
  }

  private refresh(status: Status): void {
    status.fixtures.forEach((fixture, index) => {
      const mark = this.fixtures[index];
      if (!mark) return;
      const level = Math.min(1, Math.max(0, fixture.level ?? 0));
      mark.beam.style.opacity = level > 0 ? (0.12 + 0.55 * level).toFixed(3) : '0';
      mark.line.style.opacity = level > 0 ? '0.75' : '0.4';
      mark.glow.style.fillOpacity = level > 0 ? (0.25 + 0.75 * level).toFixed(3) : '0';
      setAttribute(mark.ring, 'stroke-dasharray', `${(level * RING).toFixed(2)} ${RING.toFixed(2)}`);
      mark.beam.classList.toggle(
          'asked-lamp', status.question !== undefined && status.question.fixture === fixture.name);
    });
    status.points.forEach((point, index) => {
      const mark = this.points[index];
      if (!mark) return;
      const judged = judge(point);
      const measured = point.measured_lux !== undefined;
      setAttribute(mark.group, 'data-verdict', judged.verdict);
      setAttribute(mark.group, 'data-measured', String(measured));
      setText(mark.label, measured ? lux(point.measured_lux) : '');
      setAttribute(mark.shape, 'd', MARKER_PATHS[judged.verdict]);
      // Small misses pale, large ones full.
      const size = judged.verdict === 'low' || judged.verdict === 'high' ? Math.min(1, 0.5 + 4 * Math.abs(judged.error ?? 0)) : 1;
      mark.shape.style.fillOpacity = size.toFixed(2);
    });
    this.showAsked(status.question);
    const goals = status.points.filter((p) => p.goal_lux !== undefined);
    setAttribute(
      this.drawing,
      'aria-label',
      `The room from above: ${status.fixtures.length} fixtures, mean level ` +
        `${percent(status.fixtures.reduce((sum, f) => sum + (f.level ?? 0), 0) / Math.max(1, status.fixtures.length))}; ` +
        `${goals.filter((p) => p.verdict === 'met').length} of ${goals.length} goals met. The tables hold the same numbers.`,
    );
    this.showTip();
  }

  /** Where the luxmeter is asked for. */
  private showAsked(question: Question|undefined): void {
    const {scale} = this;
    const key = question?.position ? JSON.stringify([question.position, question.normal]) : 'none';
    if (!scale || key === this.askedFor) return;
    this.askedFor = key;
    this.asked.replaceChildren();
    if (!question?.position) return;
    const at = scale.at(question.position[0], question.position[1]);
    const sign = meterSign(question.normal ?? [0, 0, 1]);
    // Beside the sign, where its arrow is not, and inside the room.
    const words = `${question.position[2].toFixed(2)} m high`;
    const wide = words.length * LABEL_PER_LETTER + 8;
    const along = Math.abs(sign.tip.x) > Math.abs(sign.tip.y);
    const beside = along                           ? -wide / 2 :
        at.x + METER_RING + 6 + wide > scale.width ? -METER_RING - 6 - wide :
                                                     METER_RING + 6;
    const left = Math.min(Math.max(beside, -at.x), scale.width - at.x - wide);
    const top = along ? (at.y + 40 > scale.height ? -METER_RING - 26 : METER_RING + 6) : -10;
    setAttribute(this.asked, 'transform', moved(at));
    setAttribute(this.asked, 'data-looks', sign.kind);
    this.asked.append(
        svg('circle', {class: 'asked-ground', r: METER_RING}),
        svg('path', {class: 'asked-ground', d: sign.path}),
        svg('circle', {class: 'asked-pulse', r: 2 * METER_RING}),
        svg('circle', {r: METER_RING}),
        sign.kind === 'up' ? svg('circle', {class: 'asked-dot', r: 3}) : svg('path', {d: sign.path}),
        svg('rect', {x: left.toFixed(1), y: top, width: wide.toFixed(1), height: 20, rx: 5}),
        svg('text', {x: (left + wide / 2).toFixed(1), y: top + 14.5, 'text-anchor': 'middle'},
            document.createTextNode(words)),
    );
  }

  private watch(group: SVGGElement, kind: 'fixture' | 'point', index: number, at: Spot): void {
    const enter = (): void => {
      this.hovered = { kind, index, at };
      this.selection.set({ kind, index });
      this.showTip();
    };
    group.addEventListener('pointerenter', enter);
    group.addEventListener('click', enter);
    group.addEventListener('pointerleave', () => {
      this.hovered = undefined;
      this.selection.set(undefined);
      this.showTip();
    });
  }

  private showTip(): void {
    const { hovered, status, scale } = this;
    const point = hovered?.kind === 'point' ? status?.points[hovered.index] : undefined;
    const fixture = hovered?.kind === 'fixture' ? status?.fixtures[hovered.index] : undefined;
    if (!hovered || !scale || !(point || fixture)) {
      this.tip.classList.remove('shown');
      return;
    }
    if (point) pointTip(this.tip, point);
    else if (fixture) fixtureTip(this.tip, fixture);
    placeTip(this.tip, { x: hovered.at.x + MARGIN, y: hovered.at.y + MARGIN }, this.drawing, this.stage);
  }

  private showSelection(): void {
    const chosen = this.selection.current;
    this.points.forEach((mark, i) => mark.group.classList.toggle('chosen', chosen?.kind === 'point' && chosen.index === i));
    this.fixtures.forEach((mark, i) => mark.beam.classList.toggle('chosen', chosen?.kind === 'fixture' && chosen.index === i));
  }
}

/** Out of sight without a place. */
const moved = (place: Spot | undefined): string =>
  place ? `translate(${place.x.toFixed(1)} ${place.y.toFixed(1)})` : 'translate(-99 -99)';

/** Light thins out on its way. */
function fading(id: string, from: Spot, to: Spot): SVGElement {
  return svg('linearGradient', { id, gradientUnits: 'userSpaceOnUse', x1: from.x, y1: from.y, x2: to.x, y2: to.y },
    svg('stop', { offset: 0, class: 'beam-near' }), svg('stop', { offset: 1, class: 'beam-far' }));
}

function legend(): HTMLElement {
  const entry = (verdict: keyof typeof MARKER_PATHS, words: string): HTMLElement =>
    element(
      'li',
      {},
      svg('svg', { viewBox: '-9 -9 18 18', class: 'key', 'aria-hidden': 'true' },
        svg('g', { class: 'point', 'data-verdict': verdict }, svg('path', { class: 'shape', d: MARKER_PATHS[verdict] }))),
      words,
    );
  const drawn = (words: string, ...parts: SVGElement[]): HTMLElement =>
    element('li', {}, svg('svg', { viewBox: '-13 -13 26 26', class: 'key', 'aria-hidden': 'true' }, ...parts), words);
  return element(
    'ul',
    { class: 'legend', 'aria-label': 'Signs on the plan' },
    entry('met', 'goal met'),
    entry('low', 'too dark'),
    entry('high', 'too bright'),
    entry('unknown', 'not known'),
    entry('over', 'over its limit'),
    drawn('has a limit', svg('circle', { class: 'limit-mark', r: 10 })),
    drawn('has a meter', svg('g', { class: 'point', 'data-verdict': 'met', 'data-measured': 'true' }, svg('path', { class: 'shape', d: MARKER_PATHS.met }), svg('circle', { class: 'meter-mark', r: 3 }))),
    drawn('lamp, ring = level', svg('circle', { class: 'lamp-track', r: 10 }),
      svg('circle', { class: 'lamp-ring', r: 10, 'stroke-dasharray': '40 70', transform: 'rotate(-90)' }),
      svg('circle', { class: 'lamp-glow', r: 7 })),
  );
}
