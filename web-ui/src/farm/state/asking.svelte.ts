/** The question that a dialog of the farm asks. */

import type { PrinterView } from "../schema";

export type Question =
  | { kind: "clear"; printers: readonly PrinterView[] }
  | { kind: "start"; printers: readonly PrinterView[] }
  | { kind: "attend" | "started" | "cancel" | "remove"; printer: PrinterView }
  | { kind: "add" };

class Asking {
  question = $state.raw<Question>();

  clear = (printers: readonly PrinterView[]) => (this.question = { kind: "clear", printers });
  start = (printers: readonly PrinterView[]) => (this.question = { kind: "start", printers });
  attend = (printer: PrinterView) => (this.question = { kind: "attend", printer });
  started = (printer: PrinterView) => (this.question = { kind: "started", printer });
  cancel = (printer: PrinterView) => (this.question = { kind: "cancel", printer });
  remove = (printer: PrinterView) => (this.question = { kind: "remove", printer });
  add = () => (this.question = { kind: "add" });

  close = (): void => {
    this.question = undefined;
  };
}

export const asking = new Asking();
