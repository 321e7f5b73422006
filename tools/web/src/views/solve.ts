/** Solving from the page: how far it is, what the plan would change, and putting it in force. */

import type {Fields, Status} from '../api';
import {Rows, card, element, narrow, setAttribute, setText} from '../dom';
import * as format from '../format';
import * as plans from '../plans';

const ASK_MS = 700;
const LOOK_MS = 10_000;  // for jobs that other clients start
const REMEMBERED = 'luxrig-job';
const FADES: readonly(readonly[string, string])[] =
    [['', 'as the rig fades'], ['1', '1 s'], ['5', '5 s'], ['20', '20 s'], ['60', '1 min'], ['300', '5 min']];
const WORDS: Record<string, string> = {
  met: 'met',
  missed: 'missed',
  unknown: 'not known'
};

const words = (error: unknown): string => (error instanceof Error ? error.message : String(error));
const watts = (value: number|undefined): string => value === undefined ? 'power not known' : `${value.toFixed(0)} W`;
const said = (count: {met: number; missed: number; unknown: number}): string => {
  const goals = count.met + count.missed + count.unknown;
  const rest = [count.missed ? `${count.missed} missed` : '', count.unknown ? `${count.unknown} not known` : ''];
  return [`${count.met} of ${goals} goals met`, ...rest].filter(Boolean).join(', ');
};

export class SolveView {
  readonly root: HTMLElement;
  private readonly start = button('solve-start', 'Solve');
  private readonly cancel = button('solve-cancel', 'Cancel');
  private readonly apply = button('solve-apply', 'Apply');
  private readonly back = button('solve-back', 'Back to the plan before');
  private readonly fade =
      element('select', {id: 'solve-fade'}, ...FADES.map(([value, text]) => element('option', {value}, text)));
  private readonly state = element('p', {class: 'solve-state', role: 'status'});
  private readonly bar = element('progress', {class: 'solve-bar', 'aria-label': 'the solve', hidden: ''});
  private readonly answer = element('p', {class: 'solve-answer', role: 'status'});
  private readonly result = element('div', {class: 'solve-result', hidden: ''});
  private readonly sums = element('dl', {class: 'solve-sums'});
  private readonly points: Rows<plans.PointDifference, HTMLElement>;
  private readonly lights: Rows<plans.LightDifference, HTMLElement>;
  private readonly pointsTitle = element('summary', {});
  private readonly lightsTitle = element('summary', {});
  private job: plans.Job|undefined;
  private watched: string|undefined;  // id of the job that is asked for
  private plan: Fields|undefined;
  private before: Fields|undefined;  // in force when ours was applied
  private applied = false;
  private watts: ReadonlyMap<string, number> = new Map();
  private status: Status|undefined;
  private asking = false;
  private looking: ReturnType<typeof setTimeout>|undefined;

  constructor() {
    const points = element('ul', {class: 'solve-points', 'aria-label': 'Goals: now, and by the new plan'});
    this.points = new Rows<plans.PointDifference, HTMLElement>(
        points,
        () => element(
            'li', {}, element('span', {class: 'name'}), element('span', {class: 'goal'}),
            element('span', {class: 'now'}), element('span', {class: 'new'}), element('span', {class: 'why'})),
        (row, one) => this.showPoint(row, one));
    const lights = element('ul', {class: 'solve-lights', 'aria-label': 'Levels: now, and by the new plan'});
    this.lights = new Rows<plans.LightDifference, HTMLElement>(
        lights, () => element('li', {}, element('span', {class: 'name'}), element('span', {class: 'change'})),
        (row, one) => {
          const [name, change] = [...row.children] as HTMLElement[];
          setText(name!, one.name);
          setText(
              change!,
              `${format.percent(one.before, 1)} → ${format.percent(one.after, 1)}${one.turns ? ', turns' : ''}`);
        });
    this.result.append(
        this.sums,
        element(
            'div', {class: 'solve-apply'},
            element(
                'label',
                {for: 'solve-fade'
                },
                'fade'),
            this.fade, this.apply, this.back),
        element('details', narrow.matches ? {} : {open: ''}, this.pointsTitle, points),
        element('details', {}, this.lightsTitle, lights));
    this.start.addEventListener('click', () => void this.begin());
    this.cancel.addEventListener(
        'click', () => this.job && void plans.cancelJob(this.job.id).catch((e) => this.say(words(e))));
    this.apply.addEventListener('click', () => void this.putInForce(this.plan, 'The new plan'));
    this.back.addEventListener('click', () => void this.putInForce(this.before, 'The plan before'));
    this.root = card(
        'solve', 'Solve', element('div', {class: 'solve-do'}, this.state, this.start, this.cancel), this.bar,
        this.answer, this.result);
    try {
      this.watched = sessionStorage.getItem(REMEMBERED) ?? undefined;
    } catch {
      // Storage is closed to us: a job is forgotten with the page.
    }
    this.showJob();
    void this.look();
  }

  show(status: Status): void {
    this.status = status;
    // What is to be compared stays as it was until it is applied; then readings come in beside it.
    if (!this.result.hidden && this.plan && this.applied) this.compare();
  }

  private watch(id: string|undefined): void {
    this.watched = id;
    try {
      if (id)
        sessionStorage.setItem(REMEMBERED, id);
      else
        sessionStorage.removeItem(REMEMBERED);
    } catch {
      // as above
    }
  }

  private async begin(): Promise<void> {
    setAttribute(this.start, 'disabled', '');
    this.say('');
    try {
      const id = await plans.startSolve();
      this.watch(id);
      this.result.hidden = true;
      this.plan = undefined;
      this.job = {id, state: 'runs', stage: '', doing: '', why: '', can_be_taken: false};
      this.showJob();
      await this.look();
    } catch (error) {
      this.say(`Not started: ${words(error)}.`);
    } finally {
      this.start.removeAttribute('disabled');
    }
  }

