/** Single values in the text of a TOML file, changed without touching what else is in it. Values
 * of one line, in tables with headers; others are changed in the text itself. The server checks
 * the whole. */

interface Entry {
  key: string;
  line: number;
  /** The value begins and ends at these characters of the line. */
  from: number;
  to: number;
}

const HEADER = /^\s*\[([^[\]]+)\]\s*(?:#.*)?$/;
const ASSIGNMENT = /^\s*((?:"[^"]*"|'[^']*'|[\w-]+)(?:\s*\.\s*(?:"[^"]*"|'[^']*'|[\w-]+))*)\s*=\s*/;
const VALUE = /^(?:"(?:[^"\\]|\\.)*"|'[^']*'|\[[^[\]]*\]|\{[^{}]*\}|[^\s#"'[{]+)/;

function bare(key: string): string {
  return key
    .split(".")
    .map((part) => part.trim().replace(/^(["'])(.*)\1$/, "$2"))
    .join(".");
}

function quoted(key: string): string {
  return key
    .split(".")
    .map((part) => (/^[\w-]+$/.test(part) ? part : JSON.stringify(part)))
    .join(".");
}

/** The values of one line, and on which line each table ends. */
function scan(lines: readonly string[]): { entries: Entry[]; ends: Map<string, number> } {
  const entries: Entry[] = [];
  const ends = new Map<string, number>([["", 0]]);
  let table: string | undefined = "";
  let open = ""; // the quotes of a text of several lines
  lines.forEach((text, line) => {
    if (open) {
      if (text.includes(open)) open = "";
      return;
    }
    const header = HEADER.exec(text);
    if (header) table = bare(header[1] ?? "");
    else if (/^\s*\[\[/.test(text)) table = undefined; // of an array: its keys have no name of their own
    const assignment = ASSIGNMENT.exec(text);
    if (table === undefined) return;
    if (header || assignment) ends.set(table, line + 1);
    if (!assignment) return;
    const from = assignment[0].length;
    const rest = text.slice(from);
    open = ['"""', "'''"].find((quotes) => rest.startsWith(quotes) && !rest.slice(3).includes(quotes)) ?? "";
    const value = VALUE.exec(rest);
    if (!value || /^("""|''')/.test(rest)) return;
    const key = [table, bare(assignment[1] ?? "")].filter(Boolean).join(".");
    entries.push({ key, line, from, to: from + value[0].length });
  });
  return { entries, ends };
}

/** The value of each key that is alone on its line, as it is written. */
export function literals(text: string): Map<string, string> {
  const lines = text.split("\n");
  return new Map(scan(lines).entries.map(({ key, line, from, to }) => [key, lines[line]?.slice(from, to) ?? ""]));
}

/** The text with another value of a key; `undefined` takes the key out. */
export function withKey(text: string, key: string, literal: string | undefined): string {
  const lines = text.split("\n");
  const { entries, ends } = scan(lines);
  const entry = entries.find((one) => one.key === key);
  if (entry) {
    const line = lines[entry.line] ?? "";
    if (literal === undefined) lines.splice(entry.line, 1);
    else lines[entry.line] = line.slice(0, entry.from) + literal + line.slice(entry.to);
    return lines.join("\n");
  }
  if (literal === undefined) return text;
  const dot = key.lastIndexOf(".");
  const [table, name] = [key.slice(0, Math.max(dot, 0)), key.slice(dot + 1)];
  const assignment = `${quoted(name)} = ${literal}`;
  const end = ends.get(table);
  if (end === undefined) return `${text.trimEnd()}\n\n[${quoted(table)}]\n${assignment}\n`;
  lines.splice(end, 0, assignment);
  return lines.join("\n");
}

/** A value of JSON as TOML; undefined for what has none. */
export function literalOf(value: unknown): string | undefined {
  if (typeof value === "string") return JSON.stringify(value);
  if (typeof value === "number" || typeof value === "boolean") return String(value);
  if (Array.isArray(value)) return `[${value.map(literalOf).join(", ")}]`;
  return undefined;
}

/** A value of TOML of one line that is a text, a number or a boolean; else undefined. */
export function valueOf(literal: string): string | number | boolean | undefined {
  if (literal === "true" || literal === "false") return literal === "true";
  if (/^'.*'$/.test(literal)) return literal.slice(1, -1);
  if (/^".*"$/.test(literal)) {
    try {
      return JSON.parse(literal) as string;
    } catch {
      return undefined;
    }
  }
  const number = Number(literal.replaceAll("_", ""));
  return literal !== "" && Number.isFinite(number) ? number : undefined;
}
