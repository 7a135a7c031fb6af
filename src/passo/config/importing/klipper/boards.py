"""The board file of a configuration, found by the pins of its motors, heaters and switches."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.board_files import load_board, shipped_boards
from passo.config.pin_names import bare, placed

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.importing.draft import Draft, KeyPath, Value

_FEWEST = 5  # pins that agree: a motor, a heater and its sensor
_MOTOR = ("step_pin", "direction_pin", "enable_pin")
_OUTPUTS = ("heaters", "fans")
_OF_DRIVERS = ("uart_pin", "tx_pin", "cs_pin")


def boards_of_pins(draft: Draft, board: str, comments: str = "") -> list[str]:
    """The shipped boards to which the pins of the draft on `board` fit best: all motors are in
    their sockets, and as many outputs, sensors and endstops as possible are theirs. Only the one
    that the comments name, if they name one of these. Empty if no board fits, or if there are so
    few pins that they may agree by chance."""
    found: dict[str, int] = {}
    for name in shipped_boards():
        count = _agreeing(load_board(name), draft, board)
        if count >= _FEWEST:
            found[name] = count
    most = max(found.values(), default=0)
    best = sorted((name for name, count in found.items() if count == most), key=len)
    words = _plain(comments)
    named = [name for name in best if _plain(name) in words]
    return named[-1:] or best


def _plain(name: str) -> str:
    """Letters and digits of a name, without the v of a version: `SKR V1.4` and `skr-1.4` agree."""
    return re.sub(r"v(?=\d)|[^a-z0-9]", "", name.lower())


def _agreeing(known: Board, draft: Draft, board: str) -> int:
    """How many pins on this board are used as on the known board; 0 if a motor is not in a
    socket, or if most of the other pins are used in another way."""
    sockets = {
        tuple(bare(known.pin(pin)) for pin in (s.step, s.direction, s.enable)): s
        for s in known.sockets.values()
    }
    motors = _motors(draft, board)
    if not motors or not sockets.keys() >= set(motors.values()):
        return 0
    found = {"output": known.outputs, "sensor": known.thermistors, "switch": known.endstops}
    pins = {role: {bare(known.pin(name)) for name in names} for role, names in found.items()}
    for name, motor in motors.items():
        own = sockets[motor]
        wires = (own.uart, own.uart_send, own.select)
        pins[name] = {bare(known.pin(pin)) for pin in wires if pin is not None}
    others, agree = 0, 0
    for path, (value, _) in draft.keys.items():
        usual = pins.get(_role(path))
        if usual is not None and _board(value) == board:
            others += 1
            agree += _pin(value) in usual
    return 0 if agree < others / 2 else 3 * len(motors) + agree


def _role(path: KeyPath) -> str:
    """What the pin of a key is for: a role, or the motor of a driver; empty for other keys."""
    if path[0] in _OUTPUTS and path[2:] == ("pin",):
        return "output"
    if path[0] in _OUTPUTS and path[2:] == ("sensor_pin",):
        return "sensor"
    if path[0] == "homing" and ("pin" in path[2:] or "stepper_pins" in path):
        return "switch"
    return path[1] if path[0] == "steppers" and path[-1] in _OF_DRIVERS else ""


def _motors(draft: Draft, board: str) -> dict[str, tuple[str, ...]]:
    """The pins of each motor on this board."""
    names = dict.fromkeys(path[1] for path in draft.keys if path[0] == "steppers")
    found = {
        name: [draft.keys.get(("steppers", name, key), ("", None))[0] for key in _MOTOR]
        for name in names
    }
    return {n: tuple(map(_pin, pins)) for n, pins in found.items() if _board(pins[0]) == board}


def _board(pin: Value) -> str:
    return placed(str(pin))[0]


def _pin(pin: Value) -> str:
    return bare(placed(str(pin))[1])
