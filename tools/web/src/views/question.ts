/** What `luxrig calibrate --hand` asks of a person in the room: where to hold the luxmeter, and what it shows. */

import {postAnswer, type AnswerWhat, type Question} from '../api';
import {element, setAttribute, setText} from '../dom';
import * as format from '../format';
import {readingOf} from '../reading';
import {forRole} from '../roles';

const SURE_MS = 5000;

export class QuestionView {
  readonly root: HTMLElement;
  // Always on the page, so that a screen reader says what is new in it.
  private readonly said = element('p', {class: 'only-heard', role: 'status'});
  private readonly place = element('p', {class: 'question-place'});
  private readonly lit = element('p', {class: 'question-lit'});
  private readonly step = element('span', {class: 'question-step'});
  private readonly known = element('p', {class: 'question-known'});
  private readonly wrong = element('p', {id: 'question-wrong', class: 'question-wrong', role: 'alert'});
  private readonly lux = element('input', {
    id: 'question-lux',
    type: 'text',
    inputmode: 'decimal',
    enterkeyhint: 'send',
    autocomplete: 'off',
    'aria-describedby': 'question-wrong'
  });
  private readonly end = button('End', 'question-end');
  private readonly buttons: HTMLButtonElement[];
  private readonly card: HTMLElement;
  private asked: Question|undefined;
  private sent = false;                                   // what was pressed is on its way
  private sure: ReturnType<typeof setTimeout>|undefined;  // End was pressed once

  constructor() {
    const take = button('Take reading', 'question-take', 'submit');
    const skip = button('Skip this lamp');
    const other = button('Another place');
    this.buttons = [take, skip, other, this.end];
    const form = element(
        'form', {class: 'question-form'},
        element(
            'label',
            { for: 'question-lux'
            },
            'The meter shows'),
        element('span', {class: 'question-field'}, this.lux, element('span', {class: 'question-unit'}, 'lx')), take);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.take();
    });
    skip.addEventListener('click', () => void this.send('skip'));
    other.addEventListener('click', () => void this.send('other_place'));
    this.end.addEventListener('click', () => this.askEnd());
    this.lux.addEventListener('input', () => this.complain(''));
    this.card = element(
        'section', {class: 'card question', id: 'question', 'aria-labelledby': 'question-title', hidden: ''},
        element('h2', {id: 'question-title'}, 'Luxmeter in the hand', this.step), this.place, this.lit,
        forRole('operate', form, this.wrong, element('div', {class: 'question-more'}, skip, other, this.end)),
        this.known);
    this.root = element('div', {class: 'question-room'}, this.said, this.card);
  }

  show(question: Question|undefined): void {
    const before = this.asked;
    this.asked = question;
    this.card.hidden = question === undefined;
    if (!question) return this.say('');
    if (question.id !== before?.id) this.begin();
    const answered = question.answer !== undefined;
    if (answered) this.sent = false;
    setText(this.place, question.text);
    setText(this.lit, answered ? afterwards(question) : lamp(question));
    setText(
        this.step,
        question.step === undefined || question.steps === undefined ? '' :
                                                                      `${question.step} of ${question.steps} here`);
    setText(this.known, knownWords(question));
    // Not `disabled`: that would take the focus away from whoever is at it.
    this.card.classList.toggle('answered', answered || this.sent);
    for (const one of this.buttons) setAttribute(one, 'aria-disabled', String(answered || this.sent));
    this.lux.readOnly = answered || this.sent;
    // The place only where it is new.
    const moved = question.text !== before?.text;
    if (question.id !== before?.id || answered !== (before?.answer !== undefined))
      this.say(`${moved ? `${question.text} ` : ''}${this.lit.textContent ?? ''}`);
  }

  /** What was typed was of the lamp before. */
  private begin(): void {
    const lost = this.lux.value !== '' && !this.sent;
    this.lux.value = '';
    this.sent = false;
    this.forgetEnd();
    this.complain(
        lost ? 'The lamp before was answered elsewhere. What was typed here is gone: read the meter again.' : '');
  }

  private take(): void {
    if (this.waits()) return;
    const reading = readingOf(this.lux.value);
    if ('wrong' in reading) {
      this.complain(reading.wrong);
      this.lux.focus();
      return;
    }
    void this.send('reading', reading.lux);
  }

  /** It ends the measuring for good: a slip of the thumb shall not. */
  private askEnd(): void {
    if (this.waits()) return;
    if (this.sure !== undefined) return void this.send('end');
    setText(this.end, 'Press again to end');
    this.sure = setTimeout(() => this.forgetEnd(), SURE_MS);
    this.say('Press again to end.');
  }

  private forgetEnd(): void {
    clearTimeout(this.sure);
    this.sure = undefined;
    setText(this.end, 'End');
  }

  private waits(): boolean { return this.asked === undefined || this.asked.answer !== undefined || this.sent; }

  private async send(what: AnswerWhat, lux?: number): Promise<void> {
    const {asked} = this;
    if (!asked || this.waits()) return;
    this.sent = true;
    this.forgetEnd();
    this.complain('');
    this.show(asked);
    try {
      await postAnswer(asked.id, what, lux);
      if (this.asked?.id === asked.id) this.lux.value = '';
    } catch (error) {
      if (this.asked?.id !== asked.id) return;
      this.sent = false;
      this.complain(`Not taken: ${error instanceof Error ? error.message : 'unknown cause'}.`);
      this.show(this.asked);
    }
  }

  private complain(words: string): void {
    setText(this.wrong, words);
    setAttribute(this.lux, 'aria-invalid', String(words !== ''));
  }

  private say(words: string): void { setText(this.said, words); }
}

function button(words: string, id = '', type = 'button'): HTMLButtonElement {
  return element('button', {type, ...(id ? {id} : {})}, words);
}

function lamp(question: Question): string {
  return question.fixture ? `Lit now: ${question.fixture} alone, at ${format.percent(question.level)}.` :
                            'Every lamp is dark now.';
}

/** What follows an answer. */
function afterwards(question: Question): string {
  const last = question.step !== undefined && question.step === question.steps;
  const next =
      last ? 'What follows from the readings is being computed.' : 'The next lamp is being lit. Keep the meter there.';
  switch (question.answer?.what) {
    case 'reading':
      return `Taken: ${question.answer.lux === undefined ? format.UNKNOWN : String(question.answer.lux)} lx. ${next}`;
    case 'skip':
      return `Skipped. ${next}`;
    case 'other_place':
      return 'Another place is being looked for.';
    default:
      return 'Ended. What follows from the readings is being written.';
  }
}

function knownWords(question: Question): string {
  const readings = question.readings ?? 0;
  const taken = readings === 0 ? 'no reading yet' : `${readings} reading${readings === 1 ? '' : 's'}`;
  if (question.known_to === undefined) return `So far: ${taken}.`;
  const worst =
      question.known_to_worst === undefined ? '' : `, at the worst to ${format.percent(question.known_to_worst, 1)}`;
  return `The light at the goals is known to ${format.percent(question.known_to, 1)} so far${worst}; ${taken}.`;
}
