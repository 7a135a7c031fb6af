/** The path that the viewer shows, and which part of it. */

import { call, query, Refusal } from "../api/client";
import type { FaultStatus, Metadata } from "../api/schema";
import { colouring, type Colouring, type Mode } from "../viewer/colours";
import { machine } from "./machine.svelte";
import { readToolpath, type Toolpath } from "../viewer/toolpath";

const KEPT = "passo-filament-mm";
const USUAL_MM = 1.75;

/** The path of a file. Throws a Refusal, which says why a file has none. */
async function read(file: string, signal: AbortSignal): Promise<Toolpath> {
  const why = async () => {
    const { plan, problems } = await call<Metadata>("GET", `files/metadata?${query({ path: file })}`);
    const [problem] = plan ? [] : problems; // a file that needs a choice has a path
    return problem && new Refusal(404, { ...problem, text: problem.message });
  };
  const known = await why();
  if (known) throw known;
  try {
    return await readToolpath(file, signal);
  } catch (error) {
    throw (error instanceof Refusal && (await why())) || error;
  }
}

class Viewer {
  file = $state("");
  path = $state.raw<Toolpath>();
  fault = $state.raw<FaultStatus>();
  mode = $state<Mode>("feature");
  /** How many rows are drawn. */
  last = $state(0);
  only = $state(false);
  travel = $state(false);
  follow = $state(false);
  /** The row that was clicked, or -1. */
  picked = $state(-1);
  /** The diameter of the filament, from which the flow follows; no machine file has it. */
  filament_mm = $state(Number(localStorage.getItem(KEPT)) || USUAL_MM);
  /** Indices of the palette. */
  hidden = $state.raw<ReadonlySet<number>>(new Set());
  #reading: AbortController | undefined;

  colours: Colouring | undefined = $derived(this.path && colouring(this.path, this.mode, (Math.PI * this.filament_mm ** 2) / 4, machine.tools.map(({ heater }) => heater ?? "")));
  layer = $derived(this.path ? this.path.layerOf(Math.max(this.last - 1, 0)) : 0);
  first = $derived(this.only ? (this.path?.header.layers[this.layer]?.row ?? 0) : 0);

  async open(file: string): Promise<void> {
    if (file === this.file && (this.path || this.#reading)) return;
    this.#reading?.abort();
    const reading = (this.#reading = new AbortController());
    this.file = file;
    this.path = undefined;
    this.fault = undefined;
    this.picked = -1;
    this.follow = false;
    this.hidden = new Set();
    try {
      const path = await read(file, reading.signal);
      if (reading.signal.aborted) return;
      this.mode = path.header.features.length > 1 ? "feature" : "speed";
      if (path.header.layers.length === 0) this.travel = true; // nothing else is there to see
      this.last = path.rows;
      this.path = path;
    } catch (error) {
      if (reading.signal.aborted) return;
      if (!(error instanceof Refusal)) throw error;
      this.fault = error.fault;
    } finally {
      if (this.#reading === reading) this.#reading = undefined;
    }
  }

  setMode(mode: Mode): void {
    this.mode = mode;
    this.hidden = new Set();
  }

  setFilament(diameter_mm: number): void {
    if (!(diameter_mm > 0)) return;
    this.filament_mm = diameter_mm;
    localStorage.setItem(KEPT, String(diameter_mm));
  }

  toLayer(layer: number): void {
    if (this.path) this.last = this.path.endOf(layer);
  }

  toTime(seconds: number): void {
    if (this.path) this.last = this.path.rowsUntil(seconds);
  }

  toLine(line: number): void {
    if (this.path) this.last = this.path.rowsOfLines(line);
  }

  toggle(index: number): void {
    const hidden = new Set(this.hidden);
    if (!hidden.delete(index)) hidden.add(index);
    this.hidden = hidden;
  }

  /** Picks the move before or after the one that is picked, or the last one that is drawn. */
  step(by: 1 | -1): void {
    if (!this.path) return;
    let row = this.picked < 0 ? this.last - 1 : this.picked + by;
    while (row > 0 && row < this.path.rows && this.path.kind(row) === 0) row += by;
    if (row < 1 || row >= this.path.rows) return;
    this.picked = row;
    if (row >= this.last || row < this.first) this.last = row + 1;
  }
}

export const viewer = new Viewer();
