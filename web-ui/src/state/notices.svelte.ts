/** What went wrong with the actions of the user. */

import { Refusal } from "../api/client";
import type { FaultStatus } from "../api/schema";
import { connection } from "./connection.svelte";

const MAX_NOTICES = 3;

/** A refusal that the user has not closed yet; it has come `times` times. */
interface Notice extends FaultStatus {
  id: number;
  times: number;
}

class Notices {
  /** Newest last. */
  list = $state<Notice[]>([]);
  #next = 0;

  add(fault: FaultStatus): void {
    const same = this.list.find(({ code, text }) => code === fault.code && text === fault.text);
    const others = this.list.filter((notice) => notice !== same);
    const notice = { ...fault, id: same?.id ?? this.#next++, times: (same?.times ?? 0) + 1 };
    this.list = [...others.slice(1 - MAX_NOTICES), notice];
  }

  clear(): void {
    this.list = [];
  }

  close(id: number): void {
    this.list = this.list.filter((notice) => notice.id !== id);
  }
}

export const notices = new Notices();

/** Waits for an action; a refusal becomes a notice. True if the action was carried out. */
export async function attempt(action: Promise<unknown>): Promise<boolean> {
  try {
    await action;
    return true;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    if (error.status !== 0 || !connection.lost) notices.add(error.fault); // a lost connection has its banner
    return false;
  }
}
