import { expect, test } from "vitest";
import type { ParameterView } from "../api/schema";
import { addressOf, placed } from "./lesson-address";

const parameter = (name: string, value: number | string): ParameterView => ({
  name,
  label: name,
  unit: "",
  default: value,
  low: 0,
  high: 100,
  step: 1,
  choices: [],
});
const PARAMETERS = [parameter("teeth", 20), parameter("drive", "belt")];

test("an address carries the values that differ from the defaults", () => {
  expect(addressOf("lessons", "steps-per-mm", { teeth: 20, drive: "belt" }, PARAMETERS)).toBe("#/learn/lessons/steps-per-mm");
  const address = addressOf("calculators", "steps-per-mm", { teeth: 16, drive: "screw" }, PARAMETERS);
  expect(address).toBe("#/learn/calculators/steps-per-mm?teeth=16&drive=screw");
  expect(placed(address.replace("#/learn", ""))).toEqual({
    kind: "calculators",
    name: "steps-per-mm",
    values: { teeth: "16", drive: "screw" },
  });
});

test("a line of a file is no lesson", () => {
  expect(placed("/demo.gcode:120")).toBeUndefined();
  expect(placed("")).toBeUndefined();
});
