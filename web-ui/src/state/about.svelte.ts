/** What the settings show of Passo itself: stored values, logs, places and versions. */

import { call } from "../api/client";
import type { LogRecord, SettingValue, Version } from "../api/schema";
import { administration } from "./accounts.svelte";
import { session } from "./session.svelte";

class About {
  logs = $state.raw<LogRecord[]>([]);
  places = $state.raw<string[]>([]);
  settings = $state.raw<SettingValue[]>([]);
  version = $state.raw<Version>();

  async load(): Promise<void> {
    const operator = session.may("operator");
    [this.version, this.settings, this.logs, this.places] = await Promise.all([
      call<Version>("GET", "version"),
      call<SettingValue[]>("GET", "settings"),
      operator ? call<LogRecord[]>("GET", "logs") : [],
      operator ? call<string[]>("GET", "places") : [],
    ]);
  }

  store = () => this.#change("settings/store");
  reset = () => this.#change("settings/reset");

  #change(path: string): Promise<boolean> {
    return administration.guard(async () => {
      await call("POST", path);
      await this.load();
    });
  }
}

export const about = new About();
