/** Numbers and names over the picture of the room, as text of the page. Those that would lie on others are left out. */

import {element, setText} from '../dom';

export interface Label {
  x: number;  // [px] of the middle, from the picture's upper left
  y: number;
  text: string;
  kind: 'lux'|'work'|'chosen'|'asked';
}

const LETTER_PX = 7.2;
const HIGH_PX = 16;

/** The labels that fit, the first ones first. isSeen: asked only of those that would fit, since it takes its time. */
export function fitting<L extends Label>(
    labels: readonly L[], width: number, height: number, isSeen: (label: L) => boolean = () => true, most = 80): L[] {
  const taken: {left: number; right: number; top: number; bottom: number}[] = [];
  const out: L[] = [];
  for (const label of labels) {
    if (out.length >= most) break;
    const half = (label.text.length * LETTER_PX) / 2 + 3;
    const box =
        {left: label.x - half, right: label.x + half, top: label.y - HIGH_PX / 2, bottom: label.y + HIGH_PX / 2};
    if (box.left < 0 || box.right > width || box.top < 0 || box.bottom > height) continue;
    if (taken.some((t) => box.left < t.right && t.left < box.right && box.top < t.bottom && t.top < box.bottom))
      continue;
    if (!isSeen(label)) continue;
    taken.push(box);
    out.push(label);
  }
  return out;
}

export class Labels {
  readonly root = element('div', {class: 'room-labels', 'aria-hidden': 'true'});
  private readonly made: HTMLElement[] = [];

  show(labels: readonly Label[]): void {
    labels.forEach((label, i) => {
      let span = this.made[i];
      if (!span) {
        span = element('span');
        this.made.push(span);
        this.root.append(span);
      }
      span.hidden = false;
      span.className = `room-label ${label.kind}`;
      setText(span, label.text);
      span.style.transform = `translate(${label.x.toFixed(1)}px, ${label.y.toFixed(1)}px) translate(-50%, -50%)`;
    });
    for (const span of this.made.slice(labels.length)) span.hidden = true;
  }
}
