import { expect, test } from "vitest";
import commonEn from "./common/en.json";
import commonIt from "./common/it.json";
import farmEn from "./farm/en.json";
import farmIt from "./farm/it.json";
import { keyOf, t } from "./index.svelte";
import "./printer";
import printerEn from "./printer/en.json";
import printerIt from "./printer/it.json";
import { bytes, celsius, clockTime, duration, millimetres, percent, short } from "./units";

test("values are put into a text", () => {
  expect(t("job.waits", { heater: "bed", now: 41, target: 60 })).toBe(
    "Waiting for bed: 41 of 60 °C",
  );
});

test.each<[string, Record<string, string>, Record<string, string>]>([
  ["common", commonEn, commonIt],
  ["printer", printerEn, printerIt],
  ["farm", farmEn, farmIt],
])("each language has each text of %s, with the same values", (_, en, it) => {
  const values = (text = "") => (text.match(/\{\w+\}/g) ?? []).sort();
  expect(Object.keys(it).sort()).toEqual(Object.keys(en).sort());
  for (const [key, text] of Object.entries(it)) {
    expect(values(text), key).toEqual(values(en[key]));
  }
});

test("no text is in two catalogues of a page", () => {
  const twice = Object.keys(commonEn).filter((key) => key in printerEn || key in farmEn);
  expect(twice).toEqual([]);
});

test("a name that has no text has no key", () => {
  expect(keyOf("job.paused")).toBe("job.paused");
  expect(keyOf("job.unheard-of")).toBeUndefined();
});

test.each<[number | null, string]>([
  [null, "–"],
  [0, "0 s"],
  [59.4, "59 s"],
  [59.6, "1 min"],
  [3569, "59 min"],
  [3580, "1 h 00 min"],
  [11_100, "3 h 05 min"],
])("%j s reads as %s", (seconds, text) => {
  expect(duration(seconds)).toBe(text);
});

test("numbers are rounded to what a user can use", () => {
  expect(celsius(204.96)).toBe("205.0");
  expect(celsius(null)).toBe("–");
  expect([short("20.13157895"), short("0"), short("mzv")]).toEqual(["20.1316", "0", "mzv"]);
  expect(millimetres(-0.001)).toBe("0.00");
  expect(millimetres(-1.234, 1)).toBe("-1.2");
  expect(percent(0.126)).toBe("13 %");
  expect([999, 31_234, 31_234_567].map(bytes)).toEqual(["999 B", "31 kB", "31.2 MB"]);
});

test("a time of another day names the day", () => {
  const now = new Date(2026, 10, 25, 23, 0);
  expect(clockTime(new Date(2026, 10, 25, 23, 30), now)).not.toMatch(/[a-z]{3} /i);
  expect(clockTime(new Date(2026, 10, 26, 0, 30), now)).toMatch(/thu/i);
});
