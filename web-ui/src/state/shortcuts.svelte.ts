/** Keys that act on the whole page; the user can switch them off, except that of STOP. */

import { stop } from "./actions.svelte";
import { PAGES, hashOf, route } from "./route.svelte";
import { theme } from "./theme.svelte";
import { viewer } from "./viewer.svelte";

const KEPT = "passo-shortcuts";

/** The keys of the list, with the name of what each does. */
export const KEYS = [
  { keys: ["Ctrl", "Shift", "E"], does: "stop" },
  { keys: ["?"], does: "list" },
  { keys: ["1", "…", String(PAGES.length)], does: "pages" },
  { keys: ["c"], does: "console" },
  { keys: ["d"], does: "theme" },
  { keys: ["[", "]"], does: "layer" },
  { keys: [",", "."], does: "move" },
] as const;

class Shortcuts {
  on = $state(true);
  /** The list is open. */
  listed = $state(false);

  constructor() {
    this.on = localStorage.getItem(KEPT) !== "off";
  }

  switch(on: boolean): void {
    this.on = on;
    localStorage.setItem(KEPT, on ? "on" : "off");
  }

  /** What a key does, where no field has it and no dialog is open; STOP acts everywhere. */
  take(event: KeyboardEvent): void {
    if (event.ctrlKey && event.shiftKey && event.key.toLowerCase() === "e") {
      event.preventDefault();
      if (!event.repeat) void stop();
      return;
    }
    if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
    const target = event.target instanceof Element ? event.target : null;
    if (target?.closest("input, select, textarea, dialog, [contenteditable]")) return;
    if (event.key === "?") this.listed = true; // also while the others are off: to switch them on
    else if (!this.on || !this.#act(event.key)) return;
    event.preventDefault();
  }

  #act(key: string): boolean {
    const page = PAGES[Number(key) - 1];
    if (page) {
      location.hash = hashOf(page);
      return true;
    }
    switch (key) {
      case "c":
        document.querySelector<HTMLElement>("[role=combobox]")?.focus();
        return true;
      case "d":
        theme.toggle();
        return true;
      case "[":
      case "]":
        return this.#inViewer(() => viewer.toLayer(Math.max(0, viewer.layer + (key === "]" ? 1 : -1))));
      case ",":
      case ".":
        return this.#inViewer(() => viewer.step(key === "." ? 1 : -1));
      default:
        return false;
    }
  }

  #inViewer(act: () => void): boolean {
    if (route.page !== "viewer") return false;
    viewer.follow = false;
    act();
    return true;
  }
}

export const shortcuts = new Shortcuts();
