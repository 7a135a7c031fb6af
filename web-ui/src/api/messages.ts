/** What the feed of the printer brings. */

import type { Line, Status } from "./schema";

export type PrinterEvent = { kind: string } & Record<string, unknown>;
export type FeedLine = Line & { host_s: number; sender: string };

export type FeedMessage =
  | { type: "status"; version: number; status: Status }
  | { type: "changes"; version: number; changes: Record<string, unknown> }
  | { type: "event"; event: PrinterEvent }
  | { type: "line"; line: FeedLine }
  | { type: "lost"; count: number };
