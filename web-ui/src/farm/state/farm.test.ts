import { expect, test } from "vitest";
import { job, printer } from "../../../tests/farm-printers";
import { farm } from "./farm.svelte";

test("changes replace single printers and jobs, and take away what is gone", () => {
  const whole = { printers: [printer(0), printer(1)], jobs: [job(0)], groups: [], queue_paused: false };
  farm.take({ type: "farm", farm: whole });
  const [first] = farm.printers.values();
  farm.take({ type: "changes", printers: [printer(1, { name: "Bravo" })], jobs: [], groups: null, gone: ["j0"], queue_paused: true });
  expect(farm.printers.get("p0")).toBe(first);
  expect(farm.printers.get("p1")?.name).toBe("Bravo");
  expect([farm.jobs.size, farm.queuePaused]).toEqual([0, true]);
  farm.take({ type: "farm", farm: { ...whole, printers: [printer(1)] } });
  expect([...farm.printers.keys()]).toEqual(["p1"]);
});
