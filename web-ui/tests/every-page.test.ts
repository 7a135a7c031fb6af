import { readdirSync } from "node:fs";
import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { testOf } from "./fixtures";

const test = testOf({ machine: "i3-probe", clock: 20 });
const TASKS = readdirSync("src/calibrate/tasks").map((file) => file.replace(".svelte", "").toLowerCase());
/** Each page, with what shows that it is complete. */
const PAGES: Record<string, string> = {
  dashboard: "section.card",
  files: "tbody tr",
  "viewer/demo.gcode": "canvas",
  machine: ".side svg",
  ...Object.fromEntries(TASKS.map((task) => [`calibrate/${task}`, ".task section.card"])),
  learn: "section.card",
  settings: "section.card",
};
/** Each language in both themes; the phone in both languages. */
const LOOKS = [
  ["en", "light", 1280],
  ["en", "dark", 360],
  ["it", "light", 360],
  ["it", "dark", 768],
] as const;

test("the page is at most 400 kB, and the viewer comes when it is asked for", async ({ page }) => {
  const loaded = await page.evaluate(() =>
    (performance.getEntriesByType("resource") as PerformanceResourceTiming[])
      .filter(({ name }) => name.includes("/assets/"))
      .map(({ name, encodedBodySize }) => [name.replace(/.*\/|-.*/g, ""), encodedBodySize] as const),
  );
  expect(loaded.map(([name]) => name)).not.toContain("scene");
  const bytes = loaded.reduce((sum, [, size]) => sum + size, 0);
  expect(bytes).toBeGreaterThan(50_000); // they are counted
  expect(bytes).toBeLessThan(400_000);
});

for (const [language, colorScheme, width] of LOOKS) {
  test(`every page in ${language} and ${colorScheme}, ${width} px wide`, async ({ page }) => {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme });
    if (language === "it") {
      await page.getByRole("button", { name: "Italiano" }).click();
      await expect.poll(() => page.locator("html").getAttribute("lang")).toBe("it");
    }
    for (const [hash, part] of Object.entries(PAGES)) {
      await page.evaluate((to) => (location.hash = `#/${to}`), hash);
      await page.locator(part).first().waitFor();
      await expectFits(page);
      await expectAccessible(page);
      await picture(page, `${hash.split("/").slice(0, 2).join("-").replace(".gcode", "")}-${width}-${language}-${colorScheme}`);
    }
  });
}
