/** Accounts, API keys and log-ins, as the account may see them. */

import { call, Refusal, segment } from "../api/client";
import type { AccountRecord, KeyRecord, LogInRecord, MadeKey } from "../api/schema";
import { attempt, notices } from "./notices.svelte";
import { session, type RoleName } from "./session.svelte";

class Administration {
  accounts = $state.raw<AccountRecord[]>([]);
  keys = $state.raw<KeyRecord[]>([]);
  logIns = $state.raw<LogInRecord[]>([]);
  /** A key that was made just now; it is shown this once. */
  made = $state.raw<MadeKey>();
  /** What waits for the password. */
  waiting = $state.raw<() => Promise<unknown>>();

  async load(): Promise<void> {
    const admin = session.may("admin");
    [this.logIns, this.accounts, this.keys] = await Promise.all([
      call<LogInRecord[]>("GET", "sessions"),
      admin ? call<AccountRecord[]>("GET", "accounts") : [],
      admin ? call<KeyRecord[]>("GET", "keys") : [],
    ]);
  }

  addAccount = (name: string, password: string, role: RoleName) =>
    this.#do(() => call("POST", "accounts", { name, password, role }));
  changeRole = (name: string, role: RoleName) => this.#do(() => call("PATCH", `accounts/${segment(name)}`, { role }));
  removeAccount = (name: string) => this.#do(() => call("DELETE", `accounts/${segment(name)}`));
  addKey = (name: string, role: RoleName) =>
    this.#do(async () => {
      this.made = await call<MadeKey>("POST", "keys", { name, role });
    });
  revokeKey = (id: string) => this.#do(() => call("DELETE", `keys/${segment(id)}`));
  revokeLogIn = (id: string) => this.#do(() => call("DELETE", `sessions/${segment(id)}`));
  changePassword = (old: string, password: string) =>
    this.#do(() => call("PUT", "session/password", { old, new: password }));

  /** Enters the password again, and does what waits for it. */
  async confirm(password: string): Promise<void> {
    const action = this.waiting;
    if (!(await attempt(call("POST", "session/password", { password })))) return;
    this.waiting = undefined;
    await action?.();
  }

  #do = (action: () => Promise<unknown>) =>
    this.guard(async () => {
      await action();
      await this.load();
    });

  /** False if the server has refused it; an action that waits for the password counts as done. */
  async guard(action: () => Promise<unknown>): Promise<boolean> {
    try {
      await action();
      return true;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (error.fault.code === "web.password") {
        this.waiting = () => this.guard(action);
        return true;
      }
      notices.add(error.fault);
      return false;
    }
  }
}

export const administration = new Administration();
