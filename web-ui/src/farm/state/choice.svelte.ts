/** Which printers the user looks at and has selected. Filter and looks are kept in this browser. */

import { SvelteSet } from "svelte/reactivity";
import { farm } from "./farm.svelte";
import { chosen, type Group, type Order } from "./phase";

const KEPT = "passo-farm-look";
/** More printers than that are rows, unless the user has chosen. */
const MAX_CARDS = 24;
export const LOOKS = ["cards", "rows"] as const;
export type Look = (typeof LOOKS)[number];

class Choice {
  group = $state<Group>("all");
  tag = $state("");
  text = $state("");
  order = $state<Order>("urgent");
  /** Ids of printers. */
  readonly selected = new SvelteSet<string>();
  /** The printer whose details are open. */
  open = $state("");
  #look = $state<Look>();

  constructor() {
    const kept = localStorage.getItem(KEPT);
    this.#look = LOOKS.find((look) => look === kept);
  }

  get look(): Look {
    return this.#look ?? (farm.printers.size > MAX_CARDS ? "rows" : "cards");
  }

  set look(look: Look) {
    this.#look = look;
    localStorage.setItem(KEPT, look);
  }

  /** The ids of the printers that are shown, in their order. */
  readonly shown = $derived(chosen(farm.printers.values(), this).map(({ id }) => id));

  /** The selected printers that still are in the farm. */
  readonly picked = $derived([...farm.printers.values()].filter(({ id }) => this.selected.has(id)));

  toggle(id: string): void {
    if (!this.selected.delete(id)) this.selected.add(id);
  }

  all(on: boolean): void {
    for (const id of this.shown) {
      if (on) this.selected.add(id);
      else this.selected.delete(id);
    }
  }
}

export const choice = new Choice();
