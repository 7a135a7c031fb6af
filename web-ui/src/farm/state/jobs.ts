/** The order of jobs. */

import type { JobView } from "../schema";

/** Among jobs of one priority: the one that is due first, then the oldest. */
function natural(a: JobView, b: JobView): number {
  const [first, second] = [a.due_s ?? Infinity, b.due_s ?? Infinity];
  if (first !== second) return first - second;
  return a.added_s - b.added_s || (a.id < b.id ? -1 : 1);
}

/** As the hub takes them: the greatest priority first. */
export function inOrder(jobs: readonly JobView[]): JobView[] {
  return [...jobs].sort((a, b) => b.priority - a.priority || natural(a, b));
}

/** The priorities that change, by id, so that the job at `from` comes to the place `to`. */
export function moved(jobs: readonly JobView[], from: number, to: number): Map<string, number> {
  const order = [...jobs];
  order.splice(to, 0, ...order.splice(from, 1));
  const changes = new Map<string, number>();
  let [below, least] = [order.at(-1), order.at(-1)?.priority ?? 0];
  for (const job of order.slice(0, -1).reverse()) {
    if (below) least += natural(job, below) < 0 ? 0 : 1;
    if (job.priority < least) changes.set(job.id, least);
    else least = job.priority;
    below = job;
  }
  return changes;
}
