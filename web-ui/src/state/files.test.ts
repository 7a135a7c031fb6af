import { expect, test } from "vitest";
import { query } from "../api/client";
import { freeName, isProgram, within } from "./files.svelte";

test("a path has one slash between its parts", () => {
  expect(within("/", "a.gcode")).toBe("/a.gcode");
  expect(within("/parts", "a.gcode")).toBe("/parts/a.gcode");
});

test("a second file of a name gets a number before its ending", () => {
  expect(freeName("a.gcode", ["a.gcode"])).toBe("a-2.gcode");
  expect(freeName("a.gcode", ["a.gcode", "a-2.gcode", "a-3.gcode"])).toBe("a-4.gcode");
  expect(freeName(".gcode", [".gcode"])).toBe(".gcode-2");
});

test("programs are known by their endings", () => {
  expect(["a.GCODE", "b.nc", "c.g", "d.stl", "gcode"].map(isProgram)).toEqual([
    true, true, true, false, false,
  ]);
});

test("what is not a letter is escaped in a query", () => {
  expect(query({ path: "/ä & b.gcode", number: 1 })).toBe("path=%2F%C3%A4+%26+b.gcode&number=1");
});
