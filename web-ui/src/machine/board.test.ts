import { expect, test } from "vitest";
import type { KeyValue } from "../api/schema";
import { socketsOf, usersOf } from "./board";

const rows: [string, unknown][] = [
  ["steppers.x.socket", "X"],
  ["heaters.hotend.pin", "D10"],
  ["fans.part.pin", "!PB4"],
  ["homing.x.pin", "^X_MIN"],
  ["board.sockets.X.step", "PF0"],
  ["board.sockets.X.enable", "!PD7"],
  ["board.sockets.Y.step", "PF6"],
  ["board.outputs.D10", "PB4"],
  ["board.endstops.X_MIN", "PE5"],
  ["board.pins.D10", "PB4"],
];
const keys = rows.map(([key, value]) => ({ key, value }) as KeyValue);

test("a socket has the keys that use it, by each name of its pin", () => {
  const { sockets, outputs, endstops } = socketsOf(keys, (key) => key.value);
  expect(sockets.map(({ name, users }) => [name, users])).toEqual([
    ["X", ["steppers.x.socket"]],
    ["Y", []],
  ]);
  expect(outputs).toEqual([{ name: "D10", pin: "PB4", users: ["heaters.hotend.pin", "fans.part.pin"] }]);
  expect(endstops[0]?.users).toEqual(["homing.x.pin"]);
});

test("users are those of pins as the machine file names them", () => {
  expect(usersOf(keys, (key) => key.value).get("PB4")).toEqual(["fans.part.pin"]);
});
