import { lined, scaleOf } from "$draw/chart.js";
import { clockLabel, clockUnit, label, roundStep, ticks, timeStep } from "$draw/labels.js";
import { decode, part, valueAt } from "$draw/series.js";
import { ramp } from "$draw/shades.js";
import { expect, test } from "vitest";

test.each([
  [100, 20],
  [101, 50],
  [0.4, 0.1],
  [3.1e-5, 1e-5],
  [7, 2],
  [19_999, 5000],
  [1, 0.2],
])("labels of 0 to %d are %d apart, at most five", (span, step) => {
  expect(roundStep(span, 5)).toBeCloseTo(step, 12);
  expect(span / step).toBeLessThanOrEqual(5);
});

test.each([
  [0.5, 0.1],
  [5, 1],
  [11, 2],
  [61, 15],
  [600, 120],
  [3344, 600],
  [7200, 1800],
  [2e6, 345_600],
])("times of %d s are %d s apart: parts of minutes, hours and days", (span, step) => {
  expect(timeStep(span, 6)).toBeCloseTo(step, 12);
});

test.each([
  [0.05, 0.05, 0.2, "0.05", "s"],
  [90, 30, 120, "90", "s"],
  [90, 30, 121, "1:30", "min:s"],
  [59.96, 0.1, 600, "1:00.0", "min:s"],
  [7505, 60, 9000, "2:05", "h:min"],
  [7505, 5, 9000, "2:05:05", "h:min:s"],
  [7505.25, 0.05, 9000, "2:05:05.25", "h:min:s"],
] as const)("%d s, every %d of %d, reads as %s (%s)", (seconds, step, longest, text, unit) => {
  expect(clockLabel(seconds, step, longest)).toBe(text);
  expect(clockUnit(step, longest)).toBe(unit);
});

test("numbers have the decimals of their step", () => {
  expect(ticks(-4000, 4000, 2000).map((v) => label(v, 2000))).toEqual(["−4,000", "−2,000", "0", "2,000", "4,000"]);
  expect(ticks(-0.2, 0.4, 0.2).map((v) => label(v, 0.2))).toEqual(["−0.2", "0.0", "0.2", "0.4"]);
  expect(scaleOf([0, 101, -3])).toEqual([-50, 150, 50]);
});

test("a line begins anew after a gap", () => {
  expect(lined([[0, 1], [1, NaN], [2, 3], [3, 4]], 0)).toBe("M0 1M2 3L3 4");
});

test("a few corners are drawn as they are, and cut at the ends", () => {
  const series = { t: [0, 1, 3, 4], v: [0, 100, 100, 0] };
  expect(part(series, 0, 4, 100).points).toEqual([[0, 0], [1, 100], [3, 100], [4, 0]]);
  expect(part(series, 0.5, 3.5, 100)).toEqual({ points: [[0.5, 50], [1, 100], [3, 100], [3.5, 50]], band: [] });
  expect([valueAt(series, 0.5), valueAt(series, 9), valueAt({ t: [1, 2], v: [NaN, 2] }, 1.5)]).toEqual([[50, 50], null, null]);
});

test("more corners than columns are a mean with a band, from the first known value on", () => {
  const t = Array.from({ length: 1001 }, (_, i) => 5 + i / 200);
  const { points, band } = part({ t, v: t.map((_, i) => (i % 2 ? 10 : 0)) }, 0, 10, 20);
  expect(points).toHaveLength(10);
  expect(points[0]?.[0]).toBe(5.25);
  for (const [, mean] of points) expect(mean).toBeCloseTo(5, 6);
  expect(band.map(([, low, high]) => [low, high])).toEqual(Array(10).fill([0, 10]));
});

test("columns keep their extremes when they are joined, and unknown ones are left out", () => {
  const packed = (numbers: number[]) => btoa(String.fromCharCode(...new Uint8Array(Int16Array.from(numbers).buffer)));
  const known = { low: packed([0, -32768, 5, 0]), high: packed([10, -32768, 20, 30]), mean: packed([4, -32768, 10, 20]) };
  const series = decode({ w: 1, scale: 0.5, ...known });
  expect([valueAt(series, 0.5), valueAt(series, 1.5), valueAt(series, 2.5)]).toEqual([[0, 5], null, [2.5, 10]]);
  expect(part(series, 0, 4, 2)).toEqual({ points: [[1, 2], [3, 7.5]], band: [[1, 0, 5], [3, 0, 15]] });
});

test("speeds are from blue over green to red", () => {
  expect([ramp(0), ramp(0.5), ramp(1), ramp(2)]).toEqual([[58, 110, 224], [82, 207, 102], [240, 62, 62], [240, 62, 62]]);
});
