/** Colours of lights: red, green, blue and white, each a fraction of full brightness. */

export type Color = number[];

export const BLACK: Color = [0, 0, 0, 0];
export const PRIMARIES = { R: [1, 0, 0, 0], G: [0, 1, 0, 0], B: [0, 0, 1, 0], W: [0, 0, 0, 1] } as const;

/** The colour of a light that is switched on without one of its own: white. */
export function whiteOf(colors: string): Color {
  return colors.includes("W") ? [0, 0, 0, 1] : [1, 1, 1, 0];
}

export const isOn = (color: Color) => color.some((share) => share > 0);

const byte = (share: number) => Math.round(Math.min(Math.max(share, 0), 1) * 255);
const mixed = ([red = 0, green = 0, blue = 0, white = 0]: Color) => [red + white, green + white, blue + white].map(byte);

/** How a screen shows a colour: white adds to the other three. */
export const cssOf = (color: Color) => `rgb(${mixed(color).join(" ")})`;

/** The value of a colour field, `#rrggbb`, without the white LED. */
export const hexOf = ([red = 0, green = 0, blue = 0]: Color) =>
  `#${[red, green, blue].map((share) => byte(share).toString(16).padStart(2, "0")).join("")}`;

/** The colour of the value of a colour field, with a white LED of brightness `white`. */
export function colorOf(hex: string, white: number): Color {
  const share = (at: number) => parseInt(hex.slice(at, at + 2), 16) / 255;
  return [share(1), share(3), share(5), white];
}
