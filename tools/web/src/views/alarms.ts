/** What is wrong, above everything else. One live region for alarms, one for a lost connection. */

import type { Alarm } from '../api';
import { Rows, element, setAttribute, setText } from '../dom';
import { age } from '../format';
import type { Line } from '../live';

export class AlarmsView {
  readonly root: HTMLElement;
  private readonly lost = element('div', { id: 'lost', class: 'alarm severe', role: 'alert', hidden: '' });
  private readonly lostText = element('strong');
  private readonly lostMend = element('span');
  private readonly lostAge = element('span', { class: 'alarm-age', 'aria-hidden': 'true' });
  private readonly rows: Rows<Alarm, HTMLElement>;

  constructor() {
    const list = element('div', { id: 'alarms', role: 'alert' });
    this.lost.append(sign(true), element('div', { class: 'alarm-text' }, this.lostText, this.lostMend), this.lostAge);
    this.rows = new Rows<Alarm, HTMLElement>(
      list,
      () =>
        element('div', { class: 'alarm' }, sign(false), element('div', { class: 'alarm-text' }, element('strong'), element('span')),
          element('span', { class: 'alarm-age', 'aria-hidden': 'true' })),
      (row, alarm) => {
        row.classList.toggle('severe', alarm.severe);
        const [mark, text, since] = [row.children[0]!, row.children[1]!, row.children[2]!];
        setAttribute(mark, 'aria-label', alarm.severe ? 'alarm' : 'warning');
        setText(text.children[0]!, alarm.device || (alarm.severe ? 'Alarm' : 'Warning'));
        setText(text.children[1]!, alarm.text);
        // Hidden from screen readers: a ticking age would be read out again and again.
        setText(since, alarm.since_s === undefined ? '' : `for ${age(alarm.since_s)}`);
      },
    );
    this.root = element('div', { class: 'alarms' }, this.lost, list);
  }

  show(alarms: readonly Alarm[]): void {
    this.rows.show([...alarms].sort((a, b) => Number(b.severe) - Number(a.severe)));
  }

  showLine(line: Line): void {
    this.lost.hidden = line.state !== 'lost' && line.state !== 'unknown';
    if (this.lost.hidden) return;
    setText(this.lostText, line.state === 'lost' ? 'Connection lost' : 'The daemon does not know this browser');
    setText(this.lostMend, line.state === 'lost'
      ? 'What the page shows is old and may be wrong. The rig goes on by itself; this page tries again all the time.'
      : 'Type luxrig page in a terminal of the rig’s computer, and open the address that it prints.');
    setText(this.lostAge, line.ageS === undefined ? 'no update yet' : `last update ${age(Math.max(0, line.ageS))} ago`);
  }
}

function sign(severe: boolean): HTMLElement {
  return element('span', { class: 'alarm-sign', role: 'img', 'aria-label': severe ? 'alarm' : 'warning' }, '!');
}
