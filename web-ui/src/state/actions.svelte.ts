/** What the user asks the printer to do. */

import { call, segment } from "../api/client";
import type { FileToPrint } from "../api/schema";
import { attempt } from "./notices.svelte";

const JOG_MM_S: Record<string, number> = { z: 10 }; // others 100

export const stop = () => attempt(call("POST", "stop"));
export const restart = () => attempt(call("POST", "restart"));

export const setHeater = (name: string, celsius: number) =>
  attempt(call("PUT", `heaters/${segment(name)}/target`, { celsius }));
export const setFan = (name: string, speed: number) =>
  attempt(call("PUT", `fans/${segment(name)}/speed`, { speed }));
export const setFanTarget = (name: string, celsius: number) =>
  attempt(call("PUT", `fans/${segment(name)}/target`, { celsius }));
/** `value` is a fraction of fully on. */
export const setOutput = (name: string, value: number) =>
  attempt(call("PUT", `outputs/${segment(name)}/value`, { value }));
/** `color`: red, green, blue, white. */
export const setLight = (name: string, [red, green, blue, white]: readonly number[]) =>
  attempt(call("PUT", `lights/${segment(name)}/color`, { red, green, blue, white }));
/** Null switches its signal off. */
export const turnServo = (name: string, degrees: number | null) =>
  attempt(call("PUT", `servos/${segment(name)}/angle`, { degrees }));
export const turnMotor = (motor: string) => attempt(call("POST", "motion/turn-motor", { motor }));
export const enableFilamentSensor = (name: string, enabled: boolean) =>
  attempt(call("PUT", `inputs/filament-sensors/${segment(name)}`, { enabled }));

export const home = (axes: readonly string[]) => attempt(call("POST", "motion/home", { axes }));
export const motorsOff = () => attempt(call("POST", "motion/motors-off"));

export const jog = (axis: string, distance_mm: number) => move(axis, distance_mm, JOG_MM_S[axis] ?? 100);
export const extrude = (length_mm: number, speed_mm_s: number) => move("e", length_mm, speed_mm_s);
/** Sends lines of G-code, as a console does. */
export const send = (script: string) => attempt(call("POST", "console", { script }));
export const selectTool = (number: number) => send(`T${number}`);

function move(axis: string, distance_mm: number, speed_mm_s: number): Promise<boolean> {
  return attempt(call("POST", "motion/jog", { distances_mm: { [axis]: distance_mm }, speed_mm_s }));
}

export const babystep = (axis: string, distance_mm: number) =>
  attempt(call("POST", "tuning/babystep", { axis, distance_mm }));
export const setSpeedFactor = (factor: number) => attempt(call("PUT", "tuning/speed", { factor }));
export const setFlow = (tool: number, factor: number) =>
  attempt(call("PUT", `tuning/flow/${tool}`, { factor }));

/** `allow` is what the print may do in place of a failure, see the metadata of the file. */
export const startPrint = (path: string, allow: FileToPrint["allow"] = []) =>
  attempt(call("POST", "job/start", { path, allow }));
export const queuePrint = (path: string) => attempt(call("POST", "queue", { path }));
export const unqueuePrint = (number: number) => attempt(call("DELETE", `queue/prints/${number}`));
export const moveQueuedPrint = (number: number, place: number) =>
  attempt(call("PUT", `queue/prints/${number}/place/${place}`));
export const setQueueMode = (automatic: boolean) => attempt(call("PUT", "queue/mode", { automatic }));
/** The user has confirmed that the bed is clear. */
export const startQueuedPrint = () => attempt(call("POST", "queue/start", { bed_clear: true }));
export const pausePrint = () => attempt(call("POST", "job/pause"));
export const resumePrint = () => attempt(call("POST", "job/resume"));
export const cancelPrint = () => attempt(call("POST", "job/cancel"));
export const cancelObject = (number: number, cancelled: boolean) =>
  attempt(call("PUT", `job/objects/${number}`, { cancelled }));
