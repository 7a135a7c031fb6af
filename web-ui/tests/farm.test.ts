/** The page of a farm that is made up: how it looks, how fast it is, and what it asks for. */

import { statSync } from "node:fs";
import type { Page } from "playwright-core";
import { expect, test as base } from "vitest";
import { expectAccessible, expectFits, launch, picture, type Theme } from "./browser";
import { fake, FARM, type FakeFarm } from "./farm-fake";
import { job, printer } from "./farm-printers";

const JOBS = [job(0, { priority: 5, why: "" }), job(1), job(2, { paused: true, tags: ["large"] }), job(3, { waiting: 0, running: 0, done: 12, why: "" })];
const printers = (count: number) => Array.from({ length: count }, (_, number) => printer(number));

interface Seen {
  page: Page;
  farm: FakeFarm;
  /** Errors of the console and of scripts. */
  faults: string[];
}

const test = base
  .extend("browser", { scope: "file" }, async ({}, { onCleanup }) => {
    const browser = await launch();
    onCleanup(() => browser.close());
    return browser;
  })
  /** Opens the page of a farm of so many printers; nothing may go wrong in it. */
  .extend("open", async ({ browser }, { onCleanup }) => {
    const opened: Seen[] = [];
    onCleanup(async () => {
      for (const { page, faults } of opened) {
        await page.context().close();
        expect(faults).toEqual([]);
      }
    });
    return async (count: number, { width = 1280, theme = "light" as Theme, role = "admin", locale = "en-GB" } = {}): Promise<Seen> => {
      const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme: theme, reducedMotion: "reduce", locale, hasTouch: width < 500 });
      const page = await context.newPage();
      page.setDefaultTimeout(45_000);
      const faults: string[] = [];
      page.on("console", (message) => {
        if (message.type() === "error" || message.type() === "warning") faults.push(message.text());
      });
      page.on("pageerror", (error) => faults.push(String(error)));
      const farm = await fake(page, printers(count), JOBS, role);
      await page.goto(FARM);
      await page.locator(count ? "[data-printer]" : "h2").first().waitFor();
      const seen = { page, farm, faults };
      opened.push(seen);
      return seen;
    };
  });

