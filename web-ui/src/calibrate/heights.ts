/** Heights of the bed: their spread. */

export interface Spread {
  low: number;
  high: number;
  /** Root mean square of the distances from the mean. */
  rms: number;
}

export function spreadOf(heights: readonly (readonly number[])[]): Spread {
  const all = heights.flat();
  const mean = all.reduce((sum, z) => sum + z, 0) / all.length;
  const squares = all.reduce((sum, z) => sum + (z - mean) ** 2, 0);
  return { low: Math.min(...all), high: Math.max(...all), rms: Math.sqrt(squares / all.length) };
}
