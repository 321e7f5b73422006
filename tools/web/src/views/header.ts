/** The top line: which rig, what it is doing, whether the line to it lives, and blackout. */

import { postBlackout, type Status } from '../api';
import { element, setAttribute, setText } from '../dom';
import { age, phase } from '../format';
import type { Line } from '../live';
import {onPermission} from '../roles';

const FAILURE_SHOWN_MS = 10_000;

export class HeaderView {
  readonly root: HTMLElement;
  readonly blackout: HTMLElement;
  private readonly rig = element('h1', {}, 'Luxrig');
  private readonly simulated = element('span', { class: 'badge', hidden: '' }, 'simulated');
  private readonly phaseName = element('span', { class: 'phase-name' });
  private readonly phaseDetail = element('span', { class: 'phase-detail' });
  private readonly phase = element('p', { id: 'phase', role: 'status' }, this.phaseName, this.phaseDetail);
  private readonly clock = element('span', { id: 'clock', title: 'since the daemon started' });
  private readonly lineText = element('span');
  private readonly line = element('p', { id: 'line' }, element('span', { class: 'line-dot', 'aria-hidden': 'true' }), this.lineText);
  private readonly button = element('button', { id: 'blackout', type: 'button', 'aria-pressed': 'false' });
  private readonly buttonTitle = element('span', { class: 'blackout-title' }, 'BLACKOUT');
  private readonly buttonState = element('span', { class: 'blackout-state' }, 'light is on');
  private readonly failure = element('p', { class: 'blackout-failure', role: 'alert' });
  private dark = false;
  private refused = '';  // why this person may not
  private fading: ReturnType<typeof setTimeout> | undefined;
  private asked: boolean | undefined; // sent, not yet seen in a status

  constructor(themeButton: HTMLElement) {
    this.button.append(this.buttonTitle, this.buttonState);
    this.button.addEventListener('click', () => void this.toggle());
    this.blackout = element('div', { class: 'blackout-place' }, this.button, this.failure);
    onPermission('operate', (may, why) => {
      this.button.disabled = !may;
      this.refused = why;
      this.showButton();
    });
    this.root = element(
      'header',
      { class: 'top' },
      element('div', { class: 'who' }, element('div', { class: 'rig' }, this.rig, this.simulated), this.phase),
      element('div', { class: 'lines' }, this.line, this.clock, themeButton),
      this.blackout,
    );
  }

  show(status: Status): void {
    setText(this.rig, status.rig || 'Luxrig');
    document.title = `${status.rig} · Luxrig`;
    this.simulated.hidden = !status.simulated;
    // In a blackout nothing is as it should be, whatever holds underneath: never the colour of "holding".
    setText(this.phaseName, status.blackout ? 'blackout' : phase(status.phase));
    const detail = status.blackout ? status.detail.replace(/^blackout \((.*)\)$/s, 'when it is lifted: $1') : status.detail;
    setText(this.phaseDetail, detail ? `: ${detail}` : '');
    setAttribute(this.phase, 'data-phase', status.blackout ? 'blackout' : status.phase);
    setText(this.clock, `up ${age(status.time_s)}`);
    this.dark = status.blackout;
    if (this.asked === status.blackout) this.asked = undefined;
    this.showButton();
  }

  showLine(line: Line): void {
    const words =
      line.state === 'live' ? 'live' : line.state === 'connecting' ? 'connecting' : line.state === 'unknown' ? 'not open' : 'connection lost';
    setText(this.lineText, words);
    setAttribute(this.line, 'data-state', line.state);
  }

  private showButton(): void {
    setAttribute(this.button, 'aria-pressed', String(this.dark));
    this.button.classList.toggle('waiting', this.asked !== undefined);
    setText(this.buttonTitle, this.dark ? 'BLACKOUT IS ON' : 'BLACKOUT');
    setText(
        this.buttonState,
        this.refused                 ? this.refused :
            this.asked !== undefined ? 'sent, waiting' :
            this.dark                ? 'press to bring the light back' :
                                       'all light off at once',
    );
  }

  private async toggle(): Promise<void> {
    // A second press while waiting turns the first round, as a person expects of a toggle.
    const on = !(this.asked ?? this.dark);
    this.asked = on;
    setText(this.failure, '');
    this.showButton();
    try {
      await postBlackout(on);
    } catch (error) {
      this.asked = undefined;
      setText(this.failure, `Blackout ${on ? 'on' : 'off'} not confirmed: ${error instanceof Error ? error.message : 'unknown cause'}.`);
      clearTimeout(this.fading);
      this.fading = setTimeout(() => setText(this.failure, ''), FAILURE_SHOWN_MS);
    }
    this.showButton();
  }
}
