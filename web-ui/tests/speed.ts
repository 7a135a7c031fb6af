/** How fast the page is: tools/build_page.py --test speed. Prints when a large file is seen and drawn as
 * a whole, by a renderer without a graphics card, when the page is painted, and when a farm of 200 printers
 * is. */

import { expect } from "vitest";
import { visit } from "./browser";
import { fake, FARM } from "./farm-fake";
import { printer } from "./farm-printers";
import { testOf } from "./fixtures";

const BYTES = 35e6;
const MOVES_A_LAYER = 5000;

/** Rings, one a layer. */
function rings(): string {
  const parts = ["G28\nG21\nG90\nM83\n"];
  for (let layer = 1, size = 0; size < BYTES; layer++) {
    let text = `;LAYER_CHANGE\nG1 Z${(layer * 0.2).toFixed(2)} F600\n;TYPE:External perimeter\n`;
    for (let move = 0; move < MOVES_A_LAYER; move++) {
      const angle = (2 * Math.PI * move) / MOVES_A_LAYER;
      const radius = 60 + 20 * Math.cos(9 * angle) + 10 * Math.sin(layer / 20);
      const [x, y] = [125 + radius * Math.cos(angle), 110 + radius * Math.sin(angle)];
      text += `G1 X${x.toFixed(3)} Y${y.toFixed(3)} E0.00${100 + (move % 9)}\n`;
    }
    size += text.length;
    parts.push(text);
  }
  return parts.join("");
}

const test = testOf({ clock: 20, files: { "large.gcode": rings() } });

test("first picture and first paint", async ({ browser, served }) => {
  const { page } = await visit(browser, served.url);
  await page.evaluate(() => (location.hash = "#/viewer/large.gcode"));
  const canvas = page.locator("canvas[data-triangles]");
  await canvas.waitFor({ timeout: 100_000 }); // once the path is planned
  await page.evaluate(() => (location.hash = "#/dashboard"));
  await page.reload();
  await page.getByRole("heading", { name: "Temperatures" }).waitFor();
  const start = Date.now();
  await page.evaluate(() => (location.hash = "#/viewer/large.gcode"));
  const triangles = () => canvas.evaluate(({ dataset }) => Number(dataset["triangles"] ?? 0), undefined, { timeout: 100_000 });
  await expect.poll(triangles, { timeout: 100_000, interval: 20 }).toBeGreaterThan(10_000);
  console.log(`first picture of ${BYTES / 1e6} MB: ${Date.now() - start} ms, of ${await triangles()} triangles`);
  let drawn = 0;
  await expect
    .poll(async () => {
      const before = drawn;
      drawn = await triangles();
      return drawn === before;
    }, { timeout: 100_000, interval: 2000 })
    .toBe(true);
  console.log(`the whole of it: ${Date.now() - start} ms, ${drawn} triangles`);
  await page.context().close();
  const { page: again } = await visit(browser, served.url);
  const painted = await again.evaluate(
    () =>
      new Promise<number>((resolve) => {
        const observer = new PerformanceObserver((list) => {
          const [entry] = list.getEntriesByName("first-contentful-paint");
          if (entry) resolve(entry.startTime);
        });
        observer.observe({ type: "paint", buffered: true });
      }),
  );
  console.log(`first contentful paint: ${painted.toFixed(0)} ms`);
});

test("first picture of a farm of 200 printers, and its changes", async ({ browser }) => {
  const COUNT = 200;
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
  const printers = Array.from({ length: COUNT }, (_, number) => printer(number));
  const { feed } = await fake(page, printers);
  await page.addInitScript((count) => {
    const times = ((globalThis as unknown as { drawn: number[] }).drawn = [] as number[]);
    new MutationObserver(() => {
      if (!times.length && document.querySelectorAll("[data-printer]").length === count) requestAnimationFrame(() => times.push(performance.now()));
    }).observe(document, { subtree: true, childList: true });
  }, COUNT);
  await page.goto(FARM);
  const drawn = () => page.evaluate(() => (globalThis as unknown as { drawn: number[] }).drawn[0] ?? 0);
  await expect.poll(drawn).toBeGreaterThan(0);
  console.log(`first picture of ${COUNT} printers: ${(await drawn()).toFixed(0)} ms`);

  // Each printer has other temperatures: the processor time of the page for that.
  const client = await page.context().newCDPSession(page);
  await client.send("Performance.enable");
  const busy_s = async () => (await client.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration")?.value ?? 0;
  const before = await busy_s();
  const ROUNDS = 10;
  for (let round = 0; round < ROUNDS; round++) {
    const changed = printers.map(({ seen, ...one }) => ({ ...one, seen: seen && { ...seen, heaters: seen.heaters.map((heater) => ({ ...heater, celsius: 100 + round })) } }));
    feed()?.send(JSON.stringify({ type: "changes", printers: changed, jobs: [], groups: null, gone: [], queue_paused: false }));
    await page.getByText(`${100 + round}°`).first().waitFor({ state: "attached" });
  }
  console.log(`a change of all ${COUNT}: ${((1000 * (await busy_s() - before)) / ROUNDS).toFixed(0)} ms of the page`);
  await page.close();
});
