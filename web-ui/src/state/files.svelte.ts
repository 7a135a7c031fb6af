/** The files of the card: one folder of them, and what is known of each. */

import { call, query } from "../api/client";
import type { FileEntry, Folder, Metadata, Picture } from "../api/schema";
import { attempt } from "./notices.svelte";

const AGAIN_MS = 1500; // while a plan is being made
const PROGRAM = /\.(gcode|g|gc|gco|nc|ngc|cnc|tap)$/i;

export function isProgram(name: string): boolean {
  return PROGRAM.test(name);
}

/** The path of a name in a folder. */
export function within(folder: string, name: string): string {
  return `${folder.replace(/\/$/, "")}/${name}`;
}

/** A name like this one that is not among the others: `part-2.gcode`. */
export function freeName(name: string, others: readonly string[]): string {
  const dot = name.lastIndexOf(".");
  const [stem, end] = dot > 0 ? [name.slice(0, dot), name.slice(dot)] : [name, ""];
  for (let number = 2; ; number++) {
    const tried = `${stem}-${number}${end}`;
    if (!others.includes(tried)) return tried;
  }
}

/** The largest picture that a browser can show. */
export function largest(pictures: readonly Picture[]): Picture | undefined {
  return pictures.filter(({ type }) => type !== "image/qoi").sort((a, b) => b.width - a.width)[0];
}

class Files {
  folder = $state("/");
  entries = $state.raw<FileEntry[]>([]);
  free_bytes = $state(0);
  loaded = $state(false);
  /** By path. */
  metadata = $state<Record<string, Metadata>>({});
  selected = $state<string>();
  #loading = 0;

  async open(folder: string): Promise<void> {
    this.selected = undefined;
    await this.load(folder);
  }

  async load(folder = this.folder): Promise<void> {
    const mine = ++this.#loading;
    const read = await call<Folder>("GET", `files?${query({ folder })}`);
    if (mine !== this.#loading) return; // another folder was opened meanwhile
    this.folder = read.path;
    this.entries = read.entries;
    this.free_bytes = read.free_bytes;
    this.loaded = true;
    const programs = read.entries.filter((entry) => !entry.folder && isProgram(entry.name));
    void this.learn(programs.map(({ path }) => path), () => mine === this.#loading);
  }

  /** What is in the folder that is open, also if it has not been loaded. */
  async names(): Promise<string[]> {
    const { entries } = await call<Folder>("GET", `files?${query({ folder: this.folder })}`);
    return entries.map((entry) => entry.name);
  }

  /** Finds out about programs, one after the other, until all is known or no longer wanted. The server
   * plans the file of the newest request first: that is the selected one, then the first of `paths`. */
  async learn(paths: readonly string[], wanted: () => boolean): Promise<void> {
    let waiting = [...paths].reverse();
    while (waiting.length) {
      const pending: string[] = [];
      const last = waiting.filter((path) => path === this.selected);
      for (const path of [...waiting.filter((path) => path !== this.selected), ...last]) {
        if (!wanted()) return;
        const found = await call<Metadata>("GET", `files/metadata?${query({ path })}`).catch(
          () => undefined, // it was removed meanwhile
        );
        if (!found) continue;
        this.metadata[path] = found;
        if (found.state === "pending") pending.push(path);
      }
      waiting = pending;
      if (waiting.length) await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
    }
  }

  async remove(entry: FileEntry): Promise<void> {
    const path = entry.folder ? "folders" : "files";
    if (await attempt(call("DELETE", `${path}?${query({ path: entry.path })}`))) {
      if (this.selected === entry.path) this.selected = undefined;
      delete this.metadata[entry.path];
      await this.load();
    }
  }

  async rename(entry: FileEntry, name: string): Promise<void> {
    const to = within(this.folder, name);
    if (await attempt(call("POST", "files/rename", { path: entry.path, to }))) {
      await this.load();
      this.selected = to;
    }
  }

  async makeFolder(name: string): Promise<void> {
    if (await attempt(call("POST", "folders", { path: within(this.folder, name) }))) await this.load();
  }
}

export const files = new Files();
