/** The console: what was sent, what was answered, and the commands that can be completed. */

import { call, Refusal } from "../api/client";
import type { Answer, Command } from "../api/schema";
import { printer } from "./printer.svelte";

const KEPT = 500;

export interface Line {
  id: number;
  /** `sent` by this page or another console, `answer` of the printer, or `error`. */
  kind: "sent" | "answer" | "error";
  text: string;
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

class Console {
  lines = $state<Line[]>([]);
  commands = $state.raw<Command[]>([]);
  /** What this page has sent, oldest first. */
  sent: string[] = [];
  #next = 0;

  constructor() {
    printer.onEvent((event) => {
      if (event.kind === "Message") this.add("answer", String(event["text"]));
    });
  }

  add(kind: Line["kind"], text: string): void {
    const lines = text.split("\n").map((part) => ({ id: this.#next++, kind, text: part }));
    this.lines = [...this.lines, ...lines].slice(-KEPT);
  }

  async loadCommands(): Promise<void> {
    this.commands = await call<Command[]>("GET", "console/commands");
  }

  async send(text: string): Promise<void> {
    if (this.sent.at(-1) !== text) this.sent.push(text);
    this.add("sent", text);
    try {
      const { lines } = await call<Answer>("POST", "console", { script: text });
      for (const line of lines) this.add("answer", line);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.add("error", error.fault.action ? `${error.message}. ${error.fault.action}.` : error.message);
    }
  }
}

export const gcodeConsole = new Console();
