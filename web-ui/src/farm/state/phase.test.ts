import { expect, test } from "vitest";
import { printer } from "../../../tests/farm-printers";
import { chosen, phaseOf, type Wanted } from "./phase";

test.each([
  [{ condition: "idle", bed_clear: true }, "ready"],
  [{ condition: "idle", bed_clear: true, run: "r1" }, "preparing"],
  [{ condition: "idle", bed_clear: false }, "clear"],
  [{ condition: "idle", bed_clear: false, service: true }, "service"],
  [{ condition: "busy" }, "busy"],
  [{ condition: "busy", run: "r1" }, "preparing"],
  [{ condition: "printing", bed_clear: true }, "printing"],
  [{ condition: "unreachable", bed_clear: true }, "unreachable"],
  [{ condition: "idle", bed_clear: true, attention: "the print failed" }, "attention"],
  [{ condition: "unreachable", start_unknown: true }, "unknown-start"],
] as const)("%j is %s", (change, phase) => {
  expect(phaseOf(printer(4, { run: "", attention: "", ...change }))).toBe(phase);
});

const names = (wanted: Partial<Wanted>) =>
  chosen(Array.from({ length: 12 }, (_, number) => printer(number)), { group: "all", tag: "", text: "", order: "urgent", ...wanted }).map(
    ({ name }) => name,
  );

test("what needs a person comes first", () => {
  expect(names({}).slice(0, 5)).toEqual(["Leonardo", "Galilei", "Hopper", "Dante", "Fermi"]);
});

test("printers are chosen by group, tag and text", () => {
  expect(names({ group: "ready" })).toEqual(["Euler"]);
  expect(names({ tag: "large", order: "name" })).toEqual(["Ada", "Dante", "Galilei", "Joule"]);
  expect(names({ text: "petg ", order: "name" })).toEqual(["Bellini", "Galilei", "Leonardo"]);
  expect(names({ text: "gear", group: "printing" })).toEqual(["Bellini"]);
});

test("the order by progress and by time left puts idle printers last", () => {
  expect(names({ order: "progress", group: "printing" })[0]).toBe("Kepler");
  expect(names({ order: "left" })[0]).toBe("Ada");
  expect(names({ order: "left" }).at(-1)).toBe("Leonardo");
});
