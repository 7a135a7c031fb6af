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
  await p.waitFor({ timeout: 30_000 });
  expect(await p.getByRole("cell").nth(1).textContent()).toBe("20.1316");
  for (const [width, colorScheme] of [[360, "light"], [1280, "dark"]] as const) {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await expectFits(page);
    await expectAccessible(page);
    await picture(page, `calibrate-heater-${width}-${colorScheme}`);
  }
  await page.getByRole("button", { name: "Undo" }).click();
  await result(page).waitFor({ state: "detached" });
});

test("a thermistor is fitted to readings, and the steps to a measured length", async ({ page }) => {
  await open(page, "Thermistor");
  const thermometer = page.getByLabel("Thermometer, °C");
  await thermometer.fill("26");
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

test("the bed is measured and shown as a map, and the nozzle set to the paper", async ({ page }) => {
  await open(page, "Bed");
  await page.getByText("The bed is not measured yet.").waitFor();
  await page.getByRole("button", { name: "Measure the bed" }).click();
  const map = page.getByRole("region", { name: "Heights of the bed in mm" });
  await map.waitFor({ timeout: 30_000 });
  expect(await map.getByRole("cell").count()).toBe(11 * 11 + 1);
  await page.getByText("surface, on").waitFor();
  for (const [width, colorScheme] of [[360, "dark"], [1280, "light"]] as const) {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await expectFits(page);
    await expectAccessible(page);
    await picture(page, `calibrate-bed-${width}-${colorScheme}`);
  }
  await open(page, "Paper test");
  await page.getByRole("button", { name: "Home and approach" }).click();
  await page.getByRole("button", { name: "−0.05" }).click();
  await page.getByText("-0.050 mm").waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Keep it" }).click();
  await result(page).getByRole("row", { name: "M206 Z" }).getByText("0.05", { exact: true }).first().waitFor();
});
