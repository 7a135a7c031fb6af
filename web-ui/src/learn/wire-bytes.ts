/** The bytes of a step command by field. Each number has groups of seven bits; every byte but its last is 0x80 or more. */

export const FIELDS = ["command", "motor", "interval", "count", "add"] as const;
export type Field = (typeof FIELDS)[number];

/** The bytes of a payload in hexadecimal, each field with its own. */
export function fieldsOf(payload: string): { field: Field; bytes: string }[] {
  const numbers: string[][] = [[]];
  for (const byte of payload.split(" ").filter(Boolean)) {
    numbers.at(-1)?.push(byte);
    if (parseInt(byte, 16) < 0x80) numbers.push([]);
  }
  return FIELDS.flatMap((field, i) => (numbers[i]?.length ? [{ field, bytes: numbers[i].join(" ") }] : []));
}
