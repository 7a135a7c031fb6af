/** Colours that stand for a number. */

/** @typedef {readonly [number, number, number]} Colour */

/** @type {readonly Colour[]} */
const RAMP = [
  [58, 110, 224],
  [31, 178, 203],
  [82, 207, 102],
  [252, 196, 25],
  [240, 62, 62],
];
const [PALE, BELOW, ABOVE] = [[250, 250, 250], [110, 175, 245], [250, 140, 120]];

/** @type {(a: Colour, b: Colour, share: number) => Colour} */
const mixed = (a, b, share) => [0, 1, 2].map((i) => Math.round(a[i] + (b[i] - a[i]) * share));

/** @type {(colour: Colour) => string} */
export const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

/**
 * From blue, at 0, over green to red, at 1.
 * @type {(fraction: number) => Colour}
 */
export function ramp(fraction) {
  const at = Math.min(Math.max(fraction, 0), 1) * (RAMP.length - 1);
  const below = Math.min(Math.floor(at), RAMP.length - 2);
  return mixed(RAMP[below], RAMP[below + 1], at - below);
}

/**
 * A height of the bed: from blue, `most` below 0, over white to red, `most` above it; dark text is
 * legible on each.
 * @type {(height: number, most: number) => string}
 */
export function shadeOfHeight(height, most) {
  return css(mixed(PALE, height < 0 ? BELOW : ABOVE, Math.min(Math.abs(height) / (most || 1), 1)));
}
