/** The printer as the page knows it: the last status that arrived, and whether it is live. */

import { openFeed } from "../api/feed";
import { merge } from "../api/merge";
import type { FeedLine, FeedMessage, PrinterEvent } from "../api/messages";
import type { HeaterStatus, Status } from "../api/schema";
import { connection } from "./connection.svelte";
import { session } from "./session.svelte";

type EventListener = (event: PrinterEvent) => void;
type LineListener = (line: FeedLine) => void;

class Printer {
  /** Undefined until the first status has arrived. */
  status = $state<Status>();
  #listeners = new Set<EventListener>();
  #lineListeners = new Set<LineListener>();

  /** Follows the printer until the function that it returns is called. */
  follow(): () => void {
    return openFeed<FeedMessage>({
      hello: { type: "listen", console: true },
      message: (message) => this.take(message),
      connected: (yes) => {
        connection.live = yes;
      },
    });
  }

  get connected(): boolean {
    return connection.live;
  }

  /** When the last message arrived. */
  get heard(): Date {
    return connection.heard;
  }

  take(message: FeedMessage): void {
    connection.message();
    if (message.type === "status") {
      this.status = message.status;
    } else if (message.type === "changes" && this.status) {
      merge(this.status as unknown as Record<string, unknown>, message.changes);
    } else if (message.type === "event") {
      for (const listener of this.#listeners) listener(message.event);
    } else if (message.type === "line") {
      for (const listener of this.#lineListeners) listener(message.line);
    }
  }

  onEvent(listener: EventListener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Each line that a console sends or is sent. */
  onLine(listener: LineListener): () => void {
    this.#lineListeners.add(listener);
    return () => this.#lineListeners.delete(listener);
  }

  /** Nothing moves or heats until it is started again. */
  get halted(): boolean {
    return this.status?.state === "H";
  }

  /** A file is printed, or its print is paused. */
  get printing(): boolean {
    return this.status?.job != null;
  }

  /** The heater that a print waits for: nothing moves then, and the coldest one is it. */
  get awaited(): (HeaterStatus & { name: string }) | undefined {
    const { job, state, heaters, motion } = this.status ?? {};
    if (!job || state === "A" || !heaters || !motion || motion.queued_s !== 0 || motion.speed_mm_s !== 0) return undefined;
    return Object.entries(heaters)
      .map(([name, heater]) => ({ ...heater, name }))
      .filter(({ celsius, target_c }) => target_c > 0 && (celsius ?? 0) < target_c - 2)
      .sort((a, b) => (a.celsius ?? 0) / a.target_c - (b.celsius ?? 0) / b.target_c)[0];
  }

  /** The board is software. */
  get simulated(): boolean {
    return Object.values(this.status?.boards ?? {}).some((board) => board.simulated);
  }

  /** Why the machine must not be moved by hand now; undefined if it may. */
  get lock(): "offline" | "viewer" | "halted" | "printing" | undefined {
    if (!this.status || !this.connected) return "offline";
    if (!session.may("operator")) return "viewer";
    if (this.halted) return "halted";
    return this.status.state === "P" ? "printing" : undefined;
  }

  /** Why no print can be started now; undefined if one can. */
  get printLock(): Printer["lock"] {
    return this.lock ?? (this.printing ? "printing" : undefined);
  }
}

export const printer = new Printer();
