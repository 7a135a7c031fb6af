import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { test, testOf } from "./fixtures";

test("a key is changed, checked beside its field, reviewed, and acts at once", async ({ page }) => {
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByRole("button", { name: "axes.x" }).click();
  const speed = page.getByRole("textbox", { name: "speed_mm_s" });
  expect(await speed.inputValue()).toBe("300");
  await speed.fill("-5");
  await speed.press("Enter");
  await page.getByText("Errors: 1").waitFor();
  await page.getByText(/axes\.x\.speed_mm_s is -5/).waitFor();
  await expectAccessible(page);
  await picture(page, "machine-error-1280-light");
  await speed.fill("250");
  await speed.press("Enter");
  await page.getByText("Changed keys: 1").waitFor();
  await page.getByRole("button", { name: "Review" }).click();
  await page.getByRole("dialog").getByText("acts at once").waitFor();
  await expectAccessible(page);
  await picture(page, "machine-review-1280-light");
  await page.getByRole("button", { name: "Write the machine file" }).click();
  await page.getByText("In force now: axes.x.speed_mm_s.").waitFor();
  await expectAccessible(page);
});

test("the board shows what uses each socket, and conflicts", async ({ page }) => {
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByRole("link", { name: "X_MAX, free" }).waitFor();
  await page.getByRole("link", { name: "D9 part, used, fans.part.pin" }).click();
  const pin = page.getByRole("textbox", { name: "fans.part.pin" });
  await pin.fill("D10");
  await pin.press("Enter");
  await page.getByRole("link", { name: "D10 conflict, heaters.hotend.pin, fans.part.pin" }).waitFor();
  await expectAccessible(page);
  await picture(page, "machine-conflict-1280-light");
  await page.setViewportSize({ width: 360, height: 800 });
  await expectFits(page);
  await page.getByRole("button", { name: "Discard" }).click();
});

test("the text is edited, undone, and a machine of the library copied", async ({ page }) => {
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByText("Text", { exact: true }).click();
  const text = page.getByLabel("Machine file, TOML");
  const before = await text.inputValue();
  await text.fill(before.replace("[axes.y]", "[axes.y"));
  await page.getByText("Errors: 1").waitFor();
  await page.getByText("is not valid TOML").waitFor();
  const line = before.slice(0, before.indexOf("[axes.y]")).split("\n").length;
  await page.getByRole("button", { name: `Line ${line}` }).click();
  const selected = (area: HTMLTextAreaElement) => area.value.slice(area.selectionStart, area.selectionEnd);
  expect(await text.evaluate(selected)).toBe("[axes.y");
  await expectAccessible(page);
  await picture(page, "machine-text-1280-light");
  await page.getByRole("button", { name: "Undo" }).click();
  expect(await text.inputValue()).toBe(before);
  await page.getByText("Library", { exact: true }).click();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Copy delta into the editor" }).click();
  expect(await text.inputValue()).toMatch(/kind = "delta"/);
  await page.getByRole("button", { name: "Discard" }).click();
});

testOf({ shipped: true, state: true })("a shipped machine is saved as one's own, which is used from then on", async ({ served, visit }) => {
  const { page } = visit;
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByRole("button", { name: "axes.x" }).click();
  const end = page.getByRole("textbox", { name: "max_mm" });
  await end.fill("251");
  await end.press("Enter");
  await page.getByText("This machine comes with Passo.").waitFor();
  await page.setViewportSize({ width: 1280, height: 1400 }); // nothing is under the bar
  await expectAccessible(page);
  await picture(page, "machine-own-1280-light");
  await page.getByRole("button", { name: "Save as my machine" }).click();
  await page.getByText(/^Saved as .*machines.i3.toml/).waitFor();
  await served.stop(); // it has restarted at another port; a later start has the file too
  await served.start();
  await page.getByText(/^Saved as/).waitFor({ state: "detached" });
  expect(await end.inputValue()).toBe("251");
  await end.fill("252");
  await end.press("Enter");
  await page.getByText("Changed keys: 1").waitFor(); // of a file that can be written
  expect(await page.getByRole("button", { name: "Save as my machine" }).count()).toBe(0);
  visit.faults.length = 0; // the browser logs each attempt to connect
});

