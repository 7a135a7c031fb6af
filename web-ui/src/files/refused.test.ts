import { expect, test } from "vitest";
import type { Fault } from "../api/schema";
import { macrosOf, macroText, printLabel, wantsAnotherMachine } from "./refused";

const fault = (code: string, values: Record<string, unknown> = {}): Fault => ({ code, part: "", message: "", action: "", values });
const start = fault("input.no-macro", { value: "PRINT_START", text: "BED=60 EXTRUDER=210" });

test("the button says what it allows", () => {
  expect(printLabel(["unknown"], [start, start])).toBe("refused.print-without");
  expect(printLabel(["unknown"], [start, fault("input.no-macro", { value: "PRINT_END" })])).toBe("refused.print-without-them");
  expect(printLabel(["clamp"], [])).toBe("refused.print-clamp");
  expect(printLabel(["unknown", "clamp"], [])).toBe("refused.print-anyway");
});

test("each missing macro is named once, with the words of its first call", () => {
  const again = fault("input.no-macro", { value: "PRINT_START", text: "" });
  expect(macrosOf([start, again, fault("input.no-levelling", { value: "G29" })])).toEqual([
    { name: "PRINT_START", words: "BED=60 EXTRUDER=210" },
  ]);
});

test("another machine is looked for where its size or its parts matter", () => {
  expect(wantsAnotherMachine([start])).toBe(false);
  expect(wantsAnotherMachine([start, fault("input.missing-tool")])).toBe(true);
});

test("a start macro sets the temperatures with which the file calls it", () => {
  expect(macroText("PRINT_START", "BED=60 EXTRUDER=210 MATERIAL=PLA")).toBe(
    "[macros.PRINT_START]\ngcode = '''\n" +
      "; The file calls it with BED=60 EXTRUDER=210 MATERIAL=PLA\n" +
      "G28\nM190 S{params.BED|default(60)|float}\nM109 S{params.EXTRUDER|default(210)|float}\n'''\n",
  );
  expect(macroText("PRINT_END", "")).not.toContain("G28");
});
