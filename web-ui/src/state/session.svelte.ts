/** Who uses the page, and what that account may do. */

import { call, Refusal } from "../api/client";
import type { FaultStatus, Identity } from "../api/schema";

export const ROLES = ["viewer", "operator", "admin"] as const;
export type RoleName = (typeof ROLES)[number];

class Session {
  /** Undefined until the server has answered. */
  identity = $state.raw<Identity>();
  /** Why the last attempt to log in has failed. */
  fault = $state.raw<FaultStatus>();

  /** The user wants to create the administrator. */
  settingUp = $state(false);

  /** The printer may be seen. */
  get open(): boolean {
    return this.identity !== undefined && this.identity.role !== "public";
  }

  /** An account is logged in, which can log out. */
  get named(): boolean {
    return this.open && this.identity?.set_up === true;
  }

  /** The account may do what this role may. */
  may(role: RoleName): boolean {
    return ROLES.findIndex((one) => one === this.identity?.role) >= ROLES.indexOf(role);
  }

  async load(): Promise<void> {
    this.identity = await call<Identity>("GET", "session");
  }

  logIn(name: string, password: string): Promise<void> {
    return this.#enter("session", { name, password });
  }

  setUp(name: string, password: string, code: string): Promise<void> {
    return this.#enter("session/administrator", { name, password, code });
  }

  async logOut(): Promise<void> {
    await call("DELETE", "session");
    location.reload(); // nothing of what was seen stays
  }

  async #enter(path: string, body: object): Promise<void> {
    try {
      this.identity = await call<Identity>("POST", path, body);
      this.fault = undefined;
      this.settingUp = false;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.fault = error.fault;
    }
  }
}

export const session = new Session();
