import { expectAccessible, expectFits, picture } from "./browser";
import { test } from "./fixtures";

test("a line is explained through its stages, also one of a file", async ({ page }) => {
  await page.getByRole("link", { name: "Learn" }).click();
  await page.getByRole("button", { name: "G1 X10 Y10 F3000" }).click();
  for (const stage of ["Text", "Words", "Plan", "Junctions", "Steps"]) {
    await page.getByRole("heading", { name: stage, exact: true }).waitFor();
  }
  await page.getByText("14.142 mm").waitFor();
  for (const [width, colorScheme] of [[360, "dark"], [1280, "light"]] as const) {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await expectFits(page);
    await expectAccessible(page);
    await picture(page, `learn-${width}-${colorScheme}`);
  }
  await page.evaluate(() => (location.hash = "#/learn/demo.gcode:30268"));
  await page.getByText("demo.gcode:30268").waitFor();
});
