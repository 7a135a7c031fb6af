import { expect, test } from "vitest";
import { literalOf, literals, valueOf, withKey } from "./toml";

const TEXT = `# A machine.
name = "i3" # its name

[axes.x]
max_mm = 250.0  # to the clamp
min_mm = 0

[macros.START]
gcode = """
max_mm = 3
"""

[[tools]]
extruder = "e"

[geometry]
kind = 'cartesian'
`;

test("values are found by their keys", () => {
  expect([...literals(TEXT)]).toEqual([
    ["name", '"i3"'],
    ["axes.x.max_mm", "250.0"],
    ["axes.x.min_mm", "0"],
    ["geometry.kind", "'cartesian'"],
  ]);
});

test("a value changes, and comments stay", () => {
  expect(withKey(TEXT, "axes.x.max_mm", "240")).toBe(TEXT.replace("250.0", "240"));
  expect(withKey(TEXT, "axes.x.min_mm", undefined)).toBe(TEXT.replace("min_mm = 0\n", ""));
});

test("a new key goes into its table, and a new table to the end", () => {
  expect(withKey(TEXT, "axes.x.jerk_mm_s", "5")).toBe(TEXT.replace("min_mm = 0\n", "min_mm = 0\njerk_mm_s = 5\n"));
  expect(withKey(TEXT, "idle.motors_off_s", "60")).toBe(`${TEXT}\n[idle]\nmotors_off_s = 60\n`);
  expect(withKey(TEXT, "author", '"me"')).toBe(TEXT.replace("its name\n", 'its name\nauthor = "me"\n'));
});

test("values are read and written as TOML", () => {
  expect(['"a\\"b"', "'c'", "1_000.5", "true", "[1]"].map(valueOf)).toEqual(['a"b', "c", 1000.5, true, undefined]);
  expect(["a\"b", 1.5, false, [1, "x"], null].map(literalOf)).toEqual(['"a\\"b"', "1.5", "false", '[1, "x"]', undefined]);
});
