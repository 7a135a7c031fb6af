import { expect, test } from "vitest";
import { merge, type Tree } from "./merge";

function merged(target: Tree, patch: Tree): Tree {
  merge(target, patch);
  return target;
}

// The examples of RFC 7386, appendix A, whose target and patch are objects.
test.each<[Tree, Tree, Tree]>([
  [{ a: "b" }, { a: "c" }, { a: "c" }],
  [{ a: "b" }, { b: "c" }, { a: "b", b: "c" }],
  [{ a: "b" }, { a: null }, {}],
  [{ a: "b", b: "c" }, { a: null }, { b: "c" }],
  [{ a: ["b"] }, { a: "c" }, { a: "c" }],
  [{ a: "c" }, { a: ["b"] }, { a: ["b"] }],
  [{ a: { b: "c" } }, { a: { b: "d", c: null } }, { a: { b: "d" } }],
  [{ a: [{ b: "c" }] }, { a: [1] }, { a: [1] }],
  [{ e: null }, { a: 1 }, { e: null, a: 1 }],
  [{}, { a: { bb: { ccc: null } } }, { a: { bb: {} } }],
])("%j and %j are merged", (target, patch, result) => {
  expect(merged(target, patch)).toEqual(result);
});

test("parts that did not change stay the same objects", () => {
  const bed = { celsius: 25 };
  const target: Tree = { heaters: { bed, hotend: { celsius: 25 } } };
  merge(target, { heaters: { hotend: { celsius: 26 } } });
  expect((target["heaters"] as Tree)["bed"]).toBe(bed);
});
