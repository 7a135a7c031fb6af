import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { test } from "./fixtures";

test("a line is explained through its stages, also one of a file", async ({ page }) => {
  await page.getByRole("link", { name: "Learn" }).click();
  await page.getByRole("button", { name: "G1 X10 Y10 F3000" }).click();
  for (const stage of ["Text", "Words", "Plan", "Junctions", "Steps"]) {
    await page.getByRole("heading", { name: stage, exact: true }).waitFor();
  }
  await page.getByText("14.142 mm").waitFor();
  const commands = page.locator("ul.wire li");
  expect(await commands.count()).toBe(12);
  await page.getByRole("button", { name: "Show all commands" }).click();
  await expect.poll(() => commands.count()).toBeGreaterThan(12);
  expect(await commands.first().locator(".field.interval").textContent()).toMatch(/^[0-9a-f]{2}( [0-9a-f]{2})*$/);
  await picture(page, "explained-1280-light");
  await page.setViewportSize({ width: 360, height: 800 });
  await page.emulateMedia({ colorScheme: "dark" });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "explained-360-dark");
  await page.evaluate(() => (location.hash = "#/learn/demo.gcode:30268"));
  await page.getByText("demo.gcode:30268").waitFor();
});

test("a corner is planned again with the values of sliders", async ({ page }) => {
  await page.getByRole("link", { name: "Learn" }).click();
  await page.getByRole("button", { name: "A corner" }).click();
  await page.getByText(/turns by 90.0°/).first().waitFor();
  await page.getByRole("slider", { name: "Acceleration" }).fill("800");
  await page.getByText("travel acceleration, 800 mm/s²").waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Values of the machine" }).click();
  await page.getByText("800 mm/s²").first().waitFor({ state: "detached" });
});

test("a pulled thermistor halts the printer, and the way out leads back", async ({ page }) => {
  await page.getByRole("link", { name: "Learn" }).click();
  await page.getByRole("button", { name: "Pull the thermistor" }).click();
  await page.locator("header .state", { hasText: "Halted" }).waitFor();
  await page.getByRole("alert").getByText(/hotend/).first().waitFor();
  await expectAccessible(page);
  await picture(page, "learn-fault-1280-light");
  await page.getByRole("navigation").getByRole("link", { name: "Dashboard" }).click();
  await page.getByText("Switched off: its sensor has an open circuit.").waitFor();
  await page.getByRole("link", { name: "Learn" }).click();
  await page.getByRole("button", { name: "Repair" }).click();
  await page.getByRole("button", { name: "Start again" }).click();
  await page.locator("header .state", { hasText: "Ready" }).waitFor();
});
