/** Light that standards name, as a start. */

export interface LuxPreset {
  lux: number;
  words: string;
}

/** Maintained illuminance of tasks (EN 12464-1, "Lighting of work places"). */
const WORK: LuxPreset[] = [
  {lux: 100, words: 'corridor, stairs'},
  {lux: 200, words: 'archive, bookshelves'},
  {lux: 300, words: 'reception desk, copying'},
  {lux: 500, words: 'reading, writing, meeting'},
  {lux: 750, words: 'technical drawing'},
];

/** The most that an exhibit should get, by its sensitivity to light (CIE 157:2004, "Control of damage to museum objects
 *  by optical radiation"). */
const MUSEUM: LuxPreset[] = [
  {lux: 50, words: 'high or medium sensitivity: watercolour, textile, print'},
  {lux: 200, words: 'low sensitivity: oil painting, bone, undyed leather'},
];

export const PRESETS: {source: string; presets: LuxPreset[]}[] = [
  {source: 'EN 12464-1, tasks', presets: WORK},
  {source: 'CIE 157, at most for exhibits of', presets: MUSEUM},
];
