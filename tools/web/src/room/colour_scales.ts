/** Colours of the lux layers. */

/** viridis (N. Smith and S. van der Walt, 2015, CC0; the 256 colours of matplotlib), at 17 even steps; linear between
 *  them it is at most 6 of 255 off. Its lightness only rises, so it reads without colour vision and in grey. */
export const VIRIDIS = [
  '#440154',
  '#48186a',
  '#472d7b',
  '#424086',
  '#3b528b',
  '#33638d',
  '#2c728e',
  '#26828e',
  '#21918c',
  '#1f9f88',
  '#27ad81',
  '#3dbc74',
  '#5cc863',
  '#81d34d',
  '#aadc32',
  '#d5e21a',
  '#fde725',
] as const;

/** PuOr (C. Brewer, ColorBrewer 2.0, 11 classes), turned: purple is too dark, orange too bright. Told apart by people
 *  who see no red or no green; in grey the markers' shapes say which side it is. */
export const PURPLE_ORANGE = [
  '#2d004b',
  '#542788',
  '#8073ac',
  '#b2abd2',
  '#d8daeb',
  '#f7f7f7',
  '#fee0b6',
  '#fdb863',
  '#e08214',
  '#b35806',
  '#7f3b08',
] as const;

export type Rgb = readonly[number, number, number];  // sRGB, 0…1

const parsed = new Map<readonly string[], Rgb[]>();

/** share: 0…1 along the scale; beyond it, its end. */
export function colourAt(scale: readonly string[], share: number): Rgb {
  let colours = parsed.get(scale);
  if (!colours) {
    colours = scale.map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255) as unknown as Rgb);
    parsed.set(scale, colours);
  }
  const place = Math.min(1, Math.max(0, share)) * (colours.length - 1);
  const first = Math.min(colours.length - 2, Math.floor(place));
  const [a, b] = [colours[first]!, colours[first + 1]!];
  const t = place - first;
  return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])];
}

export const css = (rgb: Rgb): string => `rgb(${rgb.map((v) => Math.round(v * 255)).join(' ')})`;
