/** `passo serve` with a machine file of a simulated printer and the example on its card, in scaled time; and
 * `passo hub`. */

import { spawn, type ChildProcess } from "node:child_process";
import { chmodSync, cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

export const PYTHON = process.env["PASSO_PYTHON"] ?? "../.venv/bin/python";
const EXAMPLE = process.env["PASSO_EXAMPLE"] ?? "../build/demo.gcode";
const MACHINES = "../src/passo/config/machines";

/** A command of Passo that serves a page. */
class Command {
  #child: ChildProcess | undefined;

  /** Starts it, and returns the address of its page. */
  async start(words: string[], path = process.env["PATH"]): Promise<string> {
    const child = spawn(PYTHON, ["-m", "passo", ...words], { stdio: ["ignore", "ignore", "pipe"], env: { ...process.env, PATH: path } });
    this.#child = child;
    const said: string[] = [];
    for await (const line of createInterface({ input: child.stderr })) {
      said.push(line);
      const found = /http:\/\/[\d.]+:\d+/.exec(line);
      if (found) return `${found[0]}/`;
    }
    throw new Error(`passo ${words[0]} has ended:\n${said.join("\n")}`);
  }

  async end(): Promise<void> {
    const child = this.#child;
    if (!child || child.exitCode !== null) return;
    const exit = new Promise((resolve) => child.once("exit", resolve));
    child.kill("SIGTERM");
    await exit;
  }
}

export interface ServedOptions {
  /** A machine of the library. */
  machine?: string;
  /** Whether it is served by its name, so that it has no file of its own. */
  shipped?: boolean;
  /** How many times as fast as real. */
  clock?: number;
  /** Whether settings, history and journal are kept. */
  state?: boolean;
  /** Files on the card beside the example, by name. */
  files?: Record<string, string>;
}

export class Served {
  url = "";
  #command = new Command();
  #folder = mkdtempSync(join(tmpdir(), "passo-page-"));
  #machine: string;
  #card = join(this.#folder, "card");
  #programs = join(this.#folder, "bin");
  #clock: number;
  #state: string[];

  constructor({ machine = "i3", shipped = false, clock = 20, state = false, files = {} }: ServedOptions = {}) {
    this.#clock = clock;
    this.#state = state ? ["--state", join(this.#folder, "state")] : [];
    cpSync(EXAMPLE, join(this.#card, "demo.gcode"));
    for (const [name, text] of Object.entries(files)) writeFileSync(join(this.#card, name), text);
    mkdirSync(this.#programs);
    // In place of the program that flashes a Teensy.
    writeFileSync(join(this.#programs, "teensy_loader_cli"), "#!/bin/sh\necho Programming\n", { mode: 0o755 });
    this.#machine = shipped ? machine : join(this.#folder, "my.toml");
    if (shipped) return;
    cpSync(join(MACHINES, `${machine}.toml`), this.#machine);
    chmodSync(this.#machine, 0o644);
  }

  /** Starts it, at the address that it had before, if it was started before. */
  async start(): Promise<void> {
    const place = this.url ? new URL(this.url).host : "127.0.0.1:0";
    const options = ["--machine", this.#machine, "--clock", `${this.#clock}`, "--sd", this.#card, "--tcp", "127.0.0.1:0", ...this.#state];
    this.url = await this.#command.start(["serve", ...options, "--http", place], `${this.#programs}:${process.env["PATH"]}`);
  }

  stop(): Promise<void> {
    return this.#command.end();
  }

  async remove(): Promise<void> {
    await this.stop();
    rmSync(this.#folder, { recursive: true });
  }
}

/** A farm without printers. */
export class ServedHub {
  url = "";
  #command = new Command();
  #folder = mkdtempSync(join(tmpdir(), "passo-hub-"));

  async start(): Promise<void> {
    this.url = await this.#command.start(["hub", "--state", this.#folder, "--http", "127.0.0.1:0"]);
  }

  async remove(): Promise<void> {
    await this.#command.end();
    rmSync(this.#folder, { recursive: true });
  }
}
