/** What the machine is: names, kinds and limits of its parts, which do not change while it runs. */

import { call } from "../api/client";
import type { Machine as Parts } from "../api/schema";

export type HeaterKind = Parts["heaters"][string]["kind"];

class Machine {
  name = $state("");
  heaters = $state.raw<Parts["heaters"]>({});
  /** The fans that commands set. */
  fans = $state.raw<Parts["fans"]>([]);
  /** The outputs that commands set. */
  outputs = $state.raw<Parts["outputs"]>({});
  /** Those of filament sensors and buttons, by their names in the status. */
  inputs = $state.raw<Parts["inputs"]>({});
  lights = $state.raw<Parts["lights"]>({});
  servos = $state.raw<Parts["servos"]>({});
  /** The axes that home by the stall of a motor. */
  stallAxes = $state.raw<Parts["stall_axes"]>([]);
  tools = $state.raw<Parts["tools"]>([]);
  /** It measures resonances. */
  accelerometer = $state(false);

  async load(): Promise<void> {
    const read = await call<Parts>("GET", "machine");
    this.name = read.name;
    this.heaters = read.heaters;
    this.fans = read.fans;
    this.outputs = read.outputs;
    this.inputs = read.inputs;
    this.lights = read.lights;
    this.servos = read.servos;
    this.stallAxes = read.stall_axes;
    this.tools = read.tools;
    this.accelerometer = read.accelerometer;
  }
}

export const machine = new Machine();
