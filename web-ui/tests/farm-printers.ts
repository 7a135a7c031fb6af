/** Printers and jobs that are made up. */

import type { JobView, PrinterView } from "../src/farm/schema";

export const NOW_S = Date.now() / 1000;

const NAMES = ["Ada", "Bellini", "Curie", "Dante", "Euler", "Fermi", "Galilei", "Hopper", "Isaac", "Joule", "Kepler", "Leonardo"];
export const FILES = ["bracket-left.gcode", "gear-24t.gcode", "enclosure-top-v3.gcode", "hook.gcode"];
const COLOURS = ["black", "white", "orange", "royalblue"];

/** The printer of a number: the twelve kinds of printers that a page has to show, again and again. */
export function printer(number: number, change: Partial<PrinterView> = {}): PrinterView {
  const kind = number % 12;
  const name = (NAMES[kind] ?? "") + (number < 12 ? "" : ` ${Math.floor(number / 12) + 1}`);
  const condition = ({ 3: "paused", 4: "idle", 5: "idle", 6: "halted", 7: "unreachable", 9: "idle", 11: "idle" } as const)[kind] ?? "printing";
  const prints = condition === "printing" || condition === "paused";
  const file = FILES[number % 4] ?? "";
  const left_s = 600 + ((number * 977) % 30_000);
  const fault = { code: "heater.runaway", part: "hotend", text: "the hotend got colder while it was heated: 181 °C, target 215 °C", action: "Check its cable and its sensor, then send M999" };
  return {
    id: `p${number}`,
    name,
    url: `http://10.0.0.${number + 10}:4000/`,
    kind: kind === 8 ? "moonraker" : "passo",
    condition,
    bed_clear: kind === 4 || kind === 9,
    tags: [kind % 2 ? "left wall" : "right wall", ...(kind % 3 ? [] : ["large"])],
    loaded: { material: kind % 5 === 1 ? "PETG" : "PLA", colour: COLOURS[kind % 4] ?? "", nozzle_mm: kind === 2 ? 0.6 : 0.4, plate: "" },
    attention: kind === 11 ? "The last print failed: the filament ran out at line 20418" : "",
    run: prints ? `r${number}` : "",
    power_group: kind < 4 ? "Fuse A" : "",
    heating_w: 350,
    service: kind === 9,
    clears_itself: false,
    seen:
      kind === 7
        ? null
        : {
            id: `p${number}`,
            name,
            version: "0.9.0",
            state: condition === "unreachable" ? "idle" : condition,
            job: prints ? { file: `/hub/${file}`, run: `r${number}`, fraction: ((number * 379) % 1000) / 1000, left_s, printed_s: 4000, layer: 40, layers: 120, filament_mm: 5200 } : null,
            last_print: kind === 5 || kind === 11 ? { number: 4, file, run: "x", result: kind === 5 ? "done" : "failed", reason: "" } : null,
            heaters: [
              { name: "hotend", celsius: prints ? 215 : 24 + kind, target_c: prints ? 215 : 0 },
              { name: "bed", celsius: prints ? 60 : 22, target_c: prints ? 60 : 0 },
            ],
            fault: kind === 6 ? fault : null,
          },
    prints: 120 + number,
    printed_s: 800_000,
    filament_mm: 1.2e6,
    service_due: [],
    cleared_by: "anna",
    cleared_s: NOW_S - 900,
    last_word_s: kind === 7 ? NOW_S - 1500 : null,
    start_unknown: false,
    ...change,
  };
}

export function job(number: number, change: Partial<JobView> = {}): JobView {
  return {
    id: `j${number}`,
    file: `${number}`.repeat(64).slice(0, 64),
    name: FILES[number % 4] ?? "",
    quantity: 12,
    priority: 0,
    needs: { material: "PLA", colour: number % 2 ? "black" : "", nozzle_mm: 0.4, plate: "" },
    tags: [],
    each: [],
    due_s: number === 1 ? NOW_S + 40_000 : null,
    retries: 1,
    paused: false,
    added_s: NOW_S - 5000 + number,
    added_by: "anna",
    waiting: 8,
    running: 2,
    done: 2,
    failed: 0,
    cancelled: 0,
    why: number === 0 ? "" : "4 printers fit: 2 print, the beds of Fermi and Leonardo are not clear",
    ...change,
  };
}
