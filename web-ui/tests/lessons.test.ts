import { execFileSync } from "node:child_process";
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { expectAccessible, expectFits, picture } from "./browser";
import { testOf } from "./fixtures";
import { PYTHON } from "./served";

interface Told {
  name: string;
  title: string;
  chapter: string;
  questions: { answer: number; why: string; mistakes: { value: number; hint: string }[]; options: { value: number; text: string }[] }[];
  experiment: { parameters: { label: string; choices: object[]; low: number; high: number }[] };
}

const lessons = JSON.parse(execFileSync(PYTHON, ["-m", "passo", "learn", "--json"], { maxBuffer: 1 << 26 }).toString()) as Told[];
const test = testOf({});

const open = async (page: Page, hash: string, title: string) => {
  await page.evaluate((to) => (location.hash = to), hash);
  await page.getByRole("heading", { name: title, level: 1 }).waitFor({ state: "attached" });
};
/** As it reads, without the marks of code. */
const plain = (text: string) => text.replaceAll("`", "");

const CHAPTERS = [...new Set(lessons.map(({ chapter }) => chapter))];

/** Gives each wrong answer of a usual mistake, then the right one. */
async function answerAll(page: Page, lesson: Told): Promise<void> {
  for (const [index, question] of lesson.questions.entries()) {
    const form = page.locator("form.question").nth(index);
    const give = async (value: number) => {
      const option = question.options.find((one) => one.value === value);
      if (option) await form.getByLabel(plain(option.text), { exact: true }).check();
      else await form.getByRole("textbox", { name: "Answer" }).fill(String(value));
      await form.getByRole("button", { name: "Check" }).click();
    };
    for (const { value, hint } of question.mistakes) {
      await give(value);
      await form.locator(".wrong .text", { hasText: plain(hint) }).waitFor();
    }
    await give(question.answer);
    await form.locator(".good .text", { hasText: plain(question.why) }).waitFor();
  }
}

/** Changes the first slider of the experiment by a key; the address carries its value then. */
async function useSlider(page: Page, lesson: Told): Promise<void> {
  const parameter = lesson.experiment.parameters.find(({ choices }) => !choices.length);
  if (!parameter) return;
  const slider = page.getByRole("slider", { name: parameter.label, exact: true });
  const before = await slider.inputValue();
  await slider.press(Number(before) < parameter.high ? "ArrowRight" : "ArrowLeft");
  expect(await slider.inputValue()).not.toBe(before);
  await expect.poll(() => page.url()).toContain("?");
}

for (const chapter of CHAPTERS) {
  const own = lessons.filter((lesson) => lesson.chapter === chapter);
  test(`${chapter}: mistakes have hints, answers are checked, the experiment is used by keys`, async ({ page }) => {
    await page.setViewportSize({ width: 360, height: 800 });
    await page.emulateMedia({ colorScheme: "dark" });
    for (const lesson of own) {
      await open(page, `#/learn/lessons/${lesson.name}`, lesson.title);
      await answerAll(page, lesson);
      await useSlider(page, lesson);
      await expectFits(page);
      await expectAccessible(page);
      await picture(page, `lesson-${lesson.name}-360-dark`);
    }
    await page.reload();
    await open(page, "#/learn", "Learn");
    await expect.poll(() => page.locator("li.done").count()).toBe(own.length);
  });
}

test("a link carries the values of an experiment, and a slider answers within 100 ms", async ({ page }) => {
  await open(page, "#/learn/lessons/trapezoid-and-triangle?length_mm=4", "Trapezoid and triangle");
  const shape = () => page.locator("dl.facts div", { hasText: "Shape" }).locator("dd").textContent();
  await expect.poll(shape).toBe("triangle");
  await page.getByRole("slider", { name: "Length" }).fill("120");
  await expect.poll(shape).toBe("trapezoid");
  await expect.poll(() => page.url()).toContain("?length_mm=120");
  await expectAccessible(page);
  await picture(page, "lesson-1280-light");
  const taken = await page.evaluate(async () => {
    const times: number[] = [];
    for (let length = 10; length < 30; length++) {
      const begin = performance.now();
      const body = JSON.stringify({ values: { length_mm: length }, language: "en" });
      const headers = { "X-Passo-Request": "1", "Content-Type": "application/json" };
      await (await fetch("api/v1/lessons/trapezoid-and-triangle/run", { method: "POST", headers, body })).json();
      times.push(performance.now() - begin);
    }
    return times.sort((a, b) => a - b)[10] ?? Infinity;
  });
  expect(taken).toBeLessThan(100);
  await page.getByRole("button", { name: "Values of the lesson" }).click();
  await expect.poll(() => page.url()).not.toContain("?");
});

test("a calculator calculates, also in Italian", async ({ page }) => {
  await open(page, "#/learn", "Learn");
  await page.getByRole("link", { name: "Steps per millimetre" }).last().click();
  await page.getByRole("radio", { name: "lead screw" }).check({ force: true });
  const steps = page.locator("dl.facts div").nth(2).locator("dd");
  await expect.poll(() => steps.textContent()).toBe("400steps/mm");
  await page.getByRole("button", { name: "Italiano" }).click();
  await page.getByText("Passi al millimetro").first().waitFor();
  await expectAccessible(page);
});

test("a lesson that does not exist is an error with what to do", async ({ page, visit }) => {
  await page.evaluate(() => (location.hash = "#/learn/lessons/perpetual-motion"));
  await page.getByRole("alert").getByText(/no lesson/).waitFor();
  visit.faults.length = 0; // the browser logs the status 404
});
