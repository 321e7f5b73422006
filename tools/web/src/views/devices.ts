/** Health of buses and meters: what is wrong first, each with the age of its last word. */

import type { Device, Luxmeter } from '../api';
import { Rows, card, element, setAttribute, setText } from '../dom';
import * as format from '../format';

const rank = (life: string): number => (life === 'faulted' ? 0 : life === 'active' ? 2 : 1);
const lifeBadge = (): HTMLElement => element('span', { class: 'life' });

function showLife(badge: Element, life: string): void {
  setText(badge, life || 'unknown');
  setAttribute(badge, 'data-life', life);
}

export class DevicesView {
  readonly root: HTMLElement;
  private readonly rows: Rows<Device, HTMLElement>;

  constructor() {
    const list = element('ul', { class: 'devices' });
    this.rows = new Rows<Device, HTMLElement>(
      list,
      () => element('li', {}, lifeBadge(), element('span', { class: 'name' }), element('span', { class: 'heard' }),
        element('span', { class: 'detail' }), element('span', { class: 'counts' }), element('span', { class: 'for' })),
      (row, device) => {
        const [life, name, heard, detail, counts, since] = [...row.children];
        showLife(life!, device.life);
        setText(name!, device.name);
        setText(heard!, device.last_ok_s === undefined ? 'never well yet' : `well ${format.age(device.last_ok_s)} ago`);
        setText(detail!, device.detail);
        setText(counts!, [
          `${format.count(device.sent)} sent`,
          `${format.count(device.received)} received`,
          `${format.count(device.errors)} errors`,
        ].join(' · '));
        setText(since!, device.since_s === undefined ? '' : `for ${format.age(device.since_s)}`);
      },
    );
    this.root = card('devices', 'Devices', list);
  }

  show(devices: readonly Device[]): void {
    this.rows.show([...devices].sort((a, b) => rank(a.life) - rank(b.life)));
  }
}

export class MetersView {
  readonly root: HTMLElement;
  private readonly rows: Rows<Luxmeter, HTMLElement>;

  constructor() {
    const list = element('ul', { class: 'meters' });
    this.rows = new Rows<Luxmeter, HTMLElement>(
      list,
      () => element('li', {}, lifeBadge(), element('span', { class: 'name' }), element('span', { class: 'where' }),
        element('span', { class: 'reading' }), element('span', { class: 'age' })),
      (row, meter) => {
        const [life, name, where, reading, age] = [...row.children];
        showLife(life!, meter.life);
        setText(name!, meter.name);
        setText(where!, meter.point ? `at ${meter.point}` : '');
        setText(reading!, meter.lux === undefined ? 'no reading'
          : `${format.lux(meter.lux)} lx${meter.tolerance === undefined ? '' : ` ± ${format.percent(meter.tolerance)}`}`);
        setText(age!, meter.lux === undefined ? '' : `${format.age(meter.age_s)} ago`);
      },
    );
    this.root = card('meters', 'Luxmeters', list);
  }

  show(meters: readonly Luxmeter[]): void {
    this.rows.show(meters);
  }
}