test("the firmware of a RAMPS is built, with its sizes, and downloaded", async ({ page }) => {
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByText("Firmware", { exact: true }).click();
  await page.getByRole("button", { name: "Build the image" }).click();
  await page.getByText("Done", { exact: true }).waitFor();
  expect(await page.getByRole("meter").count()).toBe(2);
  const [zip] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("link", { name: "Download as zip" }).click(),
  ]);
  expect(zip.suggestedFilename()).toBe("firmware-i3.zip");
  await expectAccessible(page);
  for (const width of [360, 1280]) {
    await page.setViewportSize({ width, height: 800 });
    await expectFits(page);
    await picture(page, `firmware-${width}-light`);
  }
});

test("a board is flashed, with its step by hand and the log", async ({ page }) => {
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByText("Firmware", { exact: true }).click();
  await page.getByRole("combobox", { name: "Board" }).selectOption("teensy3-mk20dx256");
  await page.getByRole("button", { name: "Build the image" }).click();
  await page.getByRole("heading", { name: "Build of teensy3-mk20dx256" }).waitFor();
  const flash = page.getByRole("button", { name: "Flash the board" });
  await flash.click(); // once the image is built
  const dialog = page.getByRole("dialog", { name: "Flash teensy3-mk20dx256.hex?" });
  await dialog.waitFor();
  await expectAccessible(page);
  await picture(page, "flash-dialog-1280-light");
  await dialog.getByRole("button", { name: "Flash the board" }).click();
  await page.getByText("Waits for you").waitFor();
  await page.getByRole("alert").getByText("Press the button on the Teensy.").waitFor();
  await expectAccessible(page);
  await picture(page, "flash-by-hand-1280-light");
  await page.getByRole("button", { name: "Done, continue" }).click();
  await page.getByText("Written", { exact: true }).waitFor();
  await page.getByRole("region", { name: "Log of the flashing" }).getByText("Programming").waitFor();
  await page.setViewportSize({ width: 360, height: 800 });
  await expectFits(page);
  await picture(page, "flash-360-light");
});

test("without a probe, babysteps set Z to the paper", async ({ page }) => {
  await page.getByRole("link", { name: "Calibrate" }).click();
  await page.getByRole("link", { name: "Paper test" }).click();
  await page.getByRole("button", { name: "Home and approach" }).click();
  await page.getByText("Now the test").waitFor();
  expect(await page.getByText("Finished").count()).toBe(0);
  await page.getByRole("button", { name: "−0.05" }).click();
  await page.getByText("-0.050 mm").waitFor();
  await page.getByRole("button", { name: "Keep it" }).click();
  const result = page.getByRole("region", { name: "Changed settings", exact: true });
  await result.getByRole("row", { name: "M206 Z" }).getByText("0.05", { exact: true }).first().waitFor();
});

test("settings show the appearance, the values of commands and the logs", async ({ page }) => {
  await page.getByRole("link", { name: "Settings" }).click();
  await page.getByText("Dark", { exact: true }).click();
  await expect.poll(() => page.locator("html").getAttribute("data-theme")).toBe("dark");
  await page.getByRole("button", { name: "Show all" }).click();
  await page.getByRole("cell", { name: "M92 X" }).waitFor();
  await page.setViewportSize({ width: 360, height: 800 });
  await expectFits(page);
  await expectAccessible(page);
  await picture(page, "settings-all-360-dark");
  await page.getByText("Italiano").click();
  await page.getByRole("heading", { name: "Aspetto" }).waitFor();
});

const testParts = testOf({ machine: "i3-all-parts", clock: 10 });

