/** The words of an error for users of the page: its buttons, in place of the commands of a console. */

import { keyOf, t } from "./index.svelte";

// Commands in brackets after what a button of the page does as well.
const BUTTONS = /\s\((?:M24|M25|M524|M23|M20|M500|M1000 C|G28|M109|G29 or G32)\)/g;

/** A sentence of the printer without commands that the page has buttons for. */
export function inButtons(text: string): string {
  return text
    .replace(BUTTONS, "")
    .replace(/start again or send M999/g, `press “${t("banner.start-again")}”`)
    .replace(/(?:send )?\bM999\b/g, `press “${t("banner.start-again")}”`)
    .replace(/\bM1000\b(?! C)/g, `“${t("job.resume-print")}”`);
}

/** `part.gcode:7: …` as `Line 7: …`, where the name of the file is in view. */
export function inLine(message: string, name: string): string {
  const rest = message.startsWith(`${name}:`) ? message.slice(name.length + 1) : message;
  return rest.replace(/^(\d+): /, (_, n: string) => `${t("machine.line", { n })}: `);
}

/** The next action of an error, as a sentence; empty if there is nothing to do. */
export function actionOf({ code, action }: { code: string; action: string }): string {
  const key = keyOf(`action.${code}`);
  if (key) return t(key);
  return action && !/[.?!]$/.test(action) ? `${inButtons(action)}.` : inButtons(action);
}
