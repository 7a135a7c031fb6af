/** What the task of input shapers computes. */

export const SHAPERS = ["zv", "mzv", "zvd", "ei", "2hump_ei", "3hump_ei"] as const;
export type Shaper = (typeof SHAPERS)[number];

// How many periods of the vibration a shaper lasts.
const PERIODS: Record<Shaper, number> = { zv: 0.5, mzv: 0.75, zvd: 1, ei: 1, "2hump_ei": 1.5, "3hump_ei": 2 };

/** The frequency of a vibration that leaves so many ripples along a length, in Hz. */
export function frequencyOf(speed_mm_s: number, ripples: number, length_mm: number): number {
  return (speed_mm_s * ripples) / length_mm;
}

/** How long each change of speed takes with a shaper, in ms. */
export function durationOf(shaper: Shaper, frequency_hz: number): number {
  return (1000 * PERIODS[shaper]) / frequency_hz;
}
