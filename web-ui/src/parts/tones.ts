/** The colour of the chip of each phase or outcome of a print; the others are grey. */

export const TONES: Record<string, string> = {
  printing: "good",
  done: "good",
  heating: "warn",
  paused: "warn",
  waiting: "warn",
  cancelled: "warn",
  failed: "bad",
  interrupted: "bad",
  halted: "bad",
};
