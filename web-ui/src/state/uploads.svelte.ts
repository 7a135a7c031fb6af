/** Uploads to the card, one after the other. */

import { readRefusal, ROOT } from "../api/client";
import type { FaultStatus } from "../api/schema";
import { files, query, within } from "./files.svelte";

export interface Upload {
  id: number;
  name: string;
  path: string;
  size: number;
  sent: number;
  state: "waiting" | "sending" | "done" | "failed" | "cancelled";
  fault?: FaultStatus;
}

class Uploads {
  list = $state<Upload[]>([]);
  #files = new Map<number, File>();
  #next = 0;
  #request: { id: number; cancel: () => void } | undefined;

  /** Puts a file into the folder that is open. */
  add(file: File, name = file.name): void {
    const id = this.#next++;
    this.#files.set(id, file);
    this.list.push({ id, name, path: within(files.folder, name), size: file.size, sent: 0, state: "waiting" });
    void this.#work();
  }

  cancel(id: number): void {
    if (this.#request?.id === id) this.#request.cancel();
    const upload = this.#find(id);
    if (upload) upload.state = "cancelled";
  }

  again(id: number): void {
    const upload = this.#find(id);
    if (!upload) return;
    delete upload.fault;
    upload.state = "waiting";
    upload.sent = 0;
    void this.#work();
  }

  forget(id: number): void {
    this.list = this.list.filter((upload) => upload.id !== id);
    this.#files.delete(id);
  }

  #find(id: number): Upload | undefined {
    return this.list.find((upload) => upload.id === id);
  }

  async #work(): Promise<void> {
    if (this.#request) return;
    for (;;) {
      const upload = this.list.find(({ state }) => state === "waiting");
      const file = upload && this.#files.get(upload.id);
      if (!upload || !file) return;
      upload.state = "sending";
      const fault = await this.#send(upload, file);
      this.#request = undefined;
      if (this.#find(upload.id)?.state === "cancelled") continue;
      if (fault) {
        upload.fault = fault;
        upload.state = "failed";
      } else {
        upload.state = "done";
        await files.load().catch(() => undefined);
        files.selected = upload.path;
        const { id } = upload;
        setTimeout(() => this.forget(id), 4000);
      }
    }
  }

  /** What is wrong, if the file has not arrived. */
  #send(upload: Upload, file: File): Promise<FaultStatus | undefined> {
    const request = new XMLHttpRequest(); // fetch does not report how much is sent
    this.#request = { id: upload.id, cancel: () => request.abort() };
    request.open("PUT", `${ROOT}files/content?${query({ path: upload.path })}`);
    request.setRequestHeader("X-Passo-Request", "1");
    request.setRequestHeader("Content-Type", "application/octet-stream");
    return new Promise((resolve) => {
      request.upload.onprogress = (event) => (upload.sent = event.loaded);
      request.onload = () => {
        const { status, responseText } = request;
        resolve(status < 300 ? undefined : readRefusal(status, responseText).fault);
      };
      request.onerror = () => resolve(readRefusal(0, "").fault);
      request.onabort = () => resolve(undefined);
      request.send(file);
    });
  }
}

export const uploads = new Uploads();
