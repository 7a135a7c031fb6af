import { expect, test } from "vitest";
import type { Command, Parameter } from "../api/schema";
import { commandOf, completions, isNoise, offersFor } from "./console.svelte";

const COMMANDS: Command[] = ["M115", "M1", "M105", "G28", "G1", "M112"].map((code) => ({
  code,
  parameters: [],
  text: "",
}));

function parameter(name: string): Parameter {
  const about = { kind: "number", usage: name, text: "a value", unit: "", choices: [] };
  return { ...about, names: name.split(" "), low: null, high: null, default: null };
}

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

test("after a command its other parameters are offered", () => {
  const filters: Command[] = [
    { code: "M900", text: "", parameters: [parameter("K"), parameter("T")] },
    { code: "SET_SKEW", text: "", parameters: [parameter("XY XZ YZ"), parameter("CLEAR")] },
  ];
  const lines = (typed: string) => offersFor(filters, typed).map(({ line }) => line);
  expect(lines("M9")).toEqual(["M900 "]);
  expect(lines("M900 ")).toEqual(["M900 K", "M900 T"]);
  expect(lines("M900 K0.05 ")).toEqual(["M900 K0.05 T"]);
  expect(lines("SET_SKEW XZ=1,1,1 x")).toEqual(["SET_SKEW XZ=1,1,1 XY="]);
  expect(lines("G99 ")).toEqual([]);
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
