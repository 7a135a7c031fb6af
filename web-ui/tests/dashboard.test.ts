import type { Page } from "playwright-core";
import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { testOf } from "./fixtures";

const test = testOf({ state: true });

const state = (page: Page, text: string) => page.locator("header .state", { hasText: text }).waitFor();
const position = (page: Page, axis: string) =>
  page.locator(".axis", { has: page.locator(`strong:text-is("${axis}")`) }).locator(".live");

test("the page is live, and names the machine", async ({ page }) => {
  await state(page, "Ready");
  expect(await page.locator("header strong").textContent()).toBe("i3");
  const hotend = page.getByRole("group", { name: "hotend" });
  expect(await hotend.locator(".now").textContent()).toContain("25.0");
  await page.getByText("Simulated printer.").waitFor();
});

test("an axis can be moved once it is homed, and moves by the step", async ({ page }) => {
  const right = page.getByRole("button", { name: "Move X by +10 mm" });
  expect(await right.isDisabled()).toBe(true);
  await page.getByRole("button", { name: "Home all" }).click();
  await expect.poll(() => right.isEnabled()).toBe(true);
  expect(await page.getByText("not homed").count()).toBe(0);
  await right.click();
  await position(page, "X").getByText("10.00").waitFor();
  await page.getByText("0.1", { exact: true }).click();
  await page.getByRole("button", { name: "Move X by −0.1 mm" }).click();
  await position(page, "X").getByText("9.90").waitFor();
  await page.getByRole("button", { name: "+0.05" }).click();
  await page.getByRole("button", { name: "Keep it" }).click();
  await page.getByRole("log").getByText("M206 Z: 0.000 -> -0.050").waitFor();
  await page.getByRole("log").getByText("Settings Stored").waitFor();
  await page.getByRole("button", { name: "Keep it" }).waitFor({ state: "detached" });
});

test("a heater heats to its target, and its field refuses what is too hot", async ({ page }) => {
  const target = page.getByLabel("Target of hotend", { exact: true });
  await target.fill("300");
  await page.getByText("At most 285 °C").waitFor();
  await target.fill("80");
  await target.press("Enter");
  const now = page.getByRole("group", { name: "hotend" }).locator(".now");
  await expect.poll(async () => parseFloat((await now.textContent()) ?? "")).toBeGreaterThan(78);
  await page.getByLabel("Usual targets of hotend").selectOption("Off");
  await expect.poll(() => target.inputValue()).toBe("");
});

test("the console completes, explains, sends and answers", async ({ page }) => {
  const input = page.getByRole("combobox", { name: "Command" });
  await input.pressSequentially("m11");
  await page.getByRole("option", { name: "M115" }).waitFor();
  await input.press("Control+a");
  await input.pressSequentially("M115");
  await input.press("Enter");
  await page.getByRole("log").getByText("FIRMWARE_NAME:Passo").waitFor();
  await input.press("ArrowUp");
  expect(await input.inputValue()).toBe("M115");
  await input.fill("M9876");
  await input.press("Enter");
  await page.getByRole("log").getByText(/M9876/).nth(1).waitFor();
});

test("a question of the printer is seen and answered on every page", async ({ page }) => {
  const input = page.getByRole("combobox", { name: "Command" });
  await input.fill("M0 Insert the magnets");
  await input.press("Enter");
  const question = page.getByRole("alert").filter({ hasText: "Insert the magnets" });
  await question.waitFor();
  expect(await page.title()).toBe("? Dashboard · Passo");
  await expectAccessible(page);
  await page.getByRole("link", { name: "Settings" }).click();
  await question.getByRole("button", { name: "Continue" }).click();
  await question.waitFor({ state: "detached" });
});

test("STOP halts with the catalogue's sentence, and the printer starts again", async ({ page }) => {
  await page.keyboard.press("?");
  await page.getByRole("dialog").getByRole("button", { name: "STOP" }).click(); // it is in reach there too
  await state(page, "Halted");
  await picture(page, "stop-in-dialog-1280-light");
  await page.keyboard.press("Escape");
  const alert = page.getByRole("alert").first();
  await alert.getByText(/M112|emergency/i).first().waitFor();
  expect(await page.getByRole("button", { name: "Home all" }).isDisabled()).toBe(true);
  await picture(page, "halted-1280-light");
  await expectAccessible(page);
  await page.getByRole("button", { name: "Start again" }).click();
  await state(page, "Ready");
  await page.getByRole("combobox", { name: "Command" }).focus();
  await page.keyboard.press("Control+Shift+E");
  await state(page, "Halted");
  await page.getByRole("button", { name: "Start again" }).click();
  await state(page, "Ready");
});

