/** Debian's Chromium, and what must not happen in it. */

import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { chromium, type Browser, type Page } from "playwright-core";
import { expect } from "vitest";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const PICTURES = process.env["PASSO_PICTURES"] ?? "../build/pictures";

export type Theme = "light" | "dark";

export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
}

export interface Visit {
  page: Page;
  /** Errors of the console, of the policy, of scripts, and requests to other places. */
  faults: string[];
}

/** The page at `url`, in a window of its own. */
export async function visit(
  browser: Browser,
  url: string,
  { width = 1280, height = 800, theme = "light" as Theme } = {},
): Promise<Visit> {
  const context = await browser.newContext({
    viewport: { width, height },
    colorScheme: theme,
    reducedMotion: "reduce",
    locale: "en-GB",
    hasTouch: width < 500,
  });
  const page = await context.newPage();
  page.setDefaultTimeout(45_000); // the server may have other work
  const faults: string[] = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") faults.push(message.text());
  });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => {
    if (!request.url().startsWith(url)) faults.push(`asked for ${request.url()}`);
  });
  await page.goto(url);
  await page.getByRole("heading", { name: "Temperatures" }).waitFor();
  return { page, faults };
}

interface Violation {
  id: string;
  nodes: { html: string; failureSummary?: string }[];
}

/** No violation of WCAG 2.2 AA that axe can find. */
export async function expectAccessible(page: Page): Promise<void> {
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(AXE);
  const found = await page.evaluate(async () => {
    const { axe } = globalThis as unknown as {
      axe: { run(options: object): Promise<{ violations: Violation[] }> };
    };
    const tags = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
    const { violations } = await axe.run({ runOnly: tags, resultTypes: ["violations"] });
    return violations.map(({ id, nodes }) => [id, ...nodes.map((n) => n.html + n.failureSummary)]);
  });
  expect(found).toEqual([]);
}

/** No part is cut off at the right edge, once curves have their new size. */
export async function expectFits(page: Page): Promise<void> {
  const over = () =>
    page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  await expect.poll(over).toBe(0);
}

/** Keeps a picture of the whole page, for people to look at. */
export async function picture(page: Page, name: string): Promise<void> {
  mkdirSync(PICTURES, { recursive: true });
  const before = page.viewportSize();
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  if (before) await page.setViewportSize({ width: before.width, height: Math.max(height, before.height) });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
  if (before) await page.setViewportSize(before);
}
