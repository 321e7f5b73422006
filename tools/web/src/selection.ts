/** What the pointer is on, shared between the plan and the tables so that each shows the other's. */

export type Chosen = { kind: 'fixture' | 'point'; index: number } | undefined;

export class Selection {
  current: Chosen;
  private readonly listeners: (() => void)[] = [];
  set(chosen: Chosen): void {
    if (chosen?.kind === this.current?.kind && chosen?.index === this.current?.index) return;
    this.current = chosen;
    for (const listener of this.listeners) listener();
  }
  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }
}
