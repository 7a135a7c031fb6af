/** Uploads, one after the other. */

import { readRefusal, ROOT } from "../api/client";
import type { FaultStatus } from "../api/schema";

export interface Upload {
  id: number;
  name: string;
  /** Where it goes: the method and the path of the API. */
  to: readonly ["PUT" | "POST", string];
  size: number;
  sent: number;
  state: "waiting" | "sending" | "done" | "failed" | "cancelled";
  fault?: FaultStatus;
}

/** Takes what the server has answered to an upload. */
type Arrived = (answer: string) => unknown;

class Uploads {
  list = $state<Upload[]>([]);
  #files = new Map<number, { file: File; arrived: Arrived }>();
  #next = 0;
  #request: { id: number; cancel: () => void } | undefined;

  add(file: File, name: string, to: Upload["to"], arrived: Arrived): void {
    const id = this.#next++;
    this.#files.set(id, { file, arrived });
    this.list.push({ id, name, to, size: file.size, sent: 0, state: "waiting" });
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
      const given = upload && this.#files.get(upload.id);
      if (!upload || !given) return;
      upload.state = "sending";
      const { fault, answer } = await this.#send(upload, given.file);
      this.#request = undefined;
      if (this.#find(upload.id)?.state === "cancelled") continue;
      if (fault) {
        upload.fault = fault;
        upload.state = "failed";
      } else {
        upload.state = "done";
        await given.arrived(answer);
        const { id } = upload;
        setTimeout(() => this.forget(id), 4000);
      }
    }
  }

  /** What the server answers, or what is wrong if the file has not arrived. */
  #send(upload: Upload, file: File): Promise<{ answer: string; fault?: FaultStatus }> {
    const request = new XMLHttpRequest(); // fetch does not report how much is sent
    this.#request = { id: upload.id, cancel: () => request.abort() };
    request.open(upload.to[0], ROOT + upload.to[1]);
    request.setRequestHeader("X-Passo-Request", "1");
    request.setRequestHeader("Content-Type", "application/octet-stream");
    return new Promise((resolve) => {
      request.upload.onprogress = (event) => (upload.sent = event.loaded);
      request.onload = () => {
        const { status, responseText: answer } = request;
        resolve(status < 300 ? { answer } : { answer, fault: readRefusal(status, answer).fault });
      };
      request.onerror = () => resolve({ answer: "", fault: readRefusal(0, "").fault });
      request.onabort = () => resolve({ answer: "" });
      request.send(file);
    });
  }
}

export const uploads = new Uploads();
