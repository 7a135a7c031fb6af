import { expect, test } from "vitest";
import { job } from "../../../tests/farm-printers";
import { inOrder, moved } from "./jobs";

const jobs = (...priorities: number[]) => priorities.map((priority, number) => job(number, { priority, due_s: null }));

/** The order after a move, by the numbers that the jobs had. */
function after(priorities: number[], from: number, to: number): string[] {
  const before = inOrder(jobs(...priorities));
  const changes = moved(before, from, to);
  return inOrder(before.map((one) => ({ ...one, priority: changes.get(one.id) ?? one.priority }))).map(({ id }) => id.slice(1));
}

test.each([
  [[0, 0, 0], 2, 1, "021"],
  [[0, 0, 0], 2, 0, "201"],
  [[0, 0, 0], 0, 1, "102"],
  [[5, 3, 3, 0], 3, 1, "0312"],
  [[5, 0], 0, 1, "10"],
] as const)("of the priorities %j the job at %d comes to %d", (priorities, from, to, order) => {
  expect(after([...priorities], from, to).join("")).toBe(order);
});

test("a move changes no job that keeps its place below", () => {
  expect([...moved(inOrder(jobs(2, 1, 0)), 1, 0).keys()]).toEqual(["j1"]);
});

test("a job that is due comes before one of the same priority that is not", () => {
  expect(inOrder([job(0, { due_s: null }), job(1, { due_s: 99 })]).map(({ id }) => id)).toEqual(["j1", "j0"]);
});
