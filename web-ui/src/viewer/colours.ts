/** What the colour of a move means: for each row an index of a palette of 256 colours. */

import { ramp, type Colour } from "$draw/shades.js";
import { PRINT, type Toolpath } from "./toolpath";

export const MODES = ["feature", "speed", "flow", "layer-time", "speed_limit", "acceleration", "acceleration_limit", "temperature"] as const;
export type Mode = (typeof MODES)[number];

/** An entry of the legend; `indices` are those of the palette that it stands for. */
export interface Entry {
  text: string;
  colour: Colour;
  index: number;
}

export interface Colouring {
  /** An index of the palette for each row. */
  values: Uint8Array<ArrayBuffer>;
  palette: Colour[];
  /** Of names: one entry each. Of numbers: none, but a range. */
  entries: Entry[];
  range?: { low: number; high: number; unit: string };
}

const SAME_S = 0.002; // by which a target's time may seem to be after the move before it
const NAMED: readonly Colour[] = [
  [247, 144, 61],
  [79, 179, 255],
  [105, 200, 104],
  [222, 94, 120],
  [163, 133, 240],
  [236, 201, 75],
  [64, 192, 178],
  [201, 124, 201],
  [154, 168, 180],
  [176, 141, 97],
  [122, 162, 84],
  [236, 112, 84],
];

/** `filament_mm2` is the area of the filament's section; `heaters` are those of the tools. */
export function colouring(path: Toolpath, mode: Mode, filament_mm2: number, heaters: readonly string[]): Colouring {
  switch (mode) {
    case "feature":
      return named(path, "feature", path.header.features);
    case "speed_limit":
    case "acceleration_limit":
      return named(path, mode, path.header.limits);
    case "speed":
      return ranged(path, column(path, "speed"), "mm/s");
    case "flow":
      return ranged(path, column(path, "flow", filament_mm2), "mm³/s");
    case "acceleration":
      return ranged(path, column(path, "acceleration"), "mm/s²");
    case "temperature":
      return ranged(path, temperatures(path, heaters), "°C");
    case "layer-time":
      return ranged(path, layerTimes(path), "s");
  }
}

function column(path: Toolpath, name: string, factor = 1): (row: number) => number {
  const values = path.column(name);
  const unit = path.unit(name) * factor;
  return (row) => (values[row] ?? 0) * unit;
}

function layerTimes(path: Toolpath): (row: number) => number {
  const times = new Float32Array(path.rows);
  path.header.layers.forEach((layer, index) => times.fill(path.seconds(index), layer.row, path.endOf(index)));
  return (row) => times[row] ?? 0;
}

/** The target of the tool's heater at each row. */
function temperatures(path: Toolpath, heaters: readonly string[]): (row: number) => number {
  const values = new Float32Array(path.rows);
  const times = path.column("time");
  const targets = path.header.targets ?? [];
  const now = new Map<string, number>();
  let next = 0;
  for (let row = 0; row < path.rows; row++) {
    const begun_s = row ? (times[row - 1] ?? 0) : 0;
    for (let set = targets[next]; set && set.time_s <= begun_s + SAME_S; set = targets[++next]) now.set(set.heater, set.celsius);
    values[row] = now.get(heaters[path.tool(row)] ?? "") ?? 0;
  }
  return (row) => values[row] ?? 0;
}

function ranged(path: Toolpath, value: (row: number) => number, unit: string): Colouring {
  let [low, high] = [Infinity, -Infinity];
  for (let row = 0; row < path.rows; row++) {
    if (path.kind(row) !== PRINT) continue;
    const here = value(row);
    if (here < low) low = here;
    if (here > high) high = here;
  }
  if (low > high) [low, high] = [0, 0];
  const values = new Uint8Array(path.rows);
  const scale = high > low ? 255 / (high - low) : 0;
  for (let row = 0; row < path.rows; row++) {
    values[row] = Math.min(Math.max((value(row) - low) * scale, 0), 255);
  }
  const palette = Array.from({ length: 256 }, (_, index) => ramp(index / 255));
  return { values, palette, entries: [], range: { low, high, unit } };
}

function named(path: Toolpath, name: string, names: readonly string[]): Colouring {
  const values = path.column(name) as Uint8Array<ArrayBuffer>;
  const counts = new Float64Array(256);
  for (let row = 0; row < path.rows; row++) {
    if (path.kind(row) === PRINT) counts[values[row] ?? 0]! += 1;
  }
  const palette = Array.from({ length: 256 }, (): Colour => NAMED[0] as Colour);
  const entries: Entry[] = [];
  names.forEach((text, index) => {
    if (!counts[index]) return;
    const colour = NAMED[entries.length % NAMED.length] as Colour;
    palette[index] = colour;
    entries.push({ text, colour, index });
  });
  return { values, palette, entries };
}
