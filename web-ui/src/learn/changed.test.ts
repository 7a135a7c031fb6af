import { expect, test } from "vitest";
import { commandsOf } from "./changed";

test("only what is changed becomes a command", () => {
  expect(commandsOf({}, "J")).toEqual([]);
  expect(commandsOf({ acceleration: 500, speed: 150 }, "J")).toEqual(["M204 P500 T500", "M220 S150"]);
  expect(commandsOf({ junction: 0.05 }, "J")).toEqual(["M205 J0.05"]);
  expect(commandsOf({ junction: 8 }, "X")).toEqual(["M205 X8 Y8"]);
});
