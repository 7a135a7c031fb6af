/** The console: the lines of all consoles, and the commands that can be completed. */

import { call, Refusal } from "../api/client";
import type { Command, Line } from "../api/schema";
import { printer } from "./printer.svelte";

const KEPT = 500;

export interface Shown {
  id: number;
  /** `sent` to the printer by this page or another console, its `answer`, or `error`. */
  kind: "sent" | "answer" | "error";
  text: string;
  /** Who has sent it, where that is known. */
  sender: string;
}

/** The commands whose code begins with what is typed, the shorter ones first. */
export function completions(commands: readonly Command[], typed: string): Command[] {
  const code = typed.trim().toUpperCase();
  if (!code || /\s/.test(typed.trimStart())) return [];
  return commands
    .filter((command) => command.code.startsWith(code))
    .sort((a, b) => a.code.length - b.code.length || a.code.localeCompare(b.code))
    .slice(0, 8);
}

/** The command of a line that is being typed. */
export function commandOf(commands: readonly Command[], typed: string): Command | undefined {
  const code = /^\s*([GMT]\d+(?:\.\d+)?|[A-Za-z_]\w*)/i.exec(typed)?.[1]?.toUpperCase();
  return commands.find((command) => command.code === code);
}

/** What can complete a line: a command or one of its parameters, and the line with it. */
export interface Offer {
  name: string;
  text: string;
  line: string;
}

/** The commands that the typed text begins; after a command its parameters that are not given. */
export function offersFor(commands: readonly Command[], typed: string): Offer[] {
  const found = completions(commands, typed).map(({ code, text }) => ({ name: code, text, line: `${code} ` }));
  const command = commandOf(commands, typed);
  const words = /^(\s*\S+\s+(?:.*\s)?)(\w*)$/.exec(typed);
  if (found.length || !command || !words) return found;
  const [, before = "", begun = ""] = words;
  const named = !/^[A-Z]\d/.test(command.code);
  const given = before.toUpperCase().split(/[\s=]+/);
  return command.parameters
    .filter(({ kind }) => kind !== "rest" && kind !== "anything")
    .flatMap(({ names, usage, text }) => names.map((name) => ({ name, usage, text })))
    .filter(({ name }) => !given.some((word) => (named ? word === name : word.startsWith(name))))
    .filter(({ name }) => name.startsWith(begun.toUpperCase()) && name !== begun.toUpperCase())
    .map(({ name, usage, text }) => ({
      name: named ? `${name}=` : name,
      text: `${usage}: ${text}`,
      line: before + (named ? `${name}=` : name),
    }))
    .slice(0, 8);
}

/** What hosts exchange all the time: bare acknowledgements, and polls of temperatures. */
export function isNoise(line: Shown): boolean {
  if (line.kind === "sent") return /^(N\d+\s*)?M105\b/i.test(line.text);
  return /^ok(\s+[NPB]\d+)*$/.test(line.text) || /^(ok\s+)?T\d*:\s*-?\d/.test(line.text);
}

class Console {
  lines = $state.raw<Shown[]>([]);
  commands = $state.raw<Command[]>([]);
  /** What this page has sent, oldest first. */
  sent: string[] = [];
  #next = 0;

  constructor() {
    printer.onLine((line) => this.#add(line));
  }

  #add(...lines: Line[]): void {
    const shown = lines.map(({ received, text, ...line }) => ({
      id: this.#next++,
      kind: received ? ("sent" as const) : /^(Error:|!!)/.test(text) ? ("error" as const) : ("answer" as const),
      text,
      sender: "sender" in line ? String(line.sender) : "",
    }));
    this.lines = [...this.lines, ...shown].slice(-KEPT);
  }

  /** Reads the commands and the last lines. */
  async load(): Promise<void> {
    const [commands, lines] = await Promise.all([
      call<Command[]>("GET", "console/commands"),
      call<Line[]>("GET", "console"),
    ]);
    this.commands = commands;
    this.lines = [];
    this.#add(...lines);
  }

  /** Sends a line. Its answer comes as a line of the feed; a refusal is shown with what to do. */
  async send(text: string): Promise<void> {
    if (this.sent.at(-1) !== text) this.sent.push(text);
    try {
      await call("POST", "console", { script: text });
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      const { text: what, action } = error.fault;
      const whole = action ? `${what}. ${action}.` : what;
      const shown = { id: this.#next++, kind: "error" as const, text: whole, sender: "" };
      this.lines = [...this.lines, shown];
    }
  }
}

export const gcodeConsole = new Console();
