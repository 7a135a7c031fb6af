import type { Page } from "playwright-core";
import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { testOf } from "./fixtures";

const test = testOf({ machine: "i3-probe", clock: 60 });

test.beforeEach(async ({ page }) => {
  await page.getByRole("link", { name: "Calibrate" }).click();
  await page.getByRole("heading", { name: "Heater" }).waitFor();
});

const open = (page: Page, task: string) => page.getByRole("link", { name: task }).click();
const result = (page: Page) => page.getByRole("region", { name: "Changed settings", exact: true });

test("a heater is tuned with its curve, undone, and a tune is cancelled", async ({ page }) => {
  await page.getByRole("button", { name: "Start" }).click();
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("Cancelled. Nothing is changed.").waitFor();
  await page.getByRole("button", { name: "Start" }).click();
  await page.getByRole("img", { name: /Temperatures of hotend/ }).waitFor();
  const p = result(page).getByRole("row", { name: "M301 H0 P" });
  await p.waitFor();
  expect(await p.getByRole("cell").nth(1).textContent()).toBe("20.1316");
  await page.setViewportSize({ width: 360, height: 800 });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "heater-tuned-360-light");
  await page.getByRole("button", { name: "Undo" }).click();
  await result(page).waitFor({ state: "detached" });
});

test("a thermistor is fitted to readings, and the steps to a measured length", async ({ page }) => {
  await open(page, "Thermistor");
  const thermometer = page.getByLabel("Thermometer, °C");
  const shown = await page.locator("strong.live").textContent(); // it may still cool down
  await thermometer.fill(String(Math.round(parseFloat(shown ?? "")) + 1));
  await page.getByRole("button", { name: "Take the reading" }).click();
  await page.getByRole("columnheader", { name: "β" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Use the fit: β" }).click();
  await result(page).getByRole("cell", { name: "M305 H0 B" }).waitFor();
  await open(page, "Steps per mm");
  await page.getByLabel("Measured, mm").fill("95.5");
  await page.getByText("100.000").waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Use" }).click();
  await result(page).getByRole("row", { name: "M92 E" }).getByText("100", { exact: true }).waitFor();
  await page.getByRole("button", { name: "Undo" }).click();
});

test("the bed is measured and shown as a map", async ({ page }) => {
  await open(page, "Bed");
  await page.getByText("The bed is not measured yet.").waitFor();
  await page.getByRole("button", { name: "Measure the bed" }).click();
  const map = page.getByRole("region", { name: "Heights of the bed in mm" });
  await map.waitFor();
  expect(await map.getByRole("cell").count()).toBe(11 * 11 + 1);
  await page.getByText("surface, on").waitFor();
  await picture(page, "bed-measured-1280-light");
  await page.setViewportSize({ width: 360, height: 800 });
  await page.emulateMedia({ colorScheme: "dark" });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "bed-measured-360-dark");
});

test("the probe is compared with a sheet of paper", async ({ page }) => {
  await open(page, "Paper test");
  await page.getByRole("button", { name: "Home, probe, and approach" }).click();
  const steps = page.getByRole("region", { name: "Height above the bed" });
  await steps.waitFor();
  const z = () => steps.locator("dd.live").textContent().then((text) => parseFloat(text ?? ""));
  const start = await z();
  for (let lower = 1; lower < 10; lower++) {
    await steps.getByRole("button", { name: "−1", exact: true }).click();
    await expect.poll(z).toBeCloseTo(start - lower, 3);
  }
  await steps.getByRole("button", { name: "Half way up" }).click();
  await expect.poll(z).toBeCloseTo(start - 8.5, 3);
  await expectAccessible(page);
  await picture(page, "calibrate-paper-1280-light");
  await steps.getByRole("button", { name: "The paper just moves" }).click();
  await result(page).getByRole("row", { name: "M851 Z" }).waitFor();
  await page.getByRole("button", { name: "Undo" }).click();
  await page.getByRole("button", { name: "Home, measure, and wait above the point" }).click();
  await page.getByText("ProbeHeight@P1").waitFor();
});

test("a shaper follows from ripples, and an advance from a tower", async ({ page }) => {
  await open(page, "Input shaper");
  await page.getByLabel("Their length, mm").fill("10");
  expect(await page.getByLabel("Frequency, Hz").inputValue()).toBe("40");
  await page.getByLabel("Type").selectOption("ei");
  await page.getByText("Each change of speed takes 25.0 ms longer").waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Use" }).click();
  await result(page).getByRole("row", { name: "SET_INPUT_SHAPER SHAPER_FREQ_X" }).getByText("40").waitFor();
  await result(page).getByRole("row", { name: "SHAPER_TYPE_X" }).getByText("ei", { exact: true }).waitFor();
  await picture(page, "calibrate-shaper-1280-light");
  await page.getByRole("button", { name: "Undo" }).click();
  await open(page, "Pressure advance");
  await page.getByLabel("Best height, mm").fill("8");
  expect(await page.getByLabel("Advance, s").inputValue()).toBe("0.04");
  await expectAccessible(page);
  await page.getByRole("button", { name: "Use" }).click();
  await result(page).getByRole("row", { name: "SET_PRESSURE_ADVANCE ADVANCE" }).getByText("0.04").waitFor();
});
