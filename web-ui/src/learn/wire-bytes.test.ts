import { expect, test } from "vitest";
import { fieldsOf } from "./wire-bytes";

test("each number of a step command has its own bytes", () => {
  // queue_step oid=0 interval=23007 count=2 add=-6748
  expect(fieldsOf("02 00 81 b3 5f 02 ff cb 24")).toEqual([
    { field: "command", bytes: "02" },
    { field: "motor", bytes: "00" },
    { field: "interval", bytes: "81 b3 5f" },
    { field: "count", bytes: "02" },
    { field: "add", bytes: "ff cb 24" },
  ]);
  expect(fieldsOf("")).toEqual([]);
});
