/** What the user asks the printer to do, and what went wrong with it. */

import { call, Refusal, segment } from "../api/client";
import type { FaultStatus } from "../api/schema";
import { printer } from "./printer.svelte";

class Notices {
  /** Refusals that the user has not closed yet, newest last. */
  list = $state<(FaultStatus & { id: number })[]>([]);
  #next = 0;

  add(fault: FaultStatus): void {
    this.list = [...this.list.slice(-2), { ...fault, id: this.#next++ }];
  }

  close(id: number): void {
    this.list = this.list.filter((notice) => notice.id !== id);
  }
}

export const notices = new Notices();

/** Waits for an action; a refusal becomes a notice. True if the action was carried out. */
export async function attempt(action: Promise<unknown>): Promise<boolean> {
  try {
    await action;
    return true;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    notices.add(error.fault);
    return false;
  }
}

function run(script: string): Promise<boolean> {
  return attempt(call("POST", "console", { script }));
}

const JOG_MM_MIN: Record<string, number> = { z: 600 };

export const stop = () => attempt(call("POST", "stop"));
export const restart = () => attempt(call("POST", "restart"));

export const setHeater = (name: string, celsius: number) =>
  attempt(call("PUT", `heaters/${segment(name)}/target`, { celsius }));
export const setFan = (name: string, speed: number) =>
  attempt(call("PUT", `fans/${segment(name)}/speed`, { speed }));

export const home = (axes: readonly string[]) =>
  run(["G28", ...axes.map((axis) => axis.toUpperCase())].join(" "));
export const motorsOff = () => run("M18");
export const selectTool = (number: number) => run(`T${number}`);

/** Moves an axis by so much, and leaves the program's mode as it was. */
export function jog(axis: string, distance_mm: number): Promise<boolean> {
  const back = printer.status?.motion.absolute === false ? "G91" : "G90";
  return run(`G91\nG0 ${axis.toUpperCase()}${distance_mm} F${JOG_MM_MIN[axis] ?? 6000}\n${back}`);
}

export function extrude(length_mm: number, speed_mm_s: number): Promise<boolean> {
  const back = printer.status?.motion.absolute_e === false ? "M83" : "M82";
  return run(`M83\nG1 E${length_mm} F${speed_mm_s * 60}\n${back}`);
}

export const babystep = (distance_mm: number) => run(`M290 Z${distance_mm}`);
export const setSpeedFactor = (factor: number) => run(`M220 S${Math.round(factor * 100)}`);
export const setFlow = (factor: number) => run(`M221 S${Math.round(factor * 100)}`);

export const startPrint = (path: string) => attempt(call("POST", "job", { path }));
export const pausePrint = () => attempt(call("POST", "job/pause"));
export const resumePrint = () => attempt(call("POST", "job/resume"));
export const cancelPrint = () => attempt(call("POST", "job/cancel"));
