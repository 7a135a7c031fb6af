import { expect, test } from "vitest";
import "./printer";
import { actionOf, inButtons, inLine } from "./faults";

test.each([
  ["Make the printer safe, then send M999", "Make the printer safe, then press “Start again”."],
  ["Check the wire, then M999", "Check the wire, then press “Start again”."],
  ["Remove the cause, then start again or send M999", "Remove the cause, then press “Start again”."],
  ["Correct the cause, then continue after this command (M24), or cancel (M524)", "Correct the cause, then continue after this command, or cancel."],
  ["Home it (G28), or set its position (G92)", "Home it, or set its position (G92)."],
  ["Home the machine; M1000 resumes a print from the card", "Home the machine; “Resume the print” resumes a print from the card."],
  ["", ""],
])("the action %j names buttons", (action, shown) => {
  expect(actionOf({ code: "other", action })).toBe(shown);
});

test("a place in the file in view is its line", () => {
  expect(inLine("a.gcode:7: T1 does not exist", "a.gcode")).toBe("Line 7: T1 does not exist");
  expect(inLine("b.gcode:7: T1 does not exist", "a.gcode")).toBe("b.gcode:7: T1 does not exist");
});

test("an error that the page can allow has an action of its own", () => {
  expect(actionOf({ code: "input.no-macro", action: "Add this section" })).toContain("print without it");
  expect(inButtons("halted. Make the printer safe, then send M999")).toContain("Start again");
});
