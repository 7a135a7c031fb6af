import { expect, test } from "vitest";
import { printer } from "../../../tests/farm-printers";
import "../../text/farm";
import { problemOf } from "./problem";

test("a fault is a sentence with its next action, for users of the page", () => {
  expect(problemOf(printer(6))).toEqual({
    text: "The hotend got colder while it was heated: 181 °C, target 215 °C.",
    action: "Check its cable and its sensor, then press “Start again”.",
  });
});

test("an unreachable printer has the time of its last word", () => {
  const at = new Date();
  at.setHours(9, 5);
  expect(problemOf(printer(7, { last_word_s: at.getTime() / 1000 }))?.text).toMatch(/since .*9:05/);
});

test("a start whose answer was lost is asked about first", () => {
  expect(problemOf(printer(6, { start_unknown: true }))?.action).toBe("Look at the printer, then say what you see.");
});

test("a printer that prints has no problem", () => {
  expect(problemOf(printer(0))).toBeUndefined();
});
