import type { Page } from "playwright-core";
import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { testOf } from "./fixtures";

const test = testOf({ state: true });

test.beforeEach(({ page }) => page.getByRole("link", { name: "Files" }).click());

const row = (page: Page, name: string) => page.getByRole("row", { name });

async function upload(page: Page, name: string, text: string): Promise<void> {
  const file = { name, mimeType: "text/x.gcode", buffer: Buffer.from(text) };
  await page.locator("input[type=file]").setInputFiles(file);
}

test("a file shows its verdict, its time and what limits it", async ({ page }) => {
  await row(page, "demo.gcode").getByText("Fits").waitFor();
  await page.getByRole("button", { name: "demo.gcode" }).click();
  await page.getByText("What limits the speed").waitFor();
  await page.getByText("Check that the bed is clear.").waitFor();
  await expectAccessible(page);
  await picture(page, "file-1280-light");
  await page.setViewportSize({ width: 360, height: 800 });
  await expectFits(page);
  await picture(page, "file-360-light");
});

test("an upload arrives, asks when its name is taken, and is deleted", async ({ page }) => {
  await upload(page, "line.gcode", "G28\nG1 X10 F3000\n");
  await row(page, "line.gcode").waitFor();
  await upload(page, "line.gcode", "G28\nG1 X20 F3000\n");
  await page.getByRole("dialog", { name: "The name is taken" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Keep both" }).click();
  await row(page, "line-2.gcode").waitFor();
  await page.getByRole("button", { name: "Delete" }).click();
  await page.getByRole("button", { name: "Delete the file" }).click();
  await row(page, "line-2.gcode").waitFor({ state: "detached" });
});

test("a refused file has its reasons, and ways on", async ({ page }) => {
  await upload(page, "wrong.gcode", "G28\nG1 X999 F3000\nG1 X1..2\n");
  await row(page, "wrong.gcode").getByText("Cannot be printed").waitFor();
  await page.getByText("Line 2: X 999.000 mm is beyond the limit").waitFor();
  expect(await page.getByRole("button", { name: /[Pp]rint/ }).count()).toBe(0);

  await upload(page, "far.gcode", "G28\nG1 Y225 F3000\n");
  await row(page, "far.gcode").getByText("Needs a choice").waitFor();
  await page.getByRole("link", { name: "ender3", exact: true }).waitFor();
  await expectAccessible(page);
  await picture(page, "refused-1280-light");
  await page.getByRole("button", { name: "Clamp and print" }).click();
  const card = page.getByRole("region", { name: "Print" });
  await card.locator(".chip", { hasText: "Finished" }).waitFor();
  const y = page.locator(".axis", { has: page.locator('strong:text-is("Y")') }).locator(".live");
  await y.getByText("220.00").waitFor();

  await page.getByRole("link", { name: "Files" }).click();
  await upload(page, "macro.gcode", "PRINT_START BED=60\nG28\nG1 X20 F3000\n");
  await page.getByText("Line 1: PRINT_START is unknown here").waitFor();
  await page.getByRole("link", { name: "Write this macro" }).click();
  const text = page.getByRole("textbox", { name: "Machine file, TOML" });
  await expect.poll(() => text.inputValue()).toContain("[macros.PRINT_START]");
  expect(await text.inputValue()).toContain("M190 S{params.BED|default(60)|float}");
  await page.getByRole("button", { name: "Discard" }).click();

  // Another client starts it: the dashboard has the same ways on.
  await page.evaluate(() => (location.hash = "#/dashboard"));
  const input = page.getByRole("combobox", { name: "Command" });
  await input.fill("M32 macro.gcode");
  await input.press("Enter");
  await card.locator(".chip", { hasText: "Failed" }).waitFor();
  await card.getByText("Write this macro, or print without it.").waitFor();
  expect(await card.getByText("M24").count()).toBe(0);
  await expectAccessible(page);
  await card.getByRole("button", { name: "Print without it" }).click();
  await card.locator(".chip", { hasText: "Finished" }).waitFor();
});

test("the details of a file are in view, however long the list is", async ({ page, served }) => {
  const names = Array.from({ length: 14 }, (_, i) => `part-${String(i).padStart(2, "0")}.gcode`);
  const buffer = Buffer.from("G28\nG1 X10 F3000\n");
  await page.locator("input[type=file]").setInputFiles(names.map((name) => ({ name, mimeType: "text/x.gcode", buffer })));
  for (const name of names) await row(page, name).waitFor();
  for (const [width, height] of [[1440, 900], [1024, 768], [390, 844]] as const) {
    const close = page.getByRole("button", { name: "Close the details" });
    if (await close.isVisible()) await close.click();
    await page.setViewportSize({ width, height });
    await page.getByRole("button", { name: "demo.gcode" }).scrollIntoViewIfNeeded();
    await page.getByRole("button", { name: "demo.gcode" }).click();
    await page.getByText("What limits the speed").waitFor();
    const box = await page.getByRole("button", { name: "Print", exact: true }).boundingBox();
    expect(box?.y).toBeGreaterThan(0);
    expect((box?.y ?? 0) + (box?.height ?? 0)).toBeLessThanOrEqual(height);
    await expectFits(page);
    await expectAccessible(page);
  }
  await page.screenshot({ path: "../build/pictures/file-sheet-390-light.png" });
  await page.keyboard.press("Escape");
  await page.getByText("What limits the speed").waitFor({ state: "detached" });
  await page.close();
  for (const name of names) {
    // The next test does not wait for their plans.
    const removed = await page.context().request.delete(`${served.url}api/v1/files?path=${name}`, { headers: { "X-Passo-Request": "1" } });
    expect(removed.status()).toBe(204);
  }
});

test("prints wait in the queue, change places, and start when the bed is clear", async ({ page }) => {
  for (const name of ["a.gcode", "b.gcode"]) {
    await upload(page, name, "G28\nG1 X10 F3000\n");
    await row(page, name).getByText("Fits").waitFor();
    await page.getByRole("button", { name, exact: true }).click();
    await page.getByRole("button", { name: "Add to the queue" }).click();
    await page.getByText("In the queue: 1").waitFor();
    await page.getByRole("button", { name: "Close the details" }).click();
  }
  const queue = page.getByRole("region", { name: "Queue" });
  const names = () => queue.locator("li .name").allTextContents();
  expect(await names()).toEqual(["a.gcode", "b.gcode"]);
  await expect.poll(() => queue.locator("li", { hasText: /\d+ s/ }).count()).toBe(2);
  for (const width of [1280, 400]) {
    await page.setViewportSize({ width, height: 900 });
    for (const colorScheme of ["light", "dark"] as const) {
      await page.emulateMedia({ colorScheme });
      await expectFits(page);
      await expectAccessible(page);
      await picture(page, `queue-${width}-${colorScheme}`);
    }
  }

  await page.getByRole("button", { name: "Move b.gcode up" }).press("Enter");
  await expect.poll(names).toEqual(["b.gcode", "a.gcode"]);
  const focus = () => page.evaluate(() => document.activeElement?.getAttribute("aria-label"));
  await expect.poll(focus).toBe("Move b.gcode down"); // at the top it moves no further up
  await queue.getByRole("checkbox").check();
  await queue.getByText("Only for a printer that clears its bed itself").waitFor();
  await queue.getByRole("checkbox").uncheck();

  await queue.getByRole("button", { name: "Start the next print" }).click();
  await page.getByRole("dialog", { name: "Is the bed clear?" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "The bed is clear: start" }).click();
  const card = page.getByRole("region", { name: "Print" });
  await card.locator(".chip", { hasText: "Finished" }).waitFor();
  await picture(page, "queue-next-400-dark");
  await card.getByRole("link", { name: "Next: a.gcode" }).click();
  await queue.getByRole("button", { name: "Remove a.gcode" }).click();
  await queue.waitFor({ state: "detached" });
});

test("a print is started, watched, paused and cancelled", async ({ page }) => {
  await page.getByRole("button", { name: "demo.gcode" }).click();
  await page.getByRole("button", { name: "Print", exact: true }).click();
  const card = page.getByRole("region", { name: "Print" });
  await card.getByText(/Waiting for \w+/).waitFor();
  await card.locator(".chip", { hasText: "Printing" }).waitFor();
  await picture(page, "printing-1280-light");
  await page.setViewportSize({ width: 360, height: 740 });
  await picture(page, "printing-360-light");
  await card.getByRole("button", { name: "Pause" }).click();
  await card.locator(".chip", { hasText: "Paused" }).waitFor();
  await card.getByRole("button", { name: "Cancel" }).click();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Keep printing" }).click();
  await card.getByRole("button", { name: "Resume" }).click();
  await card.locator(".chip", { hasText: "Printing" }).waitFor();

  // A halt interrupts it: it resumes once the printer is started again.
  await page.getByRole("button", { name: "STOP" }).click();
  await page.getByRole("button", { name: "Start again" }).click();
  await card.getByText("The print of demo.gcode was interrupted at line").waitFor();
  await expectAccessible(page);
  await picture(page, "interrupted-1280-light");
  await card.getByRole("button", { name: "Resume the print" }).click();
  await card.locator(".chip", { hasText: "Printing" }).waitFor();
  await card.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Cancel the print" }).click();
  await card.locator(".chip", { hasText: "Cancelled" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByText("History", { exact: true }).click();
  await page.getByRole("listitem").filter({ hasText: "Cancelled" }).waitFor();
});
