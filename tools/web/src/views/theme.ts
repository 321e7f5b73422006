/** Dark, light, or as the system says; remembered by the browser. */

import { element, setText } from '../dom';

const KEY = 'luxrig-theme';
const ORDER = ['system', 'dark', 'light'] as const;
type Theme = (typeof ORDER)[number];

export function themeButton(): HTMLElement {
  const button = element('button', { class: 'theme', type: 'button' });
  let theme: Theme = 'system';
  try {
    theme = ORDER.find((t) => t === localStorage.getItem(KEY)) ?? 'system';
  } catch {
    // Storage is closed to us: the choice lasts as long as the page.
  }
  const apply = (): void => {
    if (theme === 'system') delete document.documentElement.dataset['theme'];
    else document.documentElement.dataset['theme'] = theme;
    setText(button, `theme: ${theme}`);
  };
  button.addEventListener('click', () => {
    theme = ORDER[(ORDER.indexOf(theme) + 1) % ORDER.length]!;
    try {
      localStorage.setItem(KEY, theme);
    } catch {
      // as above
    }
    apply();
  });
  apply();
  return button;
}
