/** The files of the farm, and which printers each of them fits. */

import { call, query } from "../../api/client";
import { uploads } from "../../state/uploads.svelte";
import { attempt } from "../../state/notices.svelte";
import type { FileView } from "../schema";

/** Whether a printer can print a file, why not, and how long it takes. */
export interface Fit {
  printer: string;
  fits: boolean;
  why: string;
  print_s?: number | null;
}

class Library {
  /** Newest first. */
  files = $state.raw<FileView[]>([]);
  loaded = $state(false);
  /** By SHA-256. */
  fits = $state<Record<string, Fit[]>>({});

  async load(): Promise<void> {
    this.files = await call<FileView[]>("GET", "files");
    this.loaded = true;
  }

  get(sha256: string): FileView | undefined {
    return this.files.find((file) => file.sha256 === sha256);
  }

  /** Finds out which printers a file fits. */
  async learn(sha256: string): Promise<void> {
    this.fits[sha256] = await call<Fit[]>("GET", `files/${sha256}/fit`);
  }

  /** `arrived` gets the SHA-256 of the file. */
  upload(file: File, arrived: (sha256: string) => void = () => undefined): void {
    uploads.add(file, file.name, ["POST", `files?${query({ name: file.name })}`], async (answer) => {
      const stored = JSON.parse(answer) as FileView;
      if (await attempt(this.load())) arrived(stored.sha256);
    });
  }
}

export const library = new Library();
