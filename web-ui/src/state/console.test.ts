import { expect, test } from "vitest";
import type { Command } from "../api/schema";
import { commandOf, completions, isNoise } from "./console.svelte";

const COMMANDS: Command[] = ["M115", "M1", "M105", "G28", "G1", "M112"].map((code) => ({
  code,
  parameters: "",
  text: "",
}));

function codes(typed: string): string[] {
  return completions(COMMANDS, typed).map((command) => command.code);
}

test("what is typed is completed, short codes first", () => {
  expect(codes("m1")).toEqual(["M1", "M105", "M112", "M115"]);
  expect(codes(" m11")).toEqual(["M112", "M115"]);
});

test("nothing is completed before the first letter and after the code", () => {
  expect(codes("")).toEqual([]);
  expect(codes("G28 X")).toEqual([]);
});

test("the command of a line is found by its whole code", () => {
  expect(commandOf(COMMANDS, "g28 x")?.code).toBe("G28");
  expect(commandOf(COMMANDS, "G2")?.code).toBeUndefined();
  expect(commandOf(COMMANDS, "M105")?.code).toBe("M105");
});

test.each([
  ["sent", "M105", true],
  ["sent", "N12 M105*34", true],
  ["sent", "M104 S200", false],
  ["answer", "ok", true],
  ["answer", "ok N3 P2048 B256", true],
  ["answer", "ok T:25.04 /0.00 B:25.04 /0.00 @:0 B@:0", true],
  ["answer", "X:0.000 Y:0.000 Z:0.000 E:0.0000", false],
  ["error", "Error:Printer halted", false],
] as const)("%s %s is noise: %s", (kind, text, noise) => {
  expect(isNoise({ id: 0, kind, text, sender: "" })).toBe(noise);
});