testParts("each part of the machine is tested, with its live state", async ({ page, served }) => {
  const simulate = async (part: string, fault: string) => {
    const url = `${served.url}api/v1/simulation/parts/${part}`;
    const answer = await page.request.put(url, { headers: { "X-Passo-Request": "1" }, data: { fault } });
    expect(answer.status()).toBe(204);
  };
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByText("Test parts", { exact: true }).click();
  const row = (name: string) => page.getByRole("listitem", { name, exact: true });

  const door = row("door");
  await door.getByText("Not active").waitFor();
  await door.getByRole("button", { name: "Test door" }).click();
  await door.getByText("Press the switch now").waitFor();
  await simulate("button-door", "pressed");
  await door.getByText("Active", { exact: true }).waitFor();
  await door.getByText("Now the other way back").waitFor();
  await simulate("button-door", "none");
  await door.getByText("Works: both changes seen").waitFor();

  const encoder = row("encoder");
  await encoder.getByRole("button", { name: "Test encoder" }).click();
  await encoder.getByText("Move the filament now: 0 pulses").waitFor();
  const data = { script: "M302 P1\nM83\nG1 E60 F600" };
  await page.request.post(`${served.url}api/v1/console`, { headers: { "X-Passo-Request": "1" }, data });
  await encoder.getByText(/Works: \d+ pulses/).waitFor();

  const endstop = page.getByRole("region", { name: "Switches" }).getByRole("listitem", { name: "x", exact: true });
  await endstop.getByRole("button", { name: "Test x" }).click();
  await simulate("x-endstop", "triggered");
  await endstop.getByText("Now the other way back").waitFor();
  await simulate("x-endstop", "open");
  await endstop.getByText("Works: both changes seen").waitFor();

  await page.getByRole("switch", { name: "pump" }).click();
  await expect.poll(() => page.getByRole("switch", { name: "pump" }).getAttribute("aria-checked")).toBe("true");
  await page.getByRole("slider", { name: "light" }).fill("40");
  await page.locator(".slider", { has: page.getByRole("slider", { name: "light" }) }).getByText("40").waitFor();

  await page.getByRole("button", { name: "Spin part" }).click();
  await row("part").getByText("100 %").waitFor();
  await page.getByRole("button", { name: "Stop part" }).click();
  await row("part").getByText("0 %", { exact: true }).waitFor();
  await page.getByRole("button", { name: "Spin electronics" }).click();
  await page.getByRole("button", { name: "Stop electronics" }).waitFor();

  const frame = row("frame");
  await frame.getByRole("button", { name: "Test frame" }).click();
  for (const colour of ["red", "green", "blue", "white"]) {
    await frame.getByText(`Is it ${colour} now?`).waitFor();
    await frame.getByRole("button", { name: "Next colour of frame" }).click();
  }
  await frame.getByText("Off", { exact: true }).waitFor();
  await row("head").getByRole("button", { name: "Test head" }).click();
  await expect.poll(() => row("head").locator(".leds span").last().getAttribute("style")).toContain("rgb(255, 0, 0)");

  await page.getByRole("slider", { name: "Angle of cover" }).fill("90");
  await row("cover").getByText("90°", { exact: true }).first().waitFor();
  await page.getByRole("button", { name: "Signal off: cover" }).click();
  await row("cover").getByText("no signal").waitFor();

  await row("chamber").getByText("Reads").waitFor();
  const drivers = page.getByRole("region", { name: "Motor drivers" });
  const driver = drivers.getByRole("listitem", { name: "x" });
  await driver.getByText(/0\.8\d A, 0\.8\d A at standstill/).waitFor();
  await driver.getByText("No fault").waitFor();
  await driver.getByRole("button", { name: "Turn motor x" }).click();
  await driver.getByText("The motor turns 1 mm forth and back").waitFor();
  await driver.getByRole("button", { name: "Turn motor x", disabled: false }).waitFor();
  await simulate("z-driver", "hot");
  await drivers.getByRole("listitem", { name: "z" }).getByText(/soon switch the motor off\. Cool it better/).waitFor();
  await drivers.getByRole("listitem", { name: "z" }).getByText("The driver reports: hot").waitFor();

  for (const [width, colorScheme] of [[1440, "light"], [360, "dark"]] as const) {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme });
    await expectFits(page);
    await expectAccessible(page);
    await picture(page, `parts-${width}-${colorScheme}`);
  }
});

testParts("the threshold of homing by stalls is found, and undone", async ({ page, served }) => {
  const data = { script: "G28\nG1 Y110 F6000\nM400" };
  await page.request.post(`${served.url}api/v1/console`, { headers: { "X-Passo-Request": "1" }, data });
  await page.getByRole("link", { name: "Machine" }).click();
  await page.getByText("Test parts", { exact: true }).click();
  await page.getByRole("listitem", { name: "y", exact: true }).getByRole("link", { name: "Calibrate" }).click();
  await page.getByText("The threshold now: 60").waitFor();
  await page.getByRole("spinbutton", { name: "Homings" }).fill("2");
  await page.getByRole("button", { name: "Start" }).click();
  await page.getByText(/in place of 60; 2 times it stopped within/).waitFor();
  const changed = page.getByRole("row", { name: "M914 Y" });
  await changed.waitFor();
  await expectAccessible(page);
  await picture(page, "calibrate-stall-1280-light");
  await page.getByRole("button", { name: "Undo" }).click();
  await page.getByText("The threshold now: 60").waitFor();
});
