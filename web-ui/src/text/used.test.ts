import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { expect, test } from "vitest";
import common from "./common/en.json";
import farm from "./farm/en.json";
import printer from "./printer/en.json";

/** The files that an entry imports, with those that they import. */
function reached(path: string, found = new Set<string>()): Set<string> {
  if (found.has(path)) return found;
  found.add(path);
  for (const [, to = ""] of readFileSync(path, "utf8").matchAll(/(?:from|import)\s*\(?\s*"(\.[^"]+)"/g)) {
    const file = ["", ".ts", ".svelte.ts", "/index.ts"].map((end) => join(dirname(path), to) + end).find((one) => existsSync(one) && /\.(ts|svelte)$/.test(one));
    if (file) reached(file, found);
  }
  return found;
}

const KEY = /["`]([a-z]+\.[a-z][\w.-]*)["`]/g; // whole keys; those that are made of names are not checked

test.each([
  ["src/main.ts", { ...common, ...printer }, farm],
  ["src/farm.ts", { ...common, ...farm }, printer],
] as [string, object, object][])("%s has the texts that it uses, and no file of the other page", (entry, has, others) => {
  const files = [...reached(entry)];
  expect(files.length).toBeGreaterThan(40);
  const used = new Set(files.filter((file) => !file.endsWith("schema.ts")).flatMap((file) => [...readFileSync(file, "utf8").matchAll(KEY)].map(([, key = ""]) => key)));
  expect([...used].filter((key) => key in others && !(key in has))).toEqual([]);
});
