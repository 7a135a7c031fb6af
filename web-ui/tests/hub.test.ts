/** The page of `passo hub` with five printers that `passo serve` simulates. */

import type { Page } from "playwright-core";
import { expect, test as base } from "vitest";
import { expectAccessible, launch } from "./browser";
import { Served, ServedHub } from "./served";

const COUNT = 5;
const PLANNED_MS = 120_000; // the hub plans a file with low priority
const SQUARE = "G28\nG1 X50 Y50 F3000\nG1 X100\nG1 Y100\n";
const LONG = `G28\n${"G1 X50 Y50 F3000\nG1 X100 Y100\n".repeat(2000)}`;
const WRITES = { "X-Passo-Request": "1" };

const test = base
  .extend("farm", { scope: "file" }, async ({}, { onCleanup }) => {
    const hub = new ServedHub();
    const printers = Array.from({ length: COUNT }, () => new Served({ clock: 40, state: true }));
    onCleanup(async () => void (await Promise.all([hub, ...printers].map((one) => one.remove()))));
    await Promise.all([hub, ...printers].map((one) => one.start()));
    return { hub, printers };
  })
  .extend("browser", { scope: "file" }, async ({}, { onCleanup }) => {
    const browser = await launch();
    onCleanup(() => browser.close());
    return browser;
  })
  .extend("page", async ({ browser, farm }, { onCleanup }) => {
    const page = await browser.newPage({ reducedMotion: "reduce", viewport: { width: 1280, height: 900 } });
    page.setDefaultTimeout(45_000);
    const faults: string[] = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    onCleanup(async () => {
      await page.context().close();
      expect(faults).toEqual([]);
    });
    await page.goto(farm.hub.url);
    return page;
  });

const card = (page: Page, name: string) => page.getByRole("article", { name, exact: true });
const state = (page: Page, name: string, text: string) => card(page, name).locator("header .chip", { hasText: text }).waitFor();
const go = (page: Page, name: string) => page.getByRole("navigation").getByRole("link", { name }).click();

test("printers are added by address", async ({ page, farm }) => {
  await page.getByRole("heading", { name: "No printer yet" }).waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Add a printer" }).click();
  const dialog = page.getByRole("dialog", { name: "Add a printer" });
  await dialog.getByLabel("Address").fill("127.0.0.1:9");
  await dialog.getByRole("button", { name: "Add the printer" }).click();
  await dialog.getByText(/does not answer/).waitFor();
  await expectAccessible(page);
  await dialog.getByLabel("Address").fill(new URL(farm.printers[0]?.url ?? "").host);
  await dialog.getByLabel("Name in the farm").fill("P1");
  await dialog.getByLabel("Tags").fill("left");
  await dialog.getByRole("button", { name: "Add the printer" }).click();
  await state(page, "P1", "To clear");
  for (const [number, printer] of farm.printers.entries()) {
    if (number === 0) continue;
    const data = { url: printer.url, name: `P${number + 1}`, tags: [number < 3 ? "left" : "right"] };
    const added = await page.context().request.post(`${farm.hub.url}api/v1/printers`, { headers: WRITES, data });
    expect(added.status()).toBe(201);
  }
  for (let number = 1; number <= COUNT; number++) await state(page, `P${number}`, "To clear");
});

test("a file is uploaded, prints on all five once their beds are clear, and they are cleared again", async ({ page }) => {
  for (let number = 1; number <= COUNT; number++) await page.getByRole("checkbox", { name: `Select P${number}` }).check();
  await page.getByRole("button", { name: "Print a file on each …" }).click();
  const dialog = page.getByRole("dialog", { name: "Print a file on 5 printers" });
  await dialog.locator("input[type=file]").setInputFiles({ name: "square.gcode", mimeType: "text/x.gcode", buffer: Buffer.from(SQUARE) });
  await dialog.getByText("Beds that are not clear yet: 5.").waitFor();
  await dialog.getByRole("button", { name: "Print on 5" }).click();
  await dialog.waitFor({ state: "detached" }); // it ends the selection
  for (let number = 1; number <= COUNT; number++) await page.getByRole("checkbox", { name: `Select P${number}` }).check();
  await page.getByRole("button", { name: "The beds are clear (5)" }).click();
  await page.getByRole("button", { name: "All 5 beds are clear" }).click();
  for (let number = 1; number <= COUNT; number++) {
    await card(page, `P${number}`).getByText("Last print: finished. Take it off the bed.").waitFor({ timeout: PLANNED_MS });
  }
  await page.getByRole("button", { name: "The bed is clear: P1" }).click();
  await page.getByRole("button", { name: "The bed is clear", exact: true }).last().click();
  await card(page, "P1").getByText("Ready for the next job").waitFor();
  await go(page, "History");
  await expect.poll(() => page.locator("main li", { hasText: "Finished" }).count()).toBe(COUNT);
});

test("a stopped print fails, and its printer needs a person", async ({ page }) => {
  await go(page, "Files");
  await page.locator("main input[type=file]").setInputFiles({ name: "long.gcode", mimeType: "text/x.gcode", buffer: Buffer.from(LONG) });
  const details = page.getByRole("complementary", { name: "long.gcode" });
  await expect.poll(() => details.locator("td", { hasText: "Fits" }).count(), { timeout: PLANNED_MS }).toBe(COUNT);
  await details.getByRole("button", { name: "Add a job" }).click();
  await page.getByRole("button", { name: "Add to the queue" }).click();
  await go(page, "Printers");
  await card(page, "P1").getByRole("progressbar").waitFor({ timeout: PLANNED_MS });
  await card(page, "P1").getByRole("button", { name: "STOP P1" }).click();
  await card(page, "P1").getByRole("button", { name: "STOP P1" }).click();
  await state(page, "P1", "Needs you");
  await expectAccessible(page);
  await page.screenshot({ path: "../build/pictures/farm-failed-1280-light.png" });
  await card(page, "P1").getByRole("button", { name: "Dealt with" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Dealt with" }).click();
  await state(page, "P1", "Halted");
});

test("an account that is limited to a tag sees its printers alone", async ({ page }) => {
  await page.getByRole("button", { name: "Create the administrator" }).click();
  await page.getByLabel("Name").fill("ada");
  await page.getByLabel("Password").fill("a long password");
  await page.getByRole("button", { name: "Create the account" }).click();
  await go(page, "Settings");
  const accounts = page.getByRole("region", { name: "Accounts" });
  await accounts.getByLabel("Name").fill("bob");
  await accounts.getByLabel("Password").fill("another long password");
  await accounts.getByRole("button", { name: "Add", exact: true }).click();
  await accounts.getByLabel("Printers of bob").fill("right");
  await accounts.getByLabel("Printers of bob").press("Enter");
  await accounts.getByText("right", { exact: true }).waitFor();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Log out ada" }).click();
  await page.getByRole("heading", { name: "Log in" }).waitFor();
  await page.getByLabel("Name").fill("bob");
  await page.getByLabel("Password").fill("another long password");
  await page.getByLabel("Password").press("Enter");
  await go(page, "Printers");
  await card(page, "P5").waitFor();
  expect(await page.getByRole("article").count()).toBe(2);
});
