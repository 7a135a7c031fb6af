/** The boards that Passo has, the build of an image, and the board that is flashed. */

import { call } from "../api/client";
import type { Boards, Build, Flash, Port } from "../api/schema";
import { administration } from "./accounts.svelte";
import { attempt } from "./notices.svelte";
import { session } from "./session.svelte";

const AGAIN_MS = 1000; // while a build runs, or a board is flashed

const pause = () => new Promise((resolve) => setTimeout(resolve, AGAIN_MS));

class Firmware {
  boards = $state.raw<Boards>();
  ports = $state.raw<Port[]>([]);
  /** The last build that this page has started. */
  build = $state.raw<Build>();
  flash = $state.raw<Flash>();

  async load(): Promise<void> {
    this.boards = await call<Boards>("GET", "firmware/boards");
    await this.loadPorts();
    if (this.flashing) return;
    this.flash = await call<Flash>("GET", "firmware/flash");
    await this.#follow();
  }

  async #follow(): Promise<void> {
    while (this.flashing) {
      await pause();
      this.flash = await call<Flash>("GET", "firmware/flash");
    }
  }

  async loadPorts(): Promise<void> {
    if (session.may("admin")) this.ports = await call<Port[]>("GET", "firmware/ports");
  }

  get flashing(): boolean {
    return this.flash?.state === "running" || this.flash?.state === "waiting";
  }

  /** Builds the image of a shipped board, or, without one, of the boards of the machine. */
  async start(board: string | undefined): Promise<void> {
    const body = board === undefined ? {} : { board };
    await attempt(
      (async () => {
        this.build = await call<Build>("POST", "firmware/build", body);
        this.flash = undefined;
        while (this.build.state === "running") {
          await pause();
          this.build = await call<Build>("GET", "firmware/build");
        }
      })(),
    );
  }

  cancel = () => attempt(call("DELETE", "firmware/build"));

  /** Flashes an image of the last build. */
  async flashImage(image: string, port: string | null): Promise<void> {
    await administration.guard(async () => {
      this.flash = await call<Flash>("POST", "firmware/flash", { image, port });
      await this.#follow();
    });
  }

  confirm = () => attempt(call("POST", "firmware/flash/confirm"));
  cancelFlash = () => attempt(call("DELETE", "firmware/flash"));
}

export const firmware = new Firmware();
