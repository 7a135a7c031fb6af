/** The farm as the page knows it. Each printer is a value of its own, so that a change of one draws only
 * what shows that one. */

import { SvelteMap } from "svelte/reactivity";
import { openFeed } from "../../api/feed";
import { connection } from "../../state/connection.svelte";
import type { Farm, JobView, PowerGroup, PrinterView } from "../schema";

/** What has changed since the last message: whole printers and jobs, and the ids of those that are gone. */
interface Changes extends Omit<Farm, "groups"> {
  type: "changes";
  groups?: PowerGroup[] | null;
  gone: string[];
}

export type FarmMessage = { type: "farm"; farm: Farm } | Changes;

class FarmState {
  readonly printers = new SvelteMap<string, PrinterView>();
  readonly jobs = new SvelteMap<string, JobView>();
  groups = $state.raw<PowerGroup[]>([]);
  queuePaused = $state(false);
  /** The first message has arrived. */
  loaded = $state(false);
  #heard = new WeakMap<PrinterView, Date>();

  /** Follows the farm until the function that it returns is called. */
  follow(): () => void {
    return openFeed<FarmMessage>({
      message: (message) => this.take(message),
      connected: (yes) => {
        connection.live = yes;
      },
    });
  }

  take(message: FarmMessage): void {
    connection.message();
    if (message.type === "farm") {
      this.#keep(this.printers, message.farm.printers);
      this.#keep(this.jobs, message.farm.jobs);
      this.loaded = true;
    }
    const { printers, jobs, groups, queue_paused } = message.type === "farm" ? message.farm : message;
    for (const printer of printers) {
      this.#heard.set(printer, connection.heard);
      this.printers.set(printer.id, printer);
    }
    for (const job of jobs) this.jobs.set(job.id, job);
    if (groups) this.groups = groups;
    this.queuePaused = queue_paused;
    if (message.type === "changes") {
      for (const id of message.gone) if (!this.printers.delete(id)) this.jobs.delete(id);
    }
  }

  /** When this view of a printer has arrived. */
  heard(printer: PrinterView): Date {
    return this.#heard.get(printer) ?? connection.heard;
  }

  /** All tags, in their order. */
  get tags(): string[] {
    return [...new Set([...this.printers.values()].flatMap(({ tags }) => tags))].sort((a, b) => a.localeCompare(b));
  }

  name(printer: string): string {
    return this.printers.get(printer)?.name ?? printer;
  }

  #keep(map: Map<string, unknown>, list: readonly { id: string }[]): void {
    const there = new Set(list.map(({ id }) => id));
    for (const id of [...map.keys()]) if (!there.has(id)) map.delete(id);
  }
}

export const farm = new FarmState();
