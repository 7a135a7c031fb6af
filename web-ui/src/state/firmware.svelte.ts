/** The boards that Passo knows, and the build of an image. */

import { call } from "../api/client";
import type { Boards, Build } from "../api/schema";
import { attempt } from "./actions.svelte";

const AGAIN_MS = 1000; // while a build runs

class Firmware {
  boards = $state.raw<Boards>();
  /** The last build that this page has started. */
  build = $state.raw<Build>();

  async load(): Promise<void> {
    this.boards = await call<Boards>("GET", "firmware/boards");
  }

  /** Builds the image of a shipped board, or, without one, of the boards of the machine. */
  async start(board: string | undefined): Promise<void> {
    const body = board === undefined ? {} : { board };
    await attempt(
      (async () => {
        this.build = await call<Build>("POST", "firmware/build", body);
        while (this.build.state === "running") {
          await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
          this.build = await call<Build>("GET", "firmware/build");
        }
      })(),
    );
  }

  cancel = () => attempt(call("DELETE", "firmware/build"));
}

export const firmware = new Firmware();
