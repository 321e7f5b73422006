/** What a person types as the reading of a luxmeter. */

/** Direct sun is half of it; more is a slip, and the daemon refuses it. */
const MOST_LUX = 200_000;

export type Reading = {
  lux: number
}|{wrong: string};

/** "182", "182.5", "182,5", with or without lx. A comma before three digits may mean thousands: it is asked back. */
export function readingOf(typed: string): Reading {
  const text = typed.trim().replace(/\s*(lx|lux)$/i, '').trim();
  if (!text) return {wrong: 'Type what the meter shows.'};
  if (/^[1-9]\d{0,2},\d{3}$/.test(text))
    return {wrong: `Write ${text.replace(',', '')} or ${text.replace(',', '.')}: the comma can mean either.`};
  if (!/^(\d+([.,]\d*)?|[.,]\d+)$/.test(text)) return {wrong: 'That is no number of lux. Write it as 182 or 182.5.'};
  const lux = Number(text.replace(',', '.'));
  return lux <= MOST_LUX ? {lux} : {wrong: `More than ${MOST_LUX} lx is no light on this earth.`};
}
