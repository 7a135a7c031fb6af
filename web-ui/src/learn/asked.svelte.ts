import type { FaultStatus } from "../api/schema";
import { Refusal } from "../api/client";
import { language } from "../text/index.svelte";

/** What `ask` returns, asked again when the language or a value that `ask` reads changes; or the fault of its refusal.
 * Call it while a component is made. */
export class Asked<T> {
  found = $state.raw<T>();
  fault = $state.raw<FaultStatus>();

  constructor(ask: () => Promise<T>) {
    $effect(() => {
      void language.chosen;
      let shown = true;
      ask().then(
        (found) => {
          if (shown) [this.found, this.fault] = [found, undefined];
        },
        (error: unknown) => {
          if (!(error instanceof Refusal)) throw error;
          if (shown) [this.found, this.fault] = [undefined, error.fault];
        },
      );
      return () => {
        shown = false; // another place is asked for, or none
      };
    });
  }
}
