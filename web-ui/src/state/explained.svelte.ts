/** What one line of G-code becomes. */

import { call, query, Refusal } from "../api/client";
import type { Explanation, FaultStatus } from "../api/schema";

class Explained {
  told = $state.raw<Explanation>();
  fault = $state.raw<FaultStatus>();
  waiting = $state(false);
  #asked = 0;

  ofLine = (line: string, before = "", after = "") =>
    this.#ask(call<Explanation>("POST", "explain", { line, before, after }));
  ofFile = (path: string, line: number) => this.#ask(call<Explanation>("GET", `explain?${query({ path, line })}`));

  async #ask(asked: Promise<Explanation>): Promise<void> {
    const mine = ++this.#asked;
    this.waiting = true;
    try {
      const told = await asked;
      if (mine !== this.#asked) return;
      this.told = told;
      this.fault = undefined;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (mine !== this.#asked) return;
      this.told = undefined;
      this.fault = error.fault;
    } finally {
      if (mine === this.#asked) this.waiting = false;
    }
  }
}

export const explained = new Explained();
