/** How fast the page is: tools/build_page.py --test speed. Prints when a large file is seen and drawn as
 * a whole, by a renderer without a graphics card, and when the page is painted. */

import { expect } from "vitest";
import { visit } from "./browser";
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
