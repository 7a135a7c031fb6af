/** Files that the user has given: those whose name is taken wait for a decision. */

import { attempt } from "./notices.svelte";
import { query } from "../api/client";
import { files, freeName, within } from "./files.svelte";
import { uploads } from "./uploads.svelte";

class Choice {
  /** The files whose names are on the card already. */
  taken = $state.raw<File[]>([]);
  #names: string[] = [];

  /** Uploads files into the folder that is open, and asks where one of that name is there. */
  async upload(given: readonly File[]): Promise<void> {
    // The page may not have shown this folder yet, or others may have changed it since.
    if (!(await attempt(files.names().then((names) => (this.#names = names))))) return;
    const taken = (file: File) => this.#names.includes(file.name);
    for (const file of given) if (!taken(file)) this.#add(file);
    this.taken = given.filter(taken);
  }

  replace(): void {
    for (const file of this.taken) this.#add(file);
    this.taken = [];
  }

  keepBoth(): void {
    for (const file of this.taken) {
      const name = freeName(file.name, this.#names);
      this.#names.push(name);
      this.#add(file, name);
    }
    this.taken = [];
  }

  leave(): void {
    this.taken = [];
  }

  /** Puts a file into the folder that is open. */
  #add(file: File, name = file.name): void {
    const path = within(files.folder, name);
    uploads.add(file, name, ["PUT", `files/content?${query({ path })}`], async () => {
      await files.load().catch(() => undefined);
      files.selected = path;
    });
  }
}

export const choice = new Choice();
