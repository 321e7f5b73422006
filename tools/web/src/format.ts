/** Numbers to text, the same everywhere. What is not known is an en dash, never a zero. */

export const UNKNOWN = '–';
const MINUS = '\u2212';

/** What the rig does, for a person; a phase that is not known here as the daemon calls it. */
const PHASES: Record<string, string> = {
  idle: 'waiting',
  moving: 'heads turn',
  fading: 'fading',
  settling: 'letting the lamps settle',
  measuring: 'measuring',
  correcting: 'correcting',
  holding: 'holding',
  frozen: 'light held',
  safe_fading: 'fading to the safe look',
  safe: 'safe look',
};
export const phase = (name: string): string => PHASES[name] ?? name.replace(/[_-]/g, ' ');

const LIVES: Record<string, string> = { active: 'works', configured: 'starting', faulted: 'failed' };
export const life = (name: string): string => LIVES[name] ?? (name || 'not known');

const signed = (text: string): string => text.replace('-', MINUS);

/** Three significant digits, but no false ones: 0.42, 9.31, 48.2, 312, 10 400. */
export function lux(value: number | undefined): string {
  if (value === undefined) return UNKNOWN;
  const size = Math.abs(value);
  const digits = size >= 99.95 ? 0 : size >= 9.995 ? 1 : 2;
  return signed(value.toFixed(digits)).replace(/\B(?=(\d{3})+(?!\d))/g, size >= 9999.5 ? '\u202f' : '');
}

/** "148 ± 1.2": the error with two significant digits, the value no finer than that. */
export function withError(value: number | undefined, standardError: number | undefined): string {
  if (value === undefined) return UNKNOWN;
  if (standardError === undefined) return lux(value);
  if (standardError <= 0) return `${lux(value)} ± 0`;
  const decimals = Math.min(3, Math.max(0, 1 - Math.floor(Math.log10(standardError))));
  return `${signed(value.toFixed(decimals))} ± ${standardError.toFixed(decimals)}`;
}

/** "92 ± 4 %": what a lamp gives of its rated light. */
export function gives(gain: number | undefined, standardError: number | undefined): string {
  if (gain === undefined) return UNKNOWN;
  const error = standardError === undefined ? '' : ` ± ${Math.max(standardError * 100, 0.5).toFixed(0)}`;
  return `${signed((gain * 100).toFixed(0))}${error} %`;
}

export function percent(fraction: number | undefined, digits = 0): string {
  return fraction === undefined ? UNKNOWN : `${signed((fraction * 100).toFixed(digits))} %`;
}

/** "+1.2 %", "−0.7 %", "0.0 %" (never a signed zero). */
export function signedPercent(fraction: number | undefined): string {
  if (fraction === undefined) return UNKNOWN;
  const text = (fraction * 100).toFixed(1);
  if (Number(text) === 0) return '0.0 %';
  return `${fraction > 0 ? '+' : ''}${signed(text)} %`;
}

/** Age or duration: "0.3 s", "12 s", "4 min 5 s", "2 h 3 min", "3 d 4 h". */
export function age(seconds: number | undefined): string {
  if (seconds === undefined) return UNKNOWN;
  const s = Math.max(0, seconds);
  if (s < 9.95) return `${s.toFixed(1)} s`;
  const whole = Math.round(s);
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  if (whole < 86400) return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
  return `${Math.floor(whole / 86400)} d ${Math.floor((whole % 86400) / 3600)} h`;
}

/** Lateness of the output: "40 µs", "2.3 ms". */
export function micros(us: number | undefined): string {
  if (us === undefined) return UNKNOWN;
  return us < 1000 ? `${Math.round(us)} µs` : `${(us / 1000).toFixed(us < 10000 ? 1 : 0)} ms`;
}

export function count(value: number | undefined): string {
  return value === undefined ? UNKNOWN : Math.round(value).toString().replace(/\B(?=(\d{3})+(?!\d))/g, '\u202f');
}
