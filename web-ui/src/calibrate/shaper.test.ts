import { expect, test } from "vitest";
import { durationOf, frequencyOf } from "./shaper";

test("ripples of a known length have a frequency", () => {
  expect(frequencyOf(100, 4, 10)).toBe(40); // 2.5 mm a period, at 100 mm/s
});

test("a shaper lasts a part of the period, or some", () => {
  expect(durationOf("zv", 50)).toBe(10);
  expect(durationOf("3hump_ei", 50)).toBe(40);
});
