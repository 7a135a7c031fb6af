/** Temperatures of the past: what the server has kept, then what the feed brings. */

import { call } from "../api/client";
import type { Status, Temperatures } from "../api/schema";

const STEP_MS = 1000;
export const SPAN_S = 3600;

export interface Series {
  celsius: (number | null)[];
  target: (number | null)[];
  power: (number | null)[];
}

/** Columns by heater over `times`, in seconds of the epoch. */
export class TemperatureHistory {
  times: number[] = [];
  heaters: Record<string, Series> = {};
  /** The temperatures of sensors without a heater. */
  sensors: Record<string, (number | null)[]> = {};
  /** Counts up with each change of the columns, which are too large to be followed one by one. */
  version = $state(0);

  async load(): Promise<void> {
    const now_s = Date.now() / 1000;
    this.take(await call<Temperatures>("GET", `history/temperatures?span_s=${SPAN_S}`), now_s);
  }

  take(past: Temperatures, now_s: number): void {
    this.times = past.ages_s.map((age_s) => now_s - age_s);
    this.heaters = Object.fromEntries(
      Object.entries(past.heaters).map(([name, { celsius, target_c, power }]) => [
        name,
        { celsius, target: target_c, power },
      ]),
    );
    this.sensors = past.sensors;
    this.version++;
  }

  /** Adds the temperatures of now, at most one sample a second; forgets those beyond the span. */
  add(status: Status, now_s: number): void {
    const last = this.times.at(-1);
    if (last !== undefined && now_s - last < STEP_MS / 1000) return;
    this.times.push(now_s);
    for (const [name, heater] of Object.entries(status.heaters)) {
      const series = (this.heaters[name] ??= this.#empty());
      series.celsius.push(heater.age_s ? null : (heater.celsius ?? null));
      series.target.push(heater.target_c);
      series.power.push(heater.power);
    }
    for (const [name, sensor] of Object.entries(status.sensors)) {
      const column = (this.sensors[name] ??= this.#nothing());
      column.push(sensor.age_s ? null : (sensor.celsius ?? null));
    }
    const old = this.times.findIndex((time) => time >= now_s - SPAN_S);
    if (old > 0) this.#forget(old);
    this.version++;
  }

  #empty(): Series {
    return { celsius: this.#nothing(), target: this.#nothing(), power: this.#nothing() };
  }

  #nothing(): (number | null)[] {
    return Array<null>(this.times.length - 1).fill(null);
  }

  #forget(samples: number): void {
    this.times.splice(0, samples);
    for (const { celsius, target, power } of Object.values(this.heaters)) {
      for (const column of [celsius, target, power]) column.splice(0, samples);
    }
    for (const column of Object.values(this.sensors)) column.splice(0, samples);
  }
}

export const temperatures = new TemperatureHistory();
