import { expect, test } from "vitest";
import type { PrintObject } from "../api/schema";
import { objectAt } from "./objects";

const square = (number: number, x: number, outlined = true): PrintObject => ({
  number,
  name: `part ${number}`,
  cancelled: false,
  centre_mm: null,
  outline_mm: outlined ? [[x, 0], [x + 10, 0], [x + 10, 10], [x, 10]] : [],
});

test("the object at a place is the one whose outline holds it", () => {
  const objects = [square(0, 0), square(1, 20), square(2, 40, false)];
  expect(objectAt(objects, 25, 5)?.number).toBe(1);
  expect(objectAt(objects, 9.9, 9.9)?.number).toBe(0);
  expect(objectAt(objects, 15, 5)).toBeUndefined();
  expect(objectAt(objects, 45, 5)).toBeUndefined();
});
