/** The pages that `passo report` and `passo lab` write: opened as files. */

import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { expect, test as base } from "vitest";
import { expectAccessible, expectFits, launch, picture } from "./browser";
import { PYTHON } from "./served";

const PRINTED = `M140 S60
M104 S200
G28
M83
G1 Z0.2 F3000
G1 X60 Y40 E2 F1800
G1 X60 Y80 E2
G1 Z0.4
G1 X20
G1 X60 Y40 E2 F4800
`;
const SQUARE = "G92 E0\nG1 X20 Y20 F6000\nG1 X80 E2.4\nG1 Y80 E4.8\nG1 X60 Y60 E5.9\n";

const test = base
  .extend("browser", { scope: "file" }, async ({}, { onCleanup }) => {
    const browser = await launch();
    onCleanup(() => browser.close());
    return browser;
  })
  /** The page that a command writes about a program; nothing may go wrong in it. */
  .extend("written", async ({ browser }, { onCleanup }) => {
    const folder = mkdtempSync(join(tmpdir(), "passo-written-"));
    const context = await browser.newContext({ viewport: { width: 1180, height: 900 }, reducedMotion: "reduce" });
    const faults: string[] = [];
    onCleanup(async () => {
      await context.close();
      rmSync(folder, { recursive: true });
      expect(faults).toEqual([]);
    });
    return async (command: "report" | "lab", text: string, machine = "i3"): Promise<Page> => {
      const [program, written] = [join(folder, "part.gcode"), join(folder, "part.html")];
      writeFileSync(program, text);
      const done = spawnSync(PYTHON, ["-m", "passo", command, program, "--machine", machine, "--output", written]);
      if (!existsSync(written)) throw new Error(String(done.stderr));
      const page = await context.newPage();
      page.on("console", (message) => faults.push(message.text()));
      page.on("pageerror", (error) => faults.push(String(error)));
      page.on("request", (request) => {
        if (request.url().split("#")[0] !== `file://${written}`) faults.push(`asked for ${request.url()}`);
      });
      await page.goto(`file://${written}`);
      return page;
    };
  });

const numbers = (path: string | null) => (path ?? "").match(/[\d.]+/g)?.map(Number);

test("a move is drawn as its trapezoid, and zoomed", async ({ written }) => {
  const page = await written("report", "G28\nG1 X50 F6000\n");
  const chart = page.locator(".chart").first();
  expect(numbers(await chart.locator("path.line").getAttribute("d"))).toEqual([0, 1000, 62.5, 0, 937.5, 0, 1000, 1000]);
  expect(await chart.locator(".y").textContent()).toBe("020406080100");
  expect(await chart.locator(".under").textContent()).toBe("print time, s");
  await page.getByRole("button", { name: "Zoom in" }).click();
  await page.getByText("0.1333 to 0.4000 (s)").waitFor();
  await expect.poll(() => new URL(page.url()).hash).toBe("#t=0.1333,0.4");
  const box = await chart.locator(".plot").boundingBox();
  await page.mouse.move((box?.x ?? 0) + (box?.width ?? 0) / 2, (box?.y ?? 0) + 20);
  await page.getByText(/^at 0.266\d, line 2$/).waitFor();
  expect(await chart.locator(".key b").textContent()).toBe("100");
});

test("a print has all its pictures, and each layer", async ({ written }) => {
  const page = await written("report", PRINTED, "i3-probe");
  expect(await page.getByRole("heading", { level: 2 }).allTextContents()).toEqual([
    "Toolpath: layer 1 of 2, Z 0.2 mm",
    "Result",
    "First layer",
    "What limits the speed: seconds by limit",
    "Speed along the path",
    "Acceleration along the path; braking is negative",
    "Temperature and target of each heater",
    "Power of each heater",
    "Step rate of each motor",
  ]);
  expect(await page.locator(".axis").allTextContents()).toEqual(["Y, mm", "mm/s", "mm/s²", "°C", "% of full power", "steps/s"]);
  expect(await page.locator("section.bed rect").count()).toBeGreaterThan(4);
  await expectAccessible(page);
  await picture(page, "report-1180-light");
  const lines = () => page.locator(".lines path:not(.travel)").evaluateAll((all) => all.map((one) => one.getAttribute("d")).join(""));
  const first = await lines();
  await page.getByRole("slider", { name: "Layer" }).fill("2");
  await page.getByText("layer 2 of 2, Z 0.4 mm").waitFor();
  expect(await lines()).not.toBe(first);
  await page.setViewportSize({ width: 360, height: 800 });
  await page.emulateMedia({ colorScheme: "dark" });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "report-360-dark");
});

test("a print that stops shows the reason first", async ({ written }) => {
  const page = await written("report", "G28\nG1 X50 F6000\nG1 X999\n");
  const headings = await page.getByRole("heading", { level: 2 }).allTextContents();
  expect(headings).not.toContain("Result");
  expect(headings[0]).toBe("The print stopped");
  await page.getByText(/part.gcode:3: X 999.000 mm is beyond the limit/).waitFor();
  await expectAccessible(page);
});

test("the settings of a lab are compared around one corner", async ({ written }) => {
  const page = await written("lab", SQUARE);
  const settings = await page.locator(".trials tbody tr").count();
  expect(settings).toBeGreaterThan(10);
  expect(await page.locator("figure").count()).toBe(2 * settings);
  await page.getByRole("heading", { name: /^The corner that rings most: line \d, X80.0 Y/ }).waitFor();
  expect(await page.locator(".trade circle").count()).toBe(8);
  await expectAccessible(page);
  await picture(page, "lab-1180-light");
  await page.setViewportSize({ width: 360, height: 800 });
  await page.emulateMedia({ colorScheme: "dark" });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "lab-360-dark");
});
