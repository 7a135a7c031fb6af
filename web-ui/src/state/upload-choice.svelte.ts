/** Files that the user has given: those whose name is taken wait for a decision. */

import { files, freeName } from "./files.svelte";
import { uploads } from "./uploads.svelte";

class Choice {
  /** The files whose names are on the card already. */
  taken = $state.raw<File[]>([]);

  replace(): void {
    for (const file of this.taken) uploads.add(file);
    this.taken = [];
  }

  keepBoth(): void {
    const others = files.entries.map((entry) => entry.name);
    for (const file of this.taken) {
      const name = freeName(file.name, others);
      others.push(name);
      uploads.add(file, name);
    }
    this.taken = [];
  }

  leave(): void {
    this.taken = [];
  }
}

export const choice = new Choice();

/** Uploads files into the folder that is open, and asks where one of that name is there. */
export function upload(given: readonly File[]): void {
  const names = new Set(files.entries.map((entry) => entry.name));
  for (const file of given) if (!names.has(file.name)) uploads.add(file);
  choice.taken = given.filter((file) => names.has(file.name));
}
