/** The main board: its sockets, and which keys of the machine file use each. */

import type { KeyValue } from "../api/schema";

const IS_PIN = /(^|_)(pin|socket)$/;
export const KINDS = ["sockets", "outputs", "thermistors", "endstops"] as const;
export type Kind = (typeof KINDS)[number];

export interface Socket {
  name: string;
  /** Of the microcontroller; empty for a motor's socket, which has several. */
  pin: string;
  /** Keys; more than one is a conflict. */
  users: string[];
}

type ValueOf = (key: KeyValue) => unknown;

/** Each pin and socket, as the machine file names it, with the keys that use it. */
export function usersOf(keys: readonly KeyValue[], valueOf: ValueOf): Map<string, string[]> {
  const users = new Map<string, string[]>();
  for (const field of keys) {
    if (!IS_PIN.test(field.key.split(".").at(-1) ?? "") || field.key.startsWith("board")) continue;
    const value = valueOf(field);
    if (typeof value !== "string" || !value) continue;
    const pin = bare(value);
    users.set(pin, [...(users.get(pin) ?? []), field.key]);
  }
  return users;
}

/** The sockets of the board by kind; a pin that has several names has the users of all. */
export function socketsOf(keys: readonly KeyValue[], valueOf: ValueOf): Record<Kind, Socket[]> {
  const users = usersOf(keys, valueOf);
  const pins = new Map<string, string>(); // of the microcontroller, by name
  const found: Record<Kind, Socket[]> = { sockets: [], outputs: [], thermistors: [], endstops: [] };
  for (const { key, value } of keys) {
    const [board, kind, name] = key.split(".");
    if (board !== "board" || !name || typeof value !== "string") continue;
    if (kind === "sockets" && !found.sockets.some((one) => one.name === name)) {
      found.sockets.push({ name, pin: "", users: users.get(name) ?? [] });
    } else if (kind === "outputs" || kind === "thermistors" || kind === "endstops") {
      pins.set(name, bare(value));
      found[kind].push({ name, pin: bare(value), users: [] });
    } else if (kind === "pins") {
      pins.set(name, bare(value));
    }
  }
  const byPin = new Map<string, string[]>();
  for (const [name, some] of users) {
    const pin = pins.get(name) ?? name;
    byPin.set(pin, [...(byPin.get(pin) ?? []), ...some]);
  }
  for (const kind of ["outputs", "thermistors", "endstops"] as const) {
    for (const socket of found[kind]) socket.users = byPin.get(socket.pin) ?? [];
  }
  return found;
}

/** A pin without its inversion and pull-up. */
function bare(pin: string): string {
  return pin.replace(/^[\^~!]+/, "");
}
