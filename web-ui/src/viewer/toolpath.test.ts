import { expect, test } from "vitest";
import { ramp } from "$draw/shades.js";
import { colouring } from "./colours";
import { decode, PRINT, TRAVEL } from "./toolpath";

/** Four rows: a jump, a travel and two prints, in two layers. */
function encoded(): ArrayBuffer {
  const header = {
    rows: 4,
    origin_mm: [10, 20, 0.2],
    unit_mm: 0.01,
    end_s: 10,
    layers: [
      { number: 1, row: 0, z_mm: 0.2, start_s: 0 },
      { number: 2, row: 3, z_mm: 0.4, start_s: 6 },
    ],
    features: ["other", "Perimeter", "Infill"],
    limits: ["feedrate"],
    targets: [
      { time_s: 0, heater: "left", celsius: 200 },
      { time_s: 1, heater: "right", celsius: 220 },
      { time_s: 6, heater: "left", celsius: 190 },
    ],
    columns: [
      { name: "at", type: "u2", numbers: 4, unit: 1 },
      { name: "time", type: "f4", numbers: 1, unit: 1 },
      { name: "line", type: "u4", numbers: 1, unit: 1 },
      { name: "speed", type: "u2", numbers: 1, unit: 0.02 },
      { name: "feature", type: "u1", numbers: 1, unit: 1 },
    ],
  };
  let text = JSON.stringify(header);
  while ((12 + text.length) % 8) text += " ";
  const columns = [
    new Uint16Array([0, 0, 0, 0, 100, 0, 0, TRAVEL, 100, 500, 0, PRINT + 256, 0, 500, 20, PRINT]),
    new Float32Array([0, 2, 6, 10]),
    new Uint32Array([3, 3, 4, 9]),
    new Uint16Array([0, 5000, 1000, 2000]),
    new Uint8Array([0, 0, 1, 2]),
  ];
  const parts = [new TextEncoder().encode("PASSOTP1"), new Uint8Array(new Uint32Array([text.length]).buffer), new TextEncoder().encode(text)];
  parts.push(...columns.map((column) => new Uint8Array(column.buffer)));
  const data = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    data.set(part, at);
    at += part.length;
  }
  return data.buffer;
}

const path = decode(encoded());

test("a row has a place, a kind and values with their units", () => {
  expect([0, 1, 2].map((axis) => path.mm(2, axis as 0 | 1 | 2))).toEqual([11, 25, 0.2]);
  expect([0, 1, 2, 3].map((row) => path.kind(row))).toEqual([0, TRAVEL, PRINT, PRINT]);
  expect(path.value("speed", 1)).toBe(100);
});

test("rows are found by layer, by time and by line", () => {
  expect([0, 2, 3].map((row) => path.layerOf(row))).toEqual([0, 0, 1]);
  expect([path.endOf(0), path.endOf(1)]).toEqual([3, 4]);
  expect([0, 5.9, 6.1, 99].map((seconds) => path.rowsUntil(seconds))).toEqual([1, 3, 4, 4]);
  expect([2, 3, 8, 9].map((line) => path.rowsOfLines(line))).toEqual([0, 2, 3, 4]);
});

test("numbers are coloured from the lowest to the highest of the printing moves", () => {
  const { range, values, palette } = colouring(path, "speed", 1, []);
  expect(range).toEqual({ low: 20, high: 40, unit: "mm/s" });
  expect([...values]).toEqual([0, 255, 0, 255]);
  expect(palette[255]).toEqual(ramp(1));
  expect(colouring(path, "layer-time", 1, []).range).toEqual({ low: 4, high: 6, unit: "s" });
});

test("the legend names the features that are printed", () => {
  const { entries } = colouring(path, "feature", 1, []);
  expect(entries.map(({ text, index }) => [text, index])).toEqual([
    ["Perimeter", 1],
    ["Infill", 2],
  ]);
});

test("the temperature of a move is the target of its tool's heater when it begins", () => {
  const { range, values } = colouring(path, "temperature", 1, ["left", "right"]);
  expect(range).toEqual({ low: 190, high: 220, unit: "°C" });
  expect([values[2], values[3]]).toEqual([255, 0]);
});
