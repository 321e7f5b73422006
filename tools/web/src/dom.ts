/** Making and changing elements. Text goes in as text, never as markup: names come from files. */

type Child = Node | string;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number> = {},
  ...children: Node[]
): SVGElementTagNameMap[K] {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

/** Changes nothing when nothing changed: five updates a second must not disturb a selection or a screen reader. */
export function setText(node: Node, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

export function setAttribute(node: Element, name: string, value: string | number): void {
  const text = String(value);
  if (node.getAttribute(name) !== text) node.setAttribute(name, text);
}

/** A titled card. */
export function card(id: string, title: string, ...children: Child[]): HTMLElement {
  return element(
    'section',
    { class: 'card', id, 'aria-labelledby': `${id}-title` },
    element('h2', { id: `${id}-title` }, title),
    ...children,
  );
}

/** A window in which long lists begin folded up. */
export const narrow = window.matchMedia('(max-width: 1080px)');

/** A titled card that folds up: open in a wide window, closed in a narrow one until it is asked for. `count` tells how
 *  much is in it while it is closed. */
export function foldingCard(id: string, title: string, count: Node, ...children: Child[]): HTMLElement {
  const made = element(
    'details',
    { class: 'card', id },
    element('summary', {}, element('h2', {}, title), element('span', { class: 'in-it' }, count)),
    ...children,
  );
  const fit = (): void => void (made.open = !narrow.matches);
  narrow.addEventListener('change', fit);
  fit();
  return made;
}

/** Keeps `parent`'s children in step with `items`, one each, made once and updated after. */
export class Rows<T, E extends Element> {
  private readonly made: E[] = [];
  constructor(
    private readonly parent: Element,
    private readonly make: (index: number) => E,
    private readonly update: (row: E, item: T, index: number) => void,
  ) {}
  show(items: readonly T[]): void {
    while (this.made.length > items.length) this.made.pop()?.remove();
    items.forEach((item, index) => {
      let row = this.made[index];
      if (!row) {
        row = this.make(index);
        this.made.push(row);
        this.parent.append(row);
      }
      this.update(row, item, index);
    });
  }
}
