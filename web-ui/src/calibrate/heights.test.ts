import { expect, test } from "vitest";
import { shadeOfHeight } from "$draw/shades.js";
import { spreadOf } from "./heights";
import { changesOf } from "../state/calibration.svelte";

test("the spread of heights is about their mean", () => {
  const spread = spreadOf([
    [0.1, 0.3],
    [0.1, 0.3],
  ]);
  expect(spread.low).toBe(0.1);
  expect(spread.high).toBe(0.3);
  expect(spread.rms).toBeCloseTo(0.1, 12);
});

test("low is blue, the middle white, high red", () => {
  expect(shadeOfHeight(-0.2, 0.2)).toBe("rgb(110 175 245)");
  expect(shadeOfHeight(0, 0.2)).toBe("rgb(250 250 250)");
  expect(shadeOfHeight(0.2, 0.2)).toBe("rgb(250 140 120)");
});

test("only settings whose values differ are changes, with the value before", () => {
  const setting = (word: string, value: string) => ({ group: "", command: "M301 H0", word, value, source: "file" });
  const changes = changesOf([setting("P", "20"), setting("I", "1")], [setting("P", "47"), setting("I", "1")]);
  expect(changes.map(({ word, before, value }) => [word, before, value])).toEqual([["P", "20", "47"]]);
});
