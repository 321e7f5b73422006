/** Health of buses and meters: what is wrong first, each with the age of its last word. */

import type { Device, Luxmeter } from '../api';
import { Rows, element, foldingCard, setAttribute, setText } from '../dom';
import * as format from '../format';

const rank = (life: string): number => (life === 'faulted' ? 0 : life === 'active' ? 2 : 1);
const lifeBadge = (): HTMLElement => element('span', { class: 'life' });

function showLife(badge: Element, life: string): void {
  setText(badge, format.life(life));
  setAttribute(badge, 'data-life', life);
}

/** "sacn multicast", "conservation unit 21 register 2"; empty where nothing is known. */
const whereabouts = (...parts: string[]): string => parts.filter((part) => part !== '').join(' ');

export class DevicesView {
  readonly root: HTMLElement;
  private readonly count = element('span');
  private readonly rows: Rows<Device, HTMLElement>;

  constructor() {
    const list = element('ul', { class: 'devices' });
    this.rows = new Rows<Device, HTMLElement>(
      list,
      () => element('li', {}, lifeBadge(), element('span', { class: 'name' }), element('span', { class: 'heard' }),
        element('span', { class: 'detail' }), element('span', { class: 'counts' }), element('span', { class: 'for' }),
        element('span', { class: 'address' })),
      (row, device) => {
        const [life, name, heard, detail, counts, since, address] = [...row.children];
        showLife(life!, device.life);
        setText(name!, device.name);
        setText(heard!, device.last_ok_s === undefined ? 'no success yet' : `last success ${format.age(device.last_ok_s)} ago`);
        setText(detail!, device.detail);
        setText(counts!, [
          `${format.count(device.sent)} sent`,
          `${format.count(device.received)} received`,
          `${format.count(device.errors)} failed`,
        ].join(' · '));
        setText(address!, whereabouts(device.driver, device.address));
        setText(since!, device.since_s === undefined ? '' : `for ${format.age(device.since_s)}`);
      },
    );
    this.root = foldingCard('devices', 'Devices', this.count, list);
  }

  show(devices: readonly Device[]): void {
    const failed = devices.filter((d) => d.life === 'faulted').length;
    setText(this.count, failed ? `${failed} of ${devices.length} failed` : `${devices.length}`);
    this.rows.show([...devices].sort((a, b) => rank(a.life) - rank(b.life)));
  }
}

export class MetersView {
  readonly root: HTMLElement;
  private readonly count = element('span');
  private readonly rows: Rows<Luxmeter, HTMLElement>;

  constructor() {
    const list = element('ul', { class: 'meters' });
    this.rows = new Rows<Luxmeter, HTMLElement>(
      list,
      () => element('li', {}, lifeBadge(), element('span', { class: 'name' }), element('span', { class: 'where' }),
        element('span', { class: 'reading' }), element('span', { class: 'age' }), element('span', { class: 'address' })),
      (row, meter) => {
        const [life, name, where, reading, age, address] = [...row.children];
        showLife(life!, meter.life);
        setText(name!, meter.name);
        setText(where!, meter.point ? `at ${meter.point}` : '');
        setText(address!, whereabouts(meter.bus, meter.address));
        setText(reading!, meter.lux === undefined ? 'no reading'
          : `${format.lux(meter.lux)} lx${meter.tolerance === undefined ? '' : ` ± ${format.percent(meter.tolerance)}`}`);
        setText(age!, meter.lux === undefined ? '' : `${format.age(meter.age_s)} ago`);
      },
    );
    this.root = foldingCard('meters', 'Luxmeters', this.count, list);
  }

  show(meters: readonly Luxmeter[]): void {
    setText(this.count, String(meters.length));
    this.rows.show(meters);
  }
}
