/** What the feed of the printer brings. */

import type { Status } from "./schema";

export type PrinterEvent = { kind: string } & Record<string, unknown>;

export type FeedMessage =
  | { type: "status"; version: number; status: Status }
  | { type: "changes"; version: number; changes: Record<string, unknown> }
  | { type: "event"; event: PrinterEvent }
  | { type: "lost"; events: number };