  /** Asks for ever: often while a job runs, else now and then, as another client may start one. */
  private async look(): Promise<void> {
    await this.ask().catch(() => undefined);  // the line is down, and the page says so
    const active = this.watched !== undefined && !(this.job && plans.isEnded(this.job));
    clearTimeout(this.looking);
    this.looking = setTimeout(() => void this.look(), active ? ASK_MS : LOOK_MS);
  }

  private async ask(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    try {
      if (!this.watched || (this.job && plans.isEnded(this.job))) {
        const other = await plans.runningJob();
        if (!other) return;
        this.watch(other.id);
        this.result.hidden = true;
      }
      const job = await plans.fetchJob(this.watched!);
      if (!job) return;
      if (job === 'gone') {
        this.job = undefined;
        this.watch(undefined);
        return this.showJob();
      }
      const news = this.job?.id !== job.id || this.job.state !== job.state;
      this.job = job;
      this.showJob();
      if (news && job.plan) await this.take(job.plan);
    } finally {
      this.asking = false;
    }
  }

  private async take(plan: Fields): Promise<void> {
    this.plan = plan;
    this.applied = false;
    this.before = undefined;
    this.compare();
    this.result.hidden = false;
    this.watts = await plans.fetchWatts();
    if (this.plan === plan) this.compare();
  }

  private showJob(): void {
    const {job} = this;
    const active = job !== undefined && !plans.isEnded(job);
    const about = [job?.stage, job?.doing].filter(Boolean).join(': ');
    const texts: Record<plans.Job['state'], string> = {
      waits: 'It waits until the job before it has ended.',
      runs: about ? `Solving. ${about}` : 'Solving …',
      done: 'A plan is found. Nothing changes until it is applied.',
      failed: `No plan: ${job?.why || 'the cause is not known'}.`,
      cancelled: job?.plan ? 'Cancelled: this is the best so far.' : 'Cancelled. There was no plan yet.',
      lost: 'The daemon was started again, and this job is lost. Solve again.',
    };
    setText(this.state, job ? texts[job.state] : 'Finds a plan for the goals of this rig.');
    setAttribute(this.root, 'data-state', job?.state ?? 'none');
    this.bar.hidden = !active;
    this.start.hidden = active;
    this.cancel.hidden = !active;
    setText(this.cancel, job?.can_be_taken ? 'Stop, and take the best so far' : 'Cancel');
  }

  private compare(): void {
    if (!this.status || !this.plan) return;
    const difference = plans.differenceOf(this.status, this.plan, this.watts);
    const now = this.applied ? 'Now' : 'In force';
    const rows = [
      [now, `${said(difference.before)}; ${watts(difference.before.watts)}`],
      [this.applied ? 'The plan said' : 'New plan', `${said(difference.after)}; ${watts(difference.after.watts)}`],
    ];
    const texts = rows.flat();
    while (this.sums.children.length < texts.length)
      this.sums.append(element(this.sums.children.length % 2 ? 'dd' : 'dt'));
    texts.forEach((text, i) => setText(this.sums.children[i]!, text!));
    this.points.show(difference.points);
    this.lights.show(difference.lights);
    const changed = difference.lights.filter((l) => l.turns || Math.abs(l.after - (l.before ?? 0)) > 0.0005).length;
    const off = difference.after.missed + difference.after.unknown;
    setText(
        this.pointsTitle,
        `${difference.points.length} goals${off === 0 ? ', all met' : `, ${off} of them missed or not known: first`}`);
    setText(this.lightsTitle, `Levels of ${difference.lights.length} fixtures, ${changed} other than now`);
    this.back.hidden = !(this.applied && this.before);
  }

  private showPoint(row: HTMLElement, one: plans.PointDifference): void {
    const [name, goal, now, planned, why] = [...row.children] as HTMLElement[];
    const verdict = (word: string|undefined): string => (word ? `, ${WORDS[word] ?? word}` : '');
    setText(name!, one.name);
    setText(goal!, `goal ${format.lux(one.goal_lux)} lx`);
    setText(
        now!,
        `${
            this.applied            ? (one.before_measured ? 'measured' : 'now, by the model') :
                one.before_measured ? 'now, measured' :
                                      'now'} ${format.lux(one.before_lux)} lx${verdict(one.before_verdict)}`);
    setText(
        planned!,
        `${this.applied ? 'predicted' : 'new'} ${format.withError(one.after_lux, one.after_error_lux)} lx${
            verdict(one.after_verdict)}`);
    setAttribute(now!, 'data-verdict', one.before_verdict ?? 'none');
    setAttribute(planned!, 'data-verdict', one.after_verdict ?? 'none');
    setText(why!, one.reason);
  }

  private async putInForce(plan: Fields|undefined, which: string): Promise<void> {
    if (!plan) return;
    for (const one of [this.apply, this.back]) setAttribute(one, 'disabled', '');
    this.say('Applying. Heads that turn have their light worked out first …');
    try {
      const before = await plans.fetchPlan();
      const notes = await plans.applyPlan(plan, this.fade.value ? Number(this.fade.value) : undefined);
      this.before = before;
      this.plan = plan;
      this.applied = true;
      this.compare();
      this.say(`${which} is in force; readings come in below.${notes ? ` ${notes}` : ''}`);
    } catch (error) {
      this.say(`Not applied: ${words(error)}.`);
    } finally {
      for (const one of [this.apply, this.back]) one.removeAttribute('disabled');
    }
  }

  private say(text: string): void { setText(this.answer, text); }
}

function button(id: string, text: string): HTMLButtonElement { return element('button', {type: 'button', id}, text); }
