/** The address of a lesson or calculator: its name, and the values that differ from the defaults. */

import type { ParameterView } from "../api/schema";

export type Values = Record<string, number | string>;
export type Kind = "lessons" | "calculators";

export interface Place {
  kind: Kind;
  name: string;
  values: Values;
}

/** What a place of the page Learn names; undefined for a line of a file, or nothing. */
export function placed(place: string): Place | undefined {
  const found = /^\/(lessons|calculators)\/([\w-]+)(?:\?(.*))?$/.exec(place);
  if (!found) return undefined;
  const values = Object.fromEntries(new URLSearchParams(found[3] ?? ""));
  return { kind: found[1] as Kind, name: found[2] ?? "", values };
}

/** The hash that carries these values. */
export function addressOf(kind: Kind, name: string, values: Values, parameters: ParameterView[] = []): string {
  const changed = parameters.filter((one) => values[one.name] !== undefined && String(values[one.name]) !== String(one.default));
  const query = new URLSearchParams(changed.map((one) => [one.name, String(values[one.name])]));
  return `#/learn/${kind}/${name}${changed.length ? `?${query}` : ""}`;
}
