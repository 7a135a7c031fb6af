/** The path of a file as columns, decoded: docs/reference/toolpath.md. */

import { query, readRefusal, ROOT } from "../api/client";

export const JUMP = 0;
export const TRAVEL = 1;
export const PRINT = 2;

export interface Layer {
  number: number;
  /** The first row. */
  row: number;
  z_mm: number;
  start_s: number;
}

interface Column {
  name: string;
  type: "u1" | "u2" | "u4" | "f4";
  numbers: number;
  unit: number;
}

interface Header {
  rows: number;
  origin_mm: [number, number, number];
  unit_mm: number;
  end_s: number;
  layers: Layer[];
  features: string[];
  limits: string[];
  /** Missing in a path that an older Passo has planned. */
  targets?: { time_s: number; heater: string; celsius: number }[];
  columns: Column[];
}

type Numbers = Uint8Array<ArrayBuffer> | Uint16Array<ArrayBuffer> | Uint32Array<ArrayBuffer> | Float32Array<ArrayBuffer>;

const TYPES = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array } as const;
const MAGIC = "PASSOTP1";

/** A row is the end of a move. Columns are raw; `value` has their units. */
export class Toolpath {
  readonly #columns = new Map<string, { values: Numbers; unit: number }>();

  constructor(
    readonly header: Header,
    data: ArrayBuffer,
    offset: number,
  ) {
    for (const { name, type, numbers, unit } of header.columns) {
      const count = header.rows * numbers;
      const values = new TYPES[type](data, offset, count);
      this.#columns.set(name, { values, unit });
      offset += values.byteLength;
    }
  }

  get rows(): number {
    return this.header.rows;
  }

  /** The numbers of a column as they were sent. */
  column(name: string): Numbers {
    const found = this.#columns.get(name);
    if (!found) throw new Error(`no column ${name}`);
    return found.values;
  }

  value(name: string, row: number): number {
    return (this.column(name)[row] ?? 0) * (this.#columns.get(name)?.unit ?? 1);
  }

  unit(name: string): number {
    return this.#columns.get(name)?.unit ?? 1;
  }

  kind(row: number): number {
    return (this.column("at")[row * 4 + 3] ?? 0) & 255;
  }

  /** The moves: rows to which something moves. */
  get moves(): number {
    let count = 0;
    for (let row = 0; row < this.rows; row++) if (this.kind(row) !== JUMP) count++;
    return count;
  }

  tool(row: number): number {
    return (this.column("at")[row * 4 + 3] ?? 0) >> 8;
  }

  /** X, Y or Z of the end of a row, in mm. */
  mm(row: number, axis: 0 | 1 | 2): number {
    return this.header.origin_mm[axis] + this.header.unit_mm * (this.column("at")[row * 4 + axis] ?? 0);
  }

  /** The index of the layer that a row is in. */
  layerOf(row: number): number {
    return Math.max(0, firstAfter(this.header.layers.length, (i) => (this.header.layers[i]?.row ?? 0) > row) - 1);
  }

  /** The first row after a layer. */
  endOf(layer: number): number {
    return this.header.layers[layer + 1]?.row ?? this.rows;
  }

  /** The number of rows that have begun by a time. */
  rowsUntil(time_s: number): number {
    const times = this.column("time");
    return Math.min(this.rows, firstAfter(this.rows, (row) => (times[row] ?? 0) >= time_s) + 1);
  }

  /** The number of rows of the lines up to this one. */
  rowsOfLines(line: number): number {
    const lines = this.column("line");
    return firstAfter(this.rows, (row) => (lines[row] ?? 0) > line);
  }

  seconds(layer: number): number {
    const { layers, end_s } = this.header;
    return (layers[layer + 1]?.start_s ?? end_s) - (layers[layer]?.start_s ?? 0);
  }
}

/** The first index for which a test holds, which holds for all after it; `count` if for none. */
function firstAfter(count: number, holds: (index: number) => boolean): number {
  let [low, high] = [0, count];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(middle)) high = middle;
    else low = middle + 1;
  }
  return low;
}

export function decode(data: ArrayBuffer): Toolpath {
  const text = new TextDecoder();
  if (text.decode(new Uint8Array(data, 0, 8)) !== MAGIC) throw new Error("not a toolpath");
  const size = new DataView(data).getUint32(8, true);
  const header = JSON.parse(text.decode(new Uint8Array(data, 12, size))) as Header;
  return new Toolpath(header, data, 12 + size);
}

/** Throws a Refusal. */
export async function readToolpath(path: string, signal: AbortSignal): Promise<Toolpath> {
  const response = await fetch(`${ROOT}files/toolpath?${query({ path })}`, {
    headers: { "X-Passo-Request": "1" },
    signal,
  }).catch((error: unknown) => {
    if (signal.aborted) throw error;
    throw readRefusal(0, "");
  });
  if (!response.ok) throw readRefusal(response.status, await response.text());
  return decode(await response.arrayBuffer());
}
