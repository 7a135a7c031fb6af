/** The pictures of docs/images that show the page: the example while it is printed. */

import { join } from "node:path";
import { expect } from "vitest";
import { visit, type Theme } from "./browser";
import { testOf } from "./fixtures";

const test = testOf({ clock: 10 });
const IMAGES = "../docs/images";
const SIZE = { width: 1280, height: 800 };

test("the dashboard and the viewer, while the example is printed", async ({ browser, served }) => {
  const open = async (theme: Theme) => (await visit(browser, served.url, { ...SIZE, theme })).page;
  const page = await open("light");
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByRole("button", { name: "demo.gcode" }).click();
  await page.getByRole("button", { name: "Print", exact: true }).click();
  await page.getByRole("region", { name: "Print" }).locator(".chip", { hasText: "Printing" }).waitFor();
  const viewer = await open("dark");
  await viewer.getByRole("link", { name: "Viewer" }).click();
  await viewer.getByText("Follow the print").waitFor({ timeout: 30_000 });
  const layer = () => viewer.getByRole("slider", { name: "Layer" }).inputValue().then(Number);
  await expect.poll(layer, { timeout: 100_000 }).toBeGreaterThan(7);
  expect(await viewer.locator("header .state").textContent()).toContain("Printing"); // not halted: the computer was fast enough
  await page.screenshot({ path: join(IMAGES, "page-dashboard.png") });
  await viewer.screenshot({ path: join(IMAGES, "page-viewer.png") });
});
