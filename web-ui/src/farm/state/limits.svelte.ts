/** Accounts that see and command only the printers with one of their tags. */

import { call, segment } from "../../api/client";
import { administration } from "../../state/accounts.svelte";
import type { Limit } from "../schema";

class Limits {
  #list = $state.raw<Limit[]>([]);

  async load(): Promise<void> {
    this.#list = await call<Limit[]>("GET", "limits");
  }

  /** The tags of an account; none for one that sees all printers. */
  of(account: string): string[] {
    return this.#list.find(({ subject }) => subject === account)?.tags ?? [];
  }

  set(account: string, tags: readonly string[]): Promise<boolean> {
    return administration.guard(async () => {
      this.#list = await call<Limit[]>("PUT", `limits/${segment(account)}`, { tags });
    });
  }
}

export const limits = new Limits();