test("sliders set speed, flow and fans", async ({ page }) => {
  const speed = page.getByLabel("Speed", { exact: true });
  await speed.fill("120");
  await page.locator(".slider", { has: speed }).getByText("120").waitFor();
  const fan = page.getByLabel("part", { exact: true });
  await fan.fill("50");
  await page.locator(".slider", { has: fan }).getByText("50").waitFor();
  await speed.fill("100");
  await fan.fill("0");
});

test("values turn grey with their age while Passo is away, and live again after", async ({ page, served, visit }) => {
  await served.stop();
  await page.getByRole("alert").getByText("Passo does not answer.").waitFor();
  await page.getByText(/All values are [1-9]\d* s old/).waitFor();
  expect(await page.getByRole("region", { name: "Messages" }).getByText("Passo does not answer").count()).toBe(0);
  await picture(page, "away-1280-light");
  await served.start();
  await state(page, "Ready");
  await page.getByRole("alert").waitFor({ state: "detached" });
  visit.faults.length = 0; // the browser logs each attempt to connect
});

test("every control of the frame is reached by the keyboard", async ({ page }) => {
  const reached: string[] = [];
  for (let i = 0; i < 10; i++) {
    await page.keyboard.press("Tab");
    reached.push(
      await page.evaluate(() => {
        const element = document.activeElement;
        return element?.getAttribute("aria-label") ?? element?.textContent?.trim() ?? "";
      }),
    );
  }
  expect(reached).toEqual(
    expect.arrayContaining(["To the content", "No faults", "Dark theme", "STOP", "Dashboard", "Files"]),
  );
});

test("keys open pages and their list, until they are switched off", async ({ page }) => {
  await page.keyboard.press("2");
  await page.getByRole("heading", { name: "Files" }).waitFor({ state: "attached" });
  await page.keyboard.press("?");
  await page.getByRole("dialog", { name: "Keyboard shortcuts" }).waitFor();
  await expectAccessible(page);
  await page.getByLabel("Use the shortcuts").uncheck();
  await page.keyboard.press("Escape");
  await page.keyboard.press("1");
  await page.keyboard.press("?"); // which is taken after the key before it
  await page.getByRole("dialog", { name: "Keyboard shortcuts" }).waitFor();
  expect(new URL(page.url()).hash).toBe("#/files");
});

test("the theme that is chosen stays", async ({ page }) => {
  await page.getByRole("button", { name: "Dark theme" }).click();
  await page.reload();
  await page.getByRole("button", { name: "Light theme" }).waitFor();
});

test("the page speaks Italian, and stays so", async ({ page }) => {
  await page.getByRole("button", { name: "Italiano" }).click();
  await page.getByRole("heading", { name: "Movimento" }).waitFor();
  await page.reload();
  await page.getByRole("heading", { name: "Movimento" }).waitFor();
  expect(await page.locator("html").getAttribute("lang")).toBe("it");
});

testOf({ machine: "i3-all-parts" })("sensors, outputs, lights and filament sensors have cards", async ({ page }) => {
  const chamber = page.getByRole("group", { name: "chamber" });
  await chamber.locator(".now", { hasText: /^3\d\.\d/ }).waitFor();
  await page.getByRole("img", { name: /Temperatures of hotend, bed, chamber, electronics/ }).waitFor();

  const outputs = page.getByRole("region", { name: "Outputs" });
  await outputs.getByRole("switch", { name: "pump" }).press("Space");
  await expect.poll(() => outputs.getByRole("switch", { name: "pump" }).getAttribute("aria-checked")).toBe("true");
  await outputs.getByRole("slider", { name: "light" }).fill("25");
  await outputs.locator(".slider").getByText("25").waitFor();

  const lights = page.getByRole("region", { name: "Lights" });
  await lights.getByLabel("Colour of head").fill("#ff8000");
  const led = () => lights.getByRole("listitem", { name: "head" }).locator(".leds span").first().getAttribute("style");
  await expect.poll(led).toContain("rgb(255, 128, 0)");
  await lights.getByRole("switch", { name: "frame" }).click();
  await expect.poll(() => lights.getByRole("slider", { name: "White" }).inputValue()).toBe("100");

  const filament = page.getByRole("region", { name: "Filament sensors" });
  const roll = filament.getByRole("listitem").filter({ hasText: "roll" });
  await roll.getByText("Filament detected").waitFor();
  await roll.getByRole("switch", { name: "Sensor roll" }).click();
  await roll.getByText("Switched off").waitFor();

  for (const [width, colorScheme] of [[1440, "dark"], [360, "light"]] as const) {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme });
    await expectFits(page);
    await expectAccessible(page);
    await picture(page, `dashboard-parts-${width}-${colorScheme}`);
  }
});
