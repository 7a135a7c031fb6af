import type { Page } from "playwright-core";
import { expect } from "vitest";
import { expectAccessible, picture } from "./browser";
import { testOf } from "./fixtures";

const HOT = "M190 S105\nG28\nG1 Z0.2 F600\nM302 P1\nG1 X50 Y50 E5 F3000\nG1 X90 E10\n"; // about half a minute
const test = testOf({ files: { "hot.gcode": HOT } });

const slider = (page: Page, name: string) => page.getByRole("slider", { name });
/** What the renderer has drawn in its last frame; two triangles are a move. */
const triangles = (page: Page) => page.locator("canvas").evaluate((canvas) => Number(canvas.dataset["triangles"]));

test("a path is shown by layer and time, coloured, and its moves are told", async ({ page }) => {
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByRole("button", { name: "demo.gcode" }).click();
  await page.getByRole("link", { name: "Show the path" }).click();
  await page.getByText("24,079 moves").waitFor();
  await expect.poll(() => triangles(page)).toBe(2 * 24_079);
  await slider(page, "Layer").fill("3");
  await page.getByText(/^3 of 15, Z/).waitFor();
  await expect.poll(() => triangles(page)).toBeLessThan(20_000);
  await page.getByLabel("Colour by").selectOption("Flow");
  await page.getByText("mm³/s").waitFor();
  await page.getByLabel("Colour by").selectOption("Temperature");
  await page.getByText("210 °C").waitFor();
  await page.getByRole("button", { name: "Previous move" }).click();
  await page.getByText(/^Line \d+/).waitFor();
  await page.emulateMedia({ colorScheme: "dark" });
  await expectAccessible(page);
  await picture(page, "viewer-1280-dark");
});

test("a print that heats shows its whole path", async ({ page }) => {
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByRole("row", { name: "hot.gcode" }).getByText("Fits").waitFor();
  await page.getByRole("button", { name: "hot.gcode" }).click();
  await page.getByText("of it heating").waitFor();
  await page.getByRole("button", { name: "Print", exact: true }).click();
  const card = page.getByRole("region", { name: "Print" });
  await card.getByText("The time left is without heating.").waitFor();
  expect(await page.locator("header .ends").count()).toBe(0);
  await page.getByRole("link", { name: "Viewer" }).click();
  await page.getByText("Nothing is printed yet.").waitFor();
  await page.getByText("Time without heating").waitFor();
  await picture(page, "viewer-heating-1280-light");
  await page.getByRole("link", { name: "Dashboard", exact: true }).last().click();
  await card.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Cancel the print" }).click();
  await card.locator(".chip", { hasText: "Cancelled" }).waitFor();
});

test("a print is followed", async ({ page }) => {
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByRole("button", { name: "demo.gcode" }).click();
  await page.getByRole("button", { name: "Print", exact: true }).click();
  await page.getByRole("region", { name: "Print" }).locator(".chip", { hasText: "Printing" }).waitFor();
  await page.getByRole("link", { name: "Viewer" }).click();
  await page.getByText("Follow the print").waitFor(); // once the path is planned
  const layer = () => slider(page, "Layer").inputValue().then(Number);
  // The slider shows the last layer until the position of the print is known.
  await expect.poll(layer).toBeLessThan(14);
  await expect.poll(layer).toBeGreaterThan(0);
});