test("each page loads only its own code, and the farm is at most 330 kB", async ({ open }) => {
  const { page } = await open(12);
  const names = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name.replace(/.*\//, "")));
  const assets = names.filter((name) => /\.(js|css|woff2)$/.test(name));
  expect(assets.some((name) => name.startsWith("farm-"))).toBe(true);
  expect(assets.filter((name) => /^(index|scene)-/.test(name))).toEqual([]); // the page of one printer
  const bytes = assets.reduce((sum, name) => sum + statSync(`../src/passo/web/static/assets/${name}`).size, 0);
  expect(bytes).toBeGreaterThan(50_000); // they are counted
  expect(bytes).toBeLessThan(330_000);
});

const LOOKS = [
  [12, "en-GB", "light", 1280],
  [12, "it-IT", "dark", 390],
  [30, "en-GB", "dark", 1280], // rows
  [30, "en-GB", "light", 390],
  [1, "en-GB", "light", 768],
  [0, "it-IT", "light", 1280],
] as const;

for (const [count, locale, theme, width] of LOOKS) {
  test(`${count} printers in ${locale} and ${theme}, ${width} px wide`, async ({ open }) => {
    const { page } = await open(count, { width, theme, locale });
    const look = async (name: string) => {
      await expectFits(page);
      await expectAccessible(page);
      await page.screenshot({ path: `../build/pictures/${name}-${count}-${width}-${theme}.png` });
    };
    await look("farm");
    if (count !== 12) return;
    await page.getByRole("button", { name: "Dante", exact: true }).click();
    await look("farm-details");
    await page.getByRole("button", { name: /^(Close the details|Chiudi i dettagli)$/ }).click();
    for (const name of ["queue", "files", "history", "settings"]) {
      await page.evaluate((to) => (location.hash = `#/${to}`), name);
      await page.locator("main :is(li, .card)").first().waitFor();
      await look(`farm-${name}`);
    }
  });
}

test("a change draws only its own card again", async ({ open }) => {
  const { page, farm } = await open(200);
  await page.evaluate(() => {
    const drawn = ((globalThis as unknown as { drawn: Set<string> }).drawn = new Set<string>());
    new MutationObserver((changes) => {
      for (const { target } of changes) {
        const element = target instanceof Element ? target : target.parentElement;
        drawn.add(element?.closest<HTMLElement>("[data-printer]")?.dataset["printer"] ?? element?.className ?? "");
      }
    }).observe(document.querySelector("main") as Element, { subtree: true, childList: true, characterData: true, attributes: true });
  });
  const seen = printer(20).seen ?? undefined;
  const changed = printer(20, seen ? { seen: { ...seen, heaters: [{ name: "hotend", celsius: 199, target_c: 215 }] } } : {});
  farm.feed()?.send(JSON.stringify({ type: "changes", printers: [changed], jobs: [], groups: null, gone: [], queue_paused: false }));
  await page.getByText("199°").waitFor({ state: "attached" });
  expect(await page.evaluate(() => [...(globalThis as unknown as { drawn: Set<string> }).drawn])).toEqual(["p20"]);
  await page.screenshot({ path: "../build/pictures/farm-200-1280-light.png" });
});

test("STOP acts at its second press, for one printer and for all", async ({ open }) => {
  const { page, farm } = await open(12);
  await page.getByRole("button", { name: "STOP Ada: press twice" }).click();
  expect(farm.asked).toEqual([]);
  await page.getByRole("button", { name: "STOP Ada: press again" }).click();
  await expect.poll(() => farm.asked).toEqual(["POST printers/p0/stop"]);
  await page.getByRole("button", { name: "STOP ALL" }).click();
  await page.getByRole("button", { name: "AGAIN" }).click();
  await expect.poll(() => farm.asked).toEqual(["POST printers/p0/stop", "POST stop"]);
});

test("beds are cleared after a question, one and several", async ({ open }) => {
  const { page, farm } = await open(24);
  await page.getByRole("button", { name: "The bed is clear: Fermi", exact: true }).click();
  await page.getByRole("button", { name: "Back" }).click();
  expect(farm.asked).toEqual([]);
  for (const name of ["Fermi", "Fermi 2", "Ada"]) await page.getByRole("checkbox", { name: `Select ${name}`, exact: true }).check();
  await page.getByRole("button", { name: "The beds are clear (2)" }).click();
  await expectAccessible(page);
  await page.getByRole("button", { name: "All 2 beds are clear" }).click();
  await expect.poll(() => farm.asked).toEqual([5, 17].map((number) => `POST printers/p${number}/clear {"bed_clear":true}`));
  await page.getByText("Selected: 1").waitFor();
});

test("a hub that is lost is named, and comes back by itself", async ({ open }) => {
  const { page, farm } = await open(12);
  await farm.feed()?.close();
  await page.getByRole("alert").getByText("Passo does not answer.").waitFor();
  await page.getByRole("alert").waitFor({ state: "detached" });
});

test("a viewer sees the farm and can change nothing", async ({ open }) => {
  const { page } = await open(12, { role: "viewer" });
  for (const name of [/STOP/, /Pause/, /The bed is clear/, "Add a printer", "Dealt with"]) {
    expect(await page.getByRole("button", { name }).count()).toBe(0);
  }
  await page.getByRole("button", { name: "Ada", exact: true }).click();
  await page.getByRole("link", { name: "10.0.0.10:4000" }).waitFor();
  expect(await page.getByLabel("Material").count()).toBe(0);
  await expectAccessible(page);
  await picture(page, "farm-viewer-1280-light");
});
