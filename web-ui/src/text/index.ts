/** The texts of the page, by key. English has every key; another language may lack some. */

import en from "./en.json";

export type Key = keyof typeof en;
type Values = Record<string, string | number>;

const catalogue: Partial<Record<Key, string>> = en;

/** The text of a key, with `{name}` replaced by the values. */
export function t(key: Key, values: Values = {}): string {
  const text = catalogue[key] ?? en[key];
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/** The key, if the catalogue has it: for keys that are made from names of the API. */
export function keyOf(name: string): Key | undefined {
  return name in en ? (name as Key) : undefined;
}
