import { expect, test } from "vitest";
import type { Status } from "../api/schema";
import { SPAN_S, TemperatureHistory } from "./history.svelte";

function status(celsius: number | null, age_s = 0): Status {
  const hotend = { celsius, age_s, target_c: 200, power: 0.5, fault: "" };
  const chamber = { celsius, age_s, lowest_c: 20, highest_c: 30, fault: "" };
  return { heaters: { hotend }, sensors: { chamber } } as unknown as Status;
}

test("ages of the server become times of the browser", () => {
  const history = new TemperatureHistory();
  const column = { celsius: [20, 21], target_c: [0, 200], power: [0, 1] };
  history.take({ ages_s: [10, 5], heaters: { hotend: column }, sensors: { chamber: [30, 31] } }, 1000);
  expect(history.times).toEqual([990, 995]);
  expect(history.heaters["hotend"]?.target).toEqual([0, 200]);
  expect(history.sensors["chamber"]).toEqual([30, 31]);
});

test("a sample is added at most each second", () => {
  const history = new TemperatureHistory();
  for (const now_s of [100, 100.3, 100.9, 101, 101.2, 102.5]) history.add(status(now_s), now_s);
  expect(history.times).toEqual([100, 101, 102.5]);
  expect(history.heaters["hotend"]?.celsius).toEqual([100, 101, 102.5]);
});

test("a sensor that does not report leaves a gap", () => {
  const history = new TemperatureHistory();
  history.add(status(null), 100);
  history.add(status(25), 101);
  history.add(status(25, 3), 102);
  expect(history.heaters["hotend"]?.celsius).toEqual([null, 25, null]);
  expect(history.sensors["chamber"]).toEqual([null, 25, null]);
});

test("what is older than the span is forgotten", () => {
  const history = new TemperatureHistory();
  for (let now_s = 0; now_s < 2 * SPAN_S; now_s++) history.add(status(25), now_s);
  expect(history.times).toHaveLength(SPAN_S + 1);
  expect(history.times[0]).toBe(SPAN_S - 1);
  expect(history.heaters["hotend"]?.power).toHaveLength(SPAN_S + 1);
  expect(history.sensors["chamber"]).toHaveLength(SPAN_S + 1);
});
