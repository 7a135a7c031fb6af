/** The files of the farm, and which printers each of them fits. */

import { call, query } from "../../api/client";
import { uploads } from "../../state/uploads.svelte";
import { attempt } from "../../state/notices.svelte";
import type { FileView, PrinterFit } from "../schema";

const AGAIN_MS = 1000; // while the file is planned for some printers

class Library {
  /** Newest first. */
  files = $state.raw<FileView[]>([]);
  loaded = $state(false);
  /** By SHA-256. */
  fits = $state<Record<string, PrinterFit[]>>({});

  async load(): Promise<void> {
    this.files = await call<FileView[]>("GET", "files");
    this.loaded = true;
  }

  get(sha256: string): FileView | undefined {
    return this.files.find((file) => file.sha256 === sha256);
  }

  /** Finds out which printers a file fits, until all is known or no longer wanted. */
  async learn(sha256: string, wanted: () => boolean): Promise<void> {
    while (wanted()) {
      const found = await call<PrinterFit[]>("GET", `files/${sha256}/fit`);
      this.fits[sha256] = found;
      if (found.every(({ fits }) => fits != null)) return;
      await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
    }
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
