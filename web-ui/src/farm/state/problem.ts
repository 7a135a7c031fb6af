/** What is wrong with a printer, in a sentence, and the next action in another. */

import { actionOf, inButtons } from "../../text/faults";
import { t } from "../../text/index.svelte";
import { dayTime } from "../../text/units";
import type { PrinterView } from "../schema";

export interface Problem {
  text: string;
  action: string;
}

const sentence = (text: string) => (!text || /[.?!]$/.test(text) ? text : `${text}.`);
const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

export function problemOf(printer: PrinterView): Problem | undefined {
  const { seen, attention, condition, last_word_s } = printer;
  if (printer.start_unknown) return { text: t("problem.start"), action: t("problem.start-do") };
  const fault = seen?.fault;
  if (condition === "unreachable") {
    const since = last_word_s == null ? "" : dayTime(last_word_s);
    return { text: since ? t("problem.unreachable-since", { time: since }) : t("problem.unreachable"), action: t("problem.unreachable-do") };
  }
  if (condition === "halted" && fault) return { text: capital(sentence(inButtons(fault.text))), action: actionOf(fault) };
  if (attention) return { text: capital(sentence(attention)), action: t("problem.attention-do") };
  if (fault) return { text: capital(sentence(inButtons(fault.text))), action: actionOf(fault) };
  if (condition === "halted") return { text: t("problem.halted"), action: t("problem.halted-do") };
  return undefined;
}
