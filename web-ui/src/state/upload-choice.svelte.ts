/** Files that the user has given: those whose name is taken wait for a decision. */

import { attempt } from "./actions.svelte";
import { files, freeName } from "./files.svelte";
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
    for (const file of given) if (!taken(file)) uploads.add(file);
    this.taken = given.filter(taken);
  }

  replace(): void {
    for (const file of this.taken) uploads.add(file);
    this.taken = [];
  }

  keepBoth(): void {
    for (const file of this.taken) {
      const name = freeName(file.name, this.#names);
      this.#names.push(name);
      uploads.add(file, name);
    }
    this.taken = [];
  }

  leave(): void {
    this.taken = [];
  }
}

export const choice = new Choice();
