/** What the user asks the farm to do. */

import { call, segment } from "../../api/client";
import { attempt, notices } from "../../state/notices.svelte";
import { t } from "../../text/index.svelte";
import { farm } from "./farm.svelte";
import type { JobChange, NewJob, PrinterChange, ServiceInterval, Stopped } from "../schema";

const at = (printer: string, path = "") => `printers/${segment(printer)}${path}`;
const post = (printer: string, path: string, body?: object) => attempt(call("POST", at(printer, path), body));

export const pause = (printer: string) => post(printer, "/pause");
export const resume = (printer: string) => post(printer, "/resume");
export const cancel = (printer: string) => post(printer, "/cancel");
/** The user has looked at the beds. */
export const clear = (printers: readonly string[]) =>
  Promise.all(printers.map((printer) => post(printer, "/clear", { bed_clear: true })));
export const attend = (printer: string, started?: boolean) => post(printer, "/attend", { started: started ?? null });
export const changePrinter = (printer: string, change: PrinterChange) => attempt(call("PATCH", at(printer), change));
export const removePrinter = (printer: string) => attempt(call("DELETE", at(printer)));
export const setService = (printer: string, item: string, interval: ServiceInterval) =>
  attempt(call("PUT", at(printer, `/service/${segment(item)}`), interval));
export const removeService = (printer: string, item: string) =>
  attempt(call("DELETE", at(printer, `/service/${segment(item)}`)));

/** Emergency stop; those printers that did not stop are named. */
const stopping = (stop: Promise<Stopped[]>) =>
  attempt(
    stop.then((stopped) => {
      const names = stopped.filter(({ result }) => result !== "done").map(({ printer }) => farm.name(printer));
      if (!names.length) return;
      notices.add({ code: "", part: "", text: t("stop.failed", { names: names.join(", ") }), action: t("stop.failed-do") });
    }),
  );
export const stop = (printer: string) => stopping(call<Stopped>("POST", at(printer, "/stop")).then((one) => [one]));
export const stopAll = () => stopping(call<Stopped[]>("POST", "stop"));

export const addJob = (job: NewJob) => attempt(call("POST", "jobs", job));
export const changeJob = (job: string, change: JobChange) => attempt(call("PATCH", `jobs/${segment(job)}`, change));
export const cancelJob = (job: string) => attempt(call("DELETE", `jobs/${segment(job)}`));
export const pauseQueue = (paused: boolean) => attempt(call("PUT", "queue", { paused }));
export const removeFile = (sha256: string) => attempt(call("DELETE", `files/${sha256}`));
export const setPowerGroup = (name: string, limit_w: number) =>
  attempt(call("PUT", `power/${segment(name)}`, { limit_w }));
export const removePowerGroup = (name: string) => attempt(call("DELETE", `power/${segment(name)}`));
