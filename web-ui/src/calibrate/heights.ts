/** Heights of the bed: their spread, and the colour of each. */

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

/** From blue, the lowest, over white to red, the highest; dark text is legible on each. */
export function colourOf(height: number, { low, high }: Spread): string {
  const most = Math.max(Math.abs(low), Math.abs(high)) || 1;
  const share = Math.min(Math.abs(height) / most, 1);
  const [red, green, blue] = height < 0 ? [110, 175, 245] : [250, 140, 120];
  const mixed = [red, green, blue].map((value) => Math.round(250 + (value - 250) * share));
  return `rgb(${mixed.join(" ")})`;
}
