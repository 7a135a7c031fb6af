/** What the schema of the machine file says of a key. */

export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string;
  description?: string;
  default?: unknown;
  enum?: unknown[];
  const?: unknown;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  properties?: Record<string, Schema>;
  patternProperties?: Record<string, Schema>;
  additionalProperties?: Schema | boolean;
  anyOf?: Schema[];
  oneOf?: Schema[];
  "x-unit"?: string;
  "x-acts"?: "live" | "restart";
}

export interface Described {
  help: string;
  unit: string;
  acts: "live" | "restart";
  /** How it is edited; `other` in the text alone. */
  kind: "boolean" | "choice" | "number" | "text" | "other";
  choices: (string | number)[];
  low: number | undefined;
  high: number | undefined;
}

/** What a schema and those that it refers to may be. */
function options(root: Schema, schema: Schema | undefined): Schema[] {
  if (!schema) return [];
  if (schema.$ref) return options(root, root.$defs?.[schema.$ref.replace("#/$defs/", "")]);
  const inner = [...(schema.anyOf ?? []), ...(schema.oneOf ?? [])];
  return inner.length ? inner.flatMap((one) => options(root, one)) : [schema];
}

function within(root: Schema, schema: Schema, name: string): Schema | undefined {
  for (const one of options(root, schema)) {
    const found = one.properties?.[name];
    if (found) return found;
    for (const [pattern, inner] of Object.entries(one.patternProperties ?? {})) {
      if (new RegExp(pattern).test(name)) return inner;
    }
    if (typeof one.additionalProperties === "object") return one.additionalProperties;
  }
  return undefined;
}

/** A help text without its Markdown: quotes of code, and links, of which the words stay. */
export function plain(help: string): string {
  return help.replaceAll("`", "").replace(/\[([^\]]*)\]\([^)]*\)/g, "$1");
}

/** What is known of a key, such as `axes.x.max_mm`. */
export function described(root: Schema, key: string): Described {
  let found: Schema | undefined = root;
  for (const name of key.split(".")) found = found && within(root, found, name);
  const inner = options(root, found).filter((one) => one.type !== "null");
  const choices = inner.flatMap((one) => one.enum ?? (one.const === undefined ? [] : [one.const]));
  const types = new Set(inner.map((one) => one.type));
  const number = inner.find((one) => one.type === "number" || one.type === "integer");
  let kind: Described["kind"] = "other";
  if (choices.length && inner.every((one) => one.enum || one.const !== undefined)) kind = "choice";
  else if (types.size === 1 && types.has("boolean")) kind = "boolean";
  else if (number && [...types].every((type) => type === "number" || type === "integer")) kind = "number";
  else if (types.has("string")) kind = "text";
  return {
    help: plain(found?.description ?? inner.find((one) => one.description)?.description ?? ""),
    unit: found?.["x-unit"] ?? "",
    acts: found?.["x-acts"] ?? "restart",
    kind,
    choices: choices as (string | number)[],
    low: number?.minimum ?? number?.exclusiveMinimum,
    high: number?.maximum ?? number?.exclusiveMaximum,
  };
}
