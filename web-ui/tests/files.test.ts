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

test("a file that leaves the machine cannot be printed, with the reason", async ({ page }) => {
  await upload(page, "far.gcode", "G28\nG1 X999 F3000\n");
  await row(page, "far.gcode").getByText("Cannot be printed").waitFor();
  await page.getByText(/999/).waitFor();
  expect(await page.getByRole("button", { name: "Print", exact: true }).isDisabled()).toBe(true);
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
  await card.locator(".chip", { hasText: "Printing" }).waitFor({ timeout: 30_000 });
  await card.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Cancel the print" }).click();
  await card.locator(".chip", { hasText: "Cancelled" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByText("History", { exact: true }).click();
  await page.getByRole("listitem").filter({ hasText: "Cancelled" }).waitFor();
});
