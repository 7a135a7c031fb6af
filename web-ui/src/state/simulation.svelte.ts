/** Faults of the simulated printer. */

import { call, segment } from "../api/client";
import type { SimulatedPart } from "../api/schema";
import { attempt } from "./notices.svelte";

class Simulation {
  /** Empty where the boards are real. */
  parts = $state.raw<SimulatedPart[]>([]);

  async load(): Promise<void> {
    this.parts = await call<SimulatedPart[]>("GET", "simulation/parts");
  }

  async set(part: string, fault: string): Promise<void> {
    if (await attempt(call("PUT", `simulation/parts/${segment(part)}`, { fault }))) await this.load();
  }

  activeOf(part: string): string | undefined {
    return this.parts.find((one) => one.part === part)?.active;
  }
}

export const simulation = new Simulation();
