import { expect, test } from "vitest";
import { expectAccessible, launch, picture } from "./browser";
import { Served } from "./served";

test("the first account is made, and the page asks for it from then on", async () => {
  const served = new Served();
  const [browser] = await Promise.all([launch(), served.start()]);
  const page = await browser.newPage({ reducedMotion: "reduce" });
  page.setDefaultTimeout(15_000);
  await page.goto(served.url);
  await page.getByRole("button", { name: "Create the administrator" }).click();
  await expectAccessible(page);
  await page.getByLabel("Name").fill("ada");
  await page.getByLabel("Password").fill("a long password");
  await page.getByRole("button", { name: "Create the account" }).click();
  await page.getByRole("button", { name: "Log out ada" }).click();
  await page.getByRole("heading", { name: "Log in" }).waitFor();
  await expectAccessible(page);
  await picture(page, "log-in-1280-light");
  await page.getByLabel("Name").fill("ada");
  await page.getByLabel("Password").fill("a wrong password");
  await page.getByRole("button", { name: "Log in" }).click();
  await page.getByRole("alert").locator(".text").waitFor();
  expect(await page.getByLabel("Password").inputValue()).toBe("");
  await page.getByLabel("Password").fill("a long password");
  await page.getByLabel("Password").press("Enter");
  await page.getByRole("heading", { name: "Temperatures" }).waitFor();

  // A viewer sees no control of an operator.
  await page.getByRole("link", { name: "Settings" }).click();
  const accounts = page.getByRole("region", { name: "Accounts" });
  await accounts.getByLabel("Name").fill("bob");
  await accounts.getByLabel("Password").fill("another long password");
  await accounts.getByLabel("Role", { exact: true }).selectOption("viewer");
  await accounts.getByRole("button", { name: "Add" }).click();
  await page.getByLabel("Role of bob").waitFor();
  await expectAccessible(page);
  await picture(page, "accounts-1280-light");
  await page.getByRole("button", { name: "Log out ada" }).click();
  await page.getByRole("heading", { name: "Log in" }).waitFor();
  await page.getByLabel("Name").fill("bob");
  await page.getByLabel("Password").fill("another long password");
  await page.getByLabel("Password").press("Enter");
  await page.getByRole("navigation").getByRole("link", { name: "Dashboard" }).click();
  await page.getByText("Your account can view, but not move the axes.").waitFor();
  for (const name of ["STOP", "Extrude", "Send"]) {
    expect(await page.getByRole("button", { name, exact: true }).count()).toBe(0);
  }
  await expectAccessible(page);
  await picture(page, "viewer-role-1280-light");
  await page.getByRole("link", { name: "Files" }).click();
  await page.getByRole("row", { name: "demo.gcode" }).waitFor();
  const transfer = await page.evaluateHandle(() => {
    const dragged = new DataTransfer();
    dragged.items.add(new File(["G28"], "home.gcode"));
    return dragged;
  });
  await page.dispatchEvent("body", "dragenter", { dataTransfer: transfer });
  for (const text of ["Drop files to put them onto the SD card", "Upload"]) {
    expect(await page.getByText(text).count()).toBe(0);
  }

  await browser.close();
  await served.remove();
});
