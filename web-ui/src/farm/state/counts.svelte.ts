/** How many printers are in each group of phases. */

import { farm } from "./farm.svelte";
import { GROUPS, phaseOf, type Group, type Phase } from "./phase";

class Counts {
  #phases = $derived.by(() => {
    const counted: Partial<Record<Phase, number>> = {};
    for (const printer of farm.printers.values()) {
      const phase = phaseOf(printer);
      counted[phase] = (counted[phase] ?? 0) + 1;
    }
    return counted;
  });

  of(group: Group): number {
    return GROUPS[group].reduce((sum, phase) => sum + (this.#phases[phase] ?? 0), 0);
  }
}

export const counts = new Counts();
