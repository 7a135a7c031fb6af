/** Values that the user changes to see the move planned again; undefined: that of the machine. */

export interface Changed {
  /** mm/s² */
  acceleration?: number;
  /** Percent of the feedrate. */
  speed?: number;
  /** Junction deviation in mm, or jerk in mm/s: what M205 takes. */
  junction?: number;
}

/** Where the sliders stand before they are moved. */
export const DEFAULTS = { acceleration: 3000, speed: 100 };

/** The commands that make it so, a line each. */
export function commandsOf({ acceleration, speed, junction }: Changed, corner: "J" | "X"): string[] {
  const lines: string[] = [];
  if (acceleration !== undefined) lines.push(`M204 P${acceleration} T${acceleration}`);
  if (speed !== undefined) lines.push(`M220 S${speed}`);
  if (junction !== undefined) lines.push(corner === "J" ? `M205 J${junction}` : `M205 X${junction} Y${junction}`);
  return lines;
}
