/** What the person at this browser may do. The daemon decides; the page only does not offer what it would refuse. */

import {element, setText} from './dom';
import {ROLES, type Role} from './role';

interface Gate {
  needs: Role;
  show(may: boolean, why: string): void;
}
const gates: Gate[] = [];
// Until the daemon has said it, nothing is held back. null: nobody has logged in.
let present: {role: Role; name: string}|null|undefined;

function tell(gate: Gate): void {
  if (present === null) return gate.show(false, 'Log in first.');
  const may = !present || ROLES.indexOf(present.role) >= ROLES.indexOf(gate.needs);
  gate.show(may, may ? '' : `${present!.name} may ${present!.role}; this is for those who may ${gate.needs}.`);
}

export function permit(role: Role, name: string): void {
  if (present?.role === role && present.name === name) return;
  present = {role, name};
  gates.forEach(tell);
}

/** Nobody has logged in. */
export function permitNothing(): void {
  present = null;
  gates.forEach(tell);
}

/** Told now and whenever that changes. */
export function onPermission(needs: Role, show: (may: boolean, why: string) => void): void {
  const gate = {needs, show};
  gates.push(gate);
  tell(gate);
}

/** Controls that need a role: without it they are shown, disabled, and the reason beside them. */
export function forRole(needs: Role, ...controls: Node[]): HTMLElement {
  const reason = element('p', {class: 'role-reason', hidden: ''});
  const all = element('fieldset', {class: 'for-role'}, reason, ...controls);
  onPermission(needs, (may, why) => {
    all.disabled = !may;
    reason.hidden = may;
    setText(reason, why);
  });
  return all;
}
