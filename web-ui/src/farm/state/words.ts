/** What a card or a row says of a printer. */

import { keyOf, t } from "../../text/index.svelte";
import { clockTime, dayTime, duration } from "../../text/units";
import { farm } from "./farm.svelte";
import { phaseOf } from "./phase";
import type { PrinterView } from "../schema";

export interface StateLine {
  /** What is printed, or was printed last. */
  file: string;
  /** In place of a file. */
  idle: string;
  /** The time left, and the end. */
  left: string;
  note: string;
}

export function stateLine(printer: PrinterView): StateLine {
  const { seen, condition } = printer;
  const phase = phaseOf(printer);
  const job = seen?.job;
  const last = seen?.last_print;
  if (job) {
    const heard = farm.heard(printer);
    const ends = job.left_s == null ? "" : clockTime(new Date(heard.getTime() + job.left_s * 1000), heard);
    const left = job.left_s == null || condition === "paused" ? "" : t("farm.left", { left: duration(job.left_s), ends });
    return { file: nameOf(job.file), idle: "", left, note: "" };
  }
  const ended = last ? t("farm.last", { result: t(keyOf(`job.${last.result}`) ?? "job.failed").toLowerCase() }) : "";
  switch (phase) {
    case "clear":
      return { file: last ? nameOf(last.file) : "", idle: t("clear.title"), left: "", note: last ? `${ended} ${t("clear.needed")}` : "" };
    case "ready":
      return { file: "", idle: t("farm.ready"), left: "", note: cleared(printer) };
    case "preparing":
      return { file: "", idle: t("phase.preparing"), left: "", note: t("farm.preparing") };
    case "service":
      return { file: "", idle: t("phase.service"), left: "", note: t("farm.service") };
    case "connecting":
      return { file: "", idle: t("phase.connecting"), left: "", note: "" };
    case "unreachable":
      return { file: "", idle: printer.url.replace(/^https?:\/\//, "").replace(/\/$/, ""), left: "", note: "" };
    default:
      return { file: last ? nameOf(last.file) : "", idle: t(`phase.${phase}`), left: "", note: ended };
  }
}

/** Who has said that the bed is clear, and when. */
export function cleared(printer: PrinterView): string {
  if (!printer.bed_clear || printer.cleared_s == null) return "";
  const time = dayTime(printer.cleared_s);
  return printer.cleared_by ? t("clear.by", { name: printer.cleared_by, time }) : t("clear.at", { time });
}

/** The name of a file, without its folders. */
export const nameOf = (path: string) => path.replace(/^.*\//, "");
