import { expect, test } from "vitest";
import type { Command } from "../api/schema";
import { commandOf, completions } from "./console.svelte";

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
