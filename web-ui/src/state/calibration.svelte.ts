/** The task of calibration that runs, what the printer replies, and what it has changed. */

import { call, Refusal } from "../api/client";
import type { BedMap, SettingValue, Thermistor, ThermistorFit } from "../api/schema";
import type { Key } from "../text/index.svelte";
import { attempt, notices } from "./notices.svelte";
import { printer } from "./printer.svelte";

/** The tasks are those that have a text about what they do. */
export type TaskName = Key extends infer One ? (One extends `calibrate.${infer Name}-does` ? Name : never) : never;

/** A setting that the task has changed. */
export interface Change extends SettingValue {
  before: string;
}

const MAX_REPLIES = 200;

const idOf = (setting: SettingValue) => `${setting.command} ${setting.word}`;

/** The value that a setting has as a text: a number, or a name. */
const valueOf = (text: string) => (Number.isNaN(Number(text)) ? text : Number(text));

/** The settings whose values differ, with their values before. */
export function changesOf(before: readonly SettingValue[], after: readonly SettingValue[]): Change[] {
  const old = new Map(before.map((setting) => [idOf(setting), setting.value]));
  return after.flatMap((setting) => {
    const value = old.get(idOf(setting));
    return value === undefined || value === setting.value ? [] : [{ ...setting, before: value }];
  });
}

class Calibration {
  settings = $state.raw<SettingValue[]>([]);
  /** The task whose replies and changes are shown. */
  task = $state<TaskName>();
  running = $state(false);
  cancelled = $state(false);
  done = $state(false);
  replies = $state<string[]>([]);
  changes = $state.raw<Change[]>([]);
  bed = $state.raw<BedMap>();

  async load(): Promise<void> {
    [this.settings, this.bed] = await Promise.all([
      call<SettingValue[]>("GET", "settings"),
      call<BedMap>("GET", "calibration/bed"),
    ]);
  }

  /** Runs a task: afterwards `changes` has what it has set. `step`: the user continues with it. */
  async run(task: TaskName, action: () => Promise<unknown>, { step = false } = {}): Promise<void> {
    if (this.running) return;
    this.task = task;
    this.running = true;
    this.cancelled = this.done = false;
    this.replies = [];
    this.changes = [];
    const end = printer.onLine((line) => {
      if (!line.received && line.text !== "ok") this.replies = [...this.replies.slice(1 - MAX_REPLIES), line.text];
    });
    try {
      await this.load();
      const before = this.settings;
      await action();
      await this.load();
      this.changes = changesOf(before, this.settings);
      this.done = !this.cancelled && !step;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (!this.cancelled) notices.add(error.fault); // the user knows why it ended
    } finally {
      end();
      this.running = false;
    }
  }

  async cancel(): Promise<void> {
    this.cancelled = true; // before the next step of the task
    if (!(await attempt(call("POST", "console/end-wait")))) this.cancelled = false;
  }

  /** Sets what it was before the task, and stores that if the result was stored. */
  async undo(): Promise<void> {
    const { changes } = this;
    const back = async () => {
      for (const change of changes) await setValue(change, valueOf(change.before));
      if (changes.some(({ source }) => source === "stored")) await call("POST", "settings/store");
      await this.load();
    };
    if (await attempt(back())) this.changes = [];
  }

  async store(): Promise<void> {
    if (!(await attempt(call("POST", "settings/store")))) return;
    await this.load();
    const now = new Map(this.settings.map((setting) => [idOf(setting), setting]));
    this.changes = this.changes.map((change) => ({ ...change, ...now.get(idOf(change)) }));
  }
}

export const calibration = new Calibration();

export const setValue = ({ command, word }: Pick<SettingValue, "command" | "word">, value: number | string) =>
  call("PUT", "settings", { command, word, value });
export const tuneHeater = (heater: string, celsius: number, method: "pid" | "model") =>
  call("POST", "calibration/heater", { heater, celsius, method });
export const measureShaper = (axis: string) => call("POST", "calibration/shaper", { axis });
export const findStall = (axis: string, repeats: number) => call("POST", "calibration/stall", { axis, repeats });
export const measureBed = () => call("POST", "calibration/bed");
export const level = (procedure: BedMap["procedures"][number]) => call("POST", "calibration/level", { procedure });
export const repeatProbe = () => call("POST", "calibration/probe");
export const setThermistor = (thermistor: Thermistor) => call("PUT", "calibration/thermistor", thermistor);
export const fitThermistor = (heater: string, readings: { shown_c: number; true_c: number }[]) =>
  call<ThermistorFit[]>("POST", "calibration/thermistor/fit", { heater, readings });
