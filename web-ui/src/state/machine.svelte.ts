/** What the machine is: names, kinds and limits of its parts, which do not change while it runs. */

import { call } from "../api/client";

export type HeaterKind = "hotend" | "bed" | "chamber";

export interface MachineParts {
  name: string;
  heaters: Record<string, { kind: HeaterKind; max_c: number }>;
  fans: string[];
  tools: { extruder: string | null; heater: string | null }[];
}

class Machine {
  name = $state("");
  heaters = $state.raw<MachineParts["heaters"]>({});
  /** The fans that commands set. */
  fans = $state.raw<string[]>([]);
  tools = $state.raw<MachineParts["tools"]>([]);
  /** Below it the printer refuses to push filament. */
  min_extrude_c = $state(170);

  async load(): Promise<void> {
    const read = await call<MachineParts>("GET", "machine");
    this.name = read.name;
    this.heaters = read.heaters;
    this.fans = read.fans;
    this.tools = read.tools;
  }
}

export const machine = new Machine();
