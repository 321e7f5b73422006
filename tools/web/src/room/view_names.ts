/** Ways to look at the room; here so that naming them does not fetch three. */
export const VIEW_NAMES = {
  orbit: 'Around',
  walk: 'Walk',
  above: 'From above',
  side: 'From a side'
} as const;
export type View = keyof typeof VIEW_NAMES;
