/** The machine file while it is edited: its text is the truth, the form changes the text. */

import { call, Refusal } from "../api/client";
import type { Applied, Difference, KeyValue, MachineFile, MachineProblem, SavedMachine, ShippedFile, ShippedMachine, Validation } from "../api/schema";
import { literals, valueOf, withKey } from "../machine/toml";
import type { Schema } from "../machine/schema";
import { attempt } from "./notices.svelte";
import { printer } from "./printer.svelte";
import { session } from "./session.svelte";

const PAUSE_MS = 400; // after a change, before the server checks it
const MAX_UNDO = 100;

class MachineEditor {
  schema = $state.raw<Schema>();
  keys = $state.raw<KeyValue[]>([]);
  /** Undefined where the account may not read it. */
  file = $state.raw<MachineFile>();
  text = $state("");
  validation = $state.raw<Validation>();
  checking = $state(false);
  difference = $state.raw<Difference>();
  applied = $state.raw<Applied>();
  /** The path of the user's file that was saved, until Passo has restarted with it. */
  saved = $state("");
  library = $state.raw<ShippedMachine[]>([]);
  #undo = $state.raw<string[]>([]);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #check = 0;

  literals = $derived(literals(this.text));
  #original = $derived(literals(this.file?.text ?? ""));
  changed = $derived(this.file !== undefined && this.text !== this.file.text);
  changes = $derived(
    [...new Set([...this.literals.keys(), ...this.#original.keys()])].filter((key) => this.isChanged(key)).length,
  );
  canUndo = $derived(this.#undo.length > 0);
  problems = $derived<MachineProblem[]>([...(this.validation?.problems ?? []), ...(this.validation?.questions ?? [])]);

  async load(): Promise<void> {
    const reads = session.may("operator");
    const [schema, keys, library, file] = await Promise.all([
      call<Schema>("GET", "machine/schema"),
      call<KeyValue[]>("GET", "machine/keys"),
      call<ShippedMachine[]>("GET", "machine/library"),
      reads ? call<MachineFile>("GET", "machine/file") : undefined,
    ]);
    const kept = this.changed; // the user has begun to edit
    [this.schema, this.keys, this.library] = [schema, keys, library];
    if (kept) return;
    this.file = file;
    if (file?.path != null) this.saved = "";
    this.text = file?.text ?? "";
    this.#undo = [];
    this.validation = undefined;
  }

  isChanged(key: string): boolean {
    return this.literals.get(key) !== this.#original.get(key);
  }

  /** Restarts Passo with the machine file. */
  async restart(): Promise<void> {
    this.applied = undefined;
    await attempt(call("POST", "machine/restart"));
  }

  /** Saves the text as the user's file of a shipped machine, and restarts with it. */
  async saveOwn(): Promise<void> {
    const done = await attempt(
      call<SavedMachine>("POST", "machine/own", { text: this.text }).then(({ path }) => {
        this.saved = path;
      }),
    );
    if (!done) return;
    if (this.file) this.file = { ...this.file, text: this.text }; // nothing is left to save
    if (!printer.printing) await this.restart();
  }

  /** The problems of a key and of the parts of its value. */
  problemsOf(name: string): MachineProblem[] {
    return this.problems.filter(({ key }) => key === name || key.startsWith(`${name}.`) || key.startsWith(`${name}[`));
  }

  /** A key is a part of the value of another one. */
  holds(key: string): boolean {
    const parts = key.split(".");
    return parts.some((_, count) => count > 0 && this.literals.has(parts.slice(0, count).join(".")));
  }

  /** The value of a key: that of the text, else the one that the server knows. */
  value(key: KeyValue): unknown {
    const literal = this.literals.get(key.key);
    if (literal !== undefined) return valueOf(literal) ?? literal;
    return this.#original.has(key.key) ? null : key.value; // taken out: the default acts
  }

  set(key: string, literal: string | undefined): void {
    this.write(withKey(this.text, key, literal));
  }

  reset(key: string): void {
    this.set(key, this.#original.get(key));
  }

  write(text: string): void {
    if (text === this.text) return;
    this.#undo = [...this.#undo.slice(-MAX_UNDO), this.text];
    this.text = text;
    this.#checkSoon();
  }

  undo(): void {
    const before = this.#undo.at(-1);
    if (before === undefined) return;
    this.#undo = this.#undo.slice(0, -1);
    this.text = before;
    this.#checkSoon();
  }

  discard(): void {
    if (this.file) this.write(this.file.text);
  }

  async copy(name: string): Promise<void> {
    await attempt(call<ShippedFile>("GET", `machine/library/${name}`).then(({ text }) => this.write(text)));
  }

  async review(): Promise<void> {
    await attempt(
      call<Difference>("POST", "machine/diff", { text: this.text }).then((found) => {
        this.difference = found;
      }),
    );
  }

  async apply(): Promise<void> {
    const body = { text: this.text, replaces: this.file?.sha256 ?? "" };
    const done = await attempt(
      call<Applied>("PUT", "machine/file", body).then((applied) => {
        this.applied = applied;
      }),
    );
    this.difference = undefined;
    if (!done) return;
    const before = this.file?.text;
    this.file = undefined;
    await attempt(this.load());
    if (before !== undefined) this.#undo = [before]; // undo brings the file before back into the editor
  }

  #checkSoon(): void {
    if (!session.may("admin")) return;
    clearTimeout(this.#timer);
    const mine = ++this.#check;
    this.checking = true;
    this.#timer = setTimeout(async () => {
      try {
        const found = await call<Validation>("POST", "machine/validate", { text: this.text });
        if (mine === this.#check) this.validation = found;
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
      } finally {
        if (mine === this.#check) this.checking = false;
      }
    }, PAUSE_MS);
  }
}

export const editor = new MachineEditor();
