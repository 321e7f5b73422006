/** Who this browser is to the daemon: the form to log in, who is logged in, and who changed what. */

import {fetchChanges, fetchSession, postLogin, postLogout, type Change, type Session} from '../api';
import {Rows, element, foldingCard, setText} from '../dom';
import type {Line} from '../live';
import {permit, permitNothing} from '../roles';

const SHOWN = 10;
const CHANGES_EVERY_MS = 5000;

export class AccessView {
  readonly root: HTMLElement;  // the form, above the rig
  readonly log: HTMLElement;   // who is here, and the newest changes
  private readonly name =
      element('input', {id: 'login-name', autocomplete: 'username', required: '', autocapitalize: 'none'});
  private readonly password =
      element('input', {id: 'login-password', type: 'password', autocomplete: 'current-password', required: ''});
  private readonly wrong = element('p', {id: 'login-wrong', class: 'login-wrong', role: 'alert'});
  private readonly button = element('button', {type: 'submit'}, 'Log in');
  private readonly who = element('p', {id: 'who'});
  private readonly problem = element('p', {class: 'login-wrong'});
  private readonly leave = element('button', {type: 'button', id: 'logout', hidden: ''}, 'Log out');
  private readonly count = element('span');
  private readonly none = element('p', {class: 'nothing'}, 'Nothing was changed yet.');
  private readonly rows: Rows<Change, HTMLElement>;
  private unknown = false;
  private asking = false;

  constructor() {
    const form = element('form', {class: 'login-form'}, element('label', { for: 'login-name'
                         }, 'Name'), this.name, element('label', { for: 'login-password'
                         }, 'Password'), this.password, this.button);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.logIn();
    });
    this.root = element(
        'section', {class: 'card login', id: 'login', 'aria-labelledby': 'login-title', hidden: ''},
        element('h2', {id: 'login-title'}, 'Log in'), form, this.wrong);
    const list = element('ul', {class: 'changes'});
    this.rows = new Rows<Change, HTMLElement>(
        list,
        () => element(
            'li', {}, element('span', {class: 'change-at'}), element('span', {class: 'name'}),
            element('span', {class: 'change-what'})),
        (row, change) => {
          const [at, who, what] = [...row.children] as HTMLElement[];
          setText(at!, change.at);
          setText(who!, change.from && change.from !== 'socket' ? `${change.who} (${change.from})` : change.who);
          setText(what!, change.what);
        },
    );
    this.leave.addEventListener('click', () => void this.logOut());
    this.log =
        foldingCard('changes', 'Who changed what', this.count, this.who, this.leave, this.problem, list, this.none);
    this.log.hidden = true;
    void this.look();
    setInterval(() => void this.showChanges(), CHANGES_EVERY_MS);
  }

  showLine(line: Line): void {
    const unknown = line.state === 'unknown';
    if (unknown !== this.unknown) void this.look();
    this.unknown = unknown;
  }

  private async look(): Promise<void> {
    const session = await fetchSession();
    if (!session) return;  // the line is down
    this.show(session);
    if (session.open) await this.showChanges();
  }

  private show(session: Session): void {
    this.root.hidden = session.open || !session.login;
    document.body.classList.toggle('must-log-in', !this.root.hidden);
    setText(this.who, session.open ? `You are ${session.name}, and may ${session.role}.` : '');
    setText(this.problem, session.problem);
    this.leave.hidden = !session.open || !session.login;
    if (session.login || session.problem) this.log.hidden = false;  // else once there is a change to tell
    if (session.open)
      permit(session.role, session.name);
    else if (session.login)
      permitNothing();
  }

  private async showChanges(): Promise<void> {
    if (this.asking || this.unknown) return;
    this.asking = true;
    const changes = await fetchChanges().catch(() => undefined);
    this.asking = false;
    if (!changes) return;
    this.rows.show(changes.slice(-SHOWN).reverse());
    this.none.hidden = changes.length > 0;
    if (changes.length) this.log.hidden = false;
    setText(this.count, changes.length ? `last: ${changes[changes.length - 1]!.who}` : 'nothing yet');
  }

  private async logIn(): Promise<void> {
    this.button.disabled = true;
    setText(this.wrong, '');
    try {
      await postLogin(this.name.value, this.password.value);
      await this.look();
    } catch (error) {
      setText(this.wrong, `Not logged in: ${error instanceof Error ? error.message : 'unknown cause'}.`);
    }
    this.password.value = '';
    this.button.disabled = false;
  }

  private async logOut(): Promise<void> {
    await postLogout().catch(() => undefined);
    await this.look();
  }
}
