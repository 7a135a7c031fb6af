import { expect, test } from "vitest";
import { colorOf, cssOf, hexOf, isOn, whiteOf } from "./lights";

test("a colour field has the colour of the light, without its white", () => {
  expect(hexOf([1, 0.5, 0, 1])).toBe("#ff8000");
  expect(colorOf("#ff8000", 0.25)).toEqual([1, 128 / 255, 0, 0.25]);
  expect(cssOf([0.5, 0, 0, 0.25])).toBe("rgb(191 64 64)");
});

test("a light is switched on by its white LED, or by all three colours", () => {
  expect([whiteOf("RGB"), whiteOf("RGBW"), whiteOf("W")]).toEqual([[1, 1, 1, 0], [0, 0, 0, 1], [0, 0, 0, 1]]);
  expect([isOn([0, 0, 0, 0]), isOn([0, 0, 0, 0.1])]).toEqual([false, true]);
});
