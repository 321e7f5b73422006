/** The rig in five figures. */

import type { Status } from '../api';
import { element, setAttribute, setText } from '../dom';
import { UNKNOWN, percent, signedPercent } from '../format';
import { summarise } from '../judge';

export class TilesView {
  readonly root = element('section', { class: 'tiles', id: 'tiles', 'aria-label': 'Summary' });
  private readonly goals = this.tile('goals met');
  private readonly limits = this.tile('limits kept');
  private readonly worst = this.tile('largest error');
  private readonly rounds = this.tile('corrections');
  private readonly output = this.tile('mean level');

  private tile(title: string): { box: HTMLElement; value: HTMLElement; note: HTMLElement } {
    const value = element('strong');
    const note = element('small');
    const box = element('div', { class: 'tile' }, element('span', {}, title), value, note);
    this.root.append(box);
    return { box, value, note };
  }

  show(status: Status): void {
    const sum = summarise(status);
    setText(this.goals.value, sum.goals ? `${sum.goalsMet} of ${sum.goals}` : UNKNOWN);
    const not_met = [sum.goalsMissed ? `${sum.goalsMissed} missed` : '', sum.goalsUnknown ? `${sum.goalsUnknown} not known` : ''];
    setText(this.goals.note, sum.goals === 0 ? 'no goals' : sum.goals === sum.goalsMet ? 'all' : not_met.filter(Boolean).join(', '));
    setAttribute(this.goals.box, 'data-tone', sum.goals === 0 ? '' : sum.goalsMissed ? 'watch' : sum.goals === sum.goalsMet ? 'good' : '');
    setText(this.limits.value, sum.limits ? `${sum.limitsKept} of ${sum.limits}` : UNKNOWN);
    const not_kept = [sum.limitsExceeded ? `${sum.limitsExceeded} over the limit!` : '',
      sum.limits - sum.limitsKept - sum.limitsExceeded ? `${sum.limits - sum.limitsKept - sum.limitsExceeded} not known` : ''];
    setText(this.limits.note, sum.limits === sum.limitsKept ? 'conservation limits' : not_kept.filter(Boolean).join(', '));
    setAttribute(this.limits.box, 'data-tone', sum.limits === 0 ? '' : sum.limitsExceeded ? 'bad' : sum.limits === sum.limitsKept ? 'good' : 'watch');
    setText(this.worst.value, signedPercent(sum.worst?.error));
    setText(this.worst.note, sum.worst ? `${sum.worst.name}, ${sum.worst.measured ? 'measured' : 'computed'}` : '');
    setText(this.rounds.value, status.round === undefined ? UNKNOWN : `${status.round} of ${status.rounds ?? UNKNOWN}`);
    setText(this.rounds.note, status.converged ? 'another would bring nothing' : 'not done yet');
    setAttribute(this.rounds.box, 'data-tone', status.converged ? 'good' : '');
    const levels = status.fixtures.flatMap((f) => (f.level === undefined ? [] : [f.level]));
    setText(this.output.value, levels.length ? percent(levels.reduce((a, b) => a + b, 0) / levels.length) : UNKNOWN);
    setText(this.output.note, `${status.fixtures.length} fixtures`);
  }
}
