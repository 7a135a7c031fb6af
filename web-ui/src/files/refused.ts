/** What can be done with a file that the printer refuses, by the codes of its problems. */

import type { Fault, FileToPrint } from "../api/schema";
import type { Key } from "../text/index.svelte";

type Allowance = NonNullable<FileToPrint["allow"]>[number];

const OF_MACHINES = [
  "input.out-of-range",
  "input.unreachable",
  "input.actuator",
  "input.missing-tool",
  "input.no-levelling",
];

/** The first problem of each kind: a file may have hundreds of the same. */
export function distinct(problems: readonly Fault[]): Fault[] {
  const found = new Map<string, Fault>();
  for (const problem of problems) {
    const id = `${problem.code} ${String(problem.values["axis"] ?? problem.values["value"] ?? "")}`;
    if (!found.has(id)) found.set(id, problem);
  }
  return [...found.values()];
}

/** Another machine may print the file. */
export function wantsAnotherMachine(problems: readonly Fault[]): boolean {
  return problems.some(({ code }) => OF_MACHINES.includes(code));
}

/** The macros that a file calls and the machine lacks, with the words of the first call. */
export function macrosOf(problems: readonly Fault[]): { name: string; words: string }[] {
  const found = new Map<string, string>();
  for (const { code, values } of problems) {
    const name = String(values["value"] ?? "");
    if (code === "input.no-macro" && !found.has(name)) found.set(name, String(values["text"] ?? ""));
  }
  return [...found].map(([name, words]) => ({ name, words }));
}

/** The text of the button that prints the file all the same. */
export function printLabel(allow: readonly Allowance[], problems: readonly Fault[]): Key {
  const [first, ...others] = allow;
  if (!first || others.length) return "refused.print-anyway";
  if (first !== "unknown") return `refused.print-${first}`;
  const names = new Set(problems.map(({ values }) => values["value"]));
  return names.size > 1 ? "refused.print-without-them" : "refused.print-without";
}

/** A macro to begin with, for the words with which a file calls it: temperatures are set, the rest
 * is a comment. */
export function macroText(name: string, words: string): string {
  const keys = [...words.matchAll(/\b([A-Z_][A-Z0-9_]*)=([-+.\d]*)/gi)].map(([, key = "", value = ""]) => ({
    key: key.toUpperCase(),
    value,
  }));
  const starts = /START|BEGIN/i.test(name);
  const lines = keys.flatMap(({ key, value }) => {
    const word = `S{params.${key}|default(${Number(value) || 0})|float}`;
    if (!starts) return [];
    if (/BED/.test(key)) return [`M190 ${word}`];
    return /EXTRUDER|HOTEND|NOZZLE|TOOL|^TEMP/.test(key) ? [`M109 ${word}`] : [];
  });
  if (starts) lines.unshift("G28");
  const call = words ? `; The file calls it with ${words.replaceAll("'''", "")}` : "; Write the commands of your old printer's macro here";
  return `[macros.${name}]\ngcode = '''\n${[call, ...lines].join("\n")}\n'''\n`;
}
