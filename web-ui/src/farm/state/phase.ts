/** What a printer of the farm is about, in one word, and what a person has to do there. */

import type { PrinterView } from "../schema";

/** The first that fits, most urgent first. */
export const PHASES = [
  "unknown-start",
  "attention",
  "halted",
  "unreachable",
  "paused",
  "clear",
  "printing",
  "preparing",
  "busy",
  "ready",
  "service",
  "connecting",
] as const;
export type Phase = (typeof PHASES)[number];

export function phaseOf(printer: PrinterView): Phase {
  if (printer.start_unknown) return "unknown-start";
  if (printer.attention) return "attention";
  switch (printer.condition) {
    case "idle":
      if (printer.service) return "service";
      if (!printer.bed_clear) return "clear";
      return printer.run ? "preparing" : "ready";
    case "busy":
      return printer.run ? "preparing" : "busy";
    default:
      return printer.condition;
  }
}

/** The choices of the filter, with the phases of each. */
export const GROUPS = {
  all: PHASES,
  person: ["unknown-start", "attention", "halted", "paused", "unreachable"],
  clear: ["clear"],
  printing: ["printing", "preparing", "busy", "paused"],
  ready: ["ready"],
  other: ["service", "connecting", "unreachable"],
} as const satisfies Record<string, readonly Phase[]>;
export type Group = keyof typeof GROUPS;

export const TONES: Partial<Record<Phase, string>> = {
  "unknown-start": "bad",
  attention: "bad",
  halted: "bad",
  unreachable: "warn",
  paused: "warn",
  clear: "warn",
  printing: "good",
  preparing: "good",
  ready: "good",
};

export const ORDERS = ["urgent", "name", "left", "progress"] as const;
export type Order = (typeof ORDERS)[number];

export interface Wanted {
  group: Group;
  tag: string;
  text: string;
  order: Order;
}

const names = new Intl.Collator(undefined, { numeric: true }); // one for all: to make one takes long
/** By name: `P9` comes before `P10`. */
export const byName = (a: { name: string }, b: { name: string }) => names.compare(a.name, b.name);

/** The printers that are wanted, in the wanted order. */
export function chosen(printers: Iterable<PrinterView>, { group, tag, text, order }: Wanted): PrinterView[] {
  const words = text.trim().toLowerCase();
  const phases: readonly Phase[] = GROUPS[group];
  const found = [...printers].filter(
    (one) => phases.includes(phaseOf(one)) && (!tag || one.tags.includes(tag)) && (!words || said(one).includes(words)),
  );
  const key: Record<Order, (one: PrinterView) => number> = {
    urgent: (one) => PHASES.indexOf(phaseOf(one)),
    name: () => 0,
    left: (one) => one.seen?.job?.left_s ?? Infinity,
    progress: (one) => -(one.seen?.job?.fraction ?? -1),
  };
  return found.sort((a, b) => compare(key[order](a), key[order](b)) || byName(a, b));
}

function compare(a: number, b: number): number {
  return a === b ? 0 : a - b; // both may be infinite
}

/** What the text of the filter is looked for in. */
function said({ name, tags, loaded, seen }: PrinterView): string {
  return [name, ...tags, loaded.material, loaded.colour, seen?.job?.file].join(" ").toLowerCase();
}
