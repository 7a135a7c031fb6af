/** The pictures of docs/images that show the page, and the first layer on a bed that is not level. */

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect } from "vitest";
import { visit, type Theme } from "./browser";
import { testOf } from "./fixtures";
import { PYTHON, Served } from "./served";

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

test("the bed, as the probe has measured it", async ({ browser }) => {
  const served = new Served({ machine: "i3-probe", clock: 60 });
  await served.start();
  const { page } = await visit(browser, served.url, { width: 1280, height: 1300 });
  await page.evaluate(() => (location.hash = "#/calibrate/bed"));
  await page.getByRole("button", { name: "Measure the bed" }).click();
  await page.getByRole("region", { name: "Heights of the bed in mm" }).waitFor({ timeout: 60_000 });
  await page.getByText("Store (M500)").waitFor();
  await page.locator("summary").click(); // the replies show the same heights
  await page.locator(".task section.card").first().screenshot({ path: join(IMAGES, "page-bed.png") });
  await page.context().close();
  await served.remove();
});

test("the first layer on a bed that is not corrected", async ({ browser }) => {
  const folder = mkdtempSync(join(tmpdir(), "passo-layer-"));
  const [job, report] = [join(folder, "plain.gcode"), join(folder, "report.html")];
  const lines = Array.from({ length: 41 }, (_, i) => `G1 X${i % 2 ? 20 : 230} Y${10 + 5 * i} E10 F6000\nG1 Y${15 + 5 * i}\n`);
  writeFileSync(job, `G28\nM83\nM109 S200\nG1 X20 Y10 Z0.3 F6000\n${lines.join("")}`);
  execFileSync(PYTHON, ["-m", "passo", "report", job, "--machine", "i3-probe", "--output", report]);
  const page = await browser.newPage({ viewport: { width: 900, height: 900 } });
  await page.goto(`file://${report}`);
  await page.locator("section.bed").screenshot({ path: join(IMAGES, "first-layer.png") });
  await page.close();
  rmSync(folder, { recursive: true });
});
