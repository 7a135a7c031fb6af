"""The board file of a configuration, found by the pins of its motors and heaters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.board_files import load_board, shipped_boards
from passo.config.pin_names import bare, placed

if TYPE_CHECKING:
    from passo.config.importing.draft import Draft, Value

_FEWEST = 5  # pins that agree: two motors and a heater


def board_of_pins(draft: Draft, board: str, clock_hz: int | None) -> str | None:
    """The shipped board with Klipper's firmware whose sockets and outputs have the pins of all
    motors, heaters and sensors on `board` of the draft. Its clock must be `clock_hz`, if given.
    None if no board fits, if boards with different clocks fit, or if there are so few pins that
    they may agree by chance."""
    motors, heaters = _pins(draft, board, "steppers"), _pins(draft, board, "heaters")
    if sum(map(len, (*motors, *heaters))) < _FEWEST:
        return None
    found = [
        name
        for name in shipped_boards()
        if load_board(name).is_klippers
        and clock_hz in (None, load_board(name).clock_hz)
        and _fits(name, motors, heaters)
    ]
    clocks = {load_board(name).clock_hz for name in found}
    return found[0] if len(clocks) == 1 else None


def _fits(name: str, motors: list[tuple[str, ...]], heaters: list[tuple[str, ...]]) -> bool:
    board = load_board(name)
    sockets = {(bare(s.step), bare(s.direction), bare(s.enable)) for s in board.sockets.values()}
    pairs = {
        (bare(board.pin(function.output)), bare(board.pin(function.sensor)))
        for function in board.functions.values()
        if function.sensor
    }
    return sockets.issuperset(motors) and pairs.issuperset(heaters)


def _pins(draft: Draft, board: str, table: str) -> list[tuple[str, ...]]:
    """The pins of each motor, or of each heater, that is on this board."""
    keys = ("step_pin", "direction_pin", "enable_pin")
    if table == "heaters":
        keys = ("pin", "sensor_pin")
    names = dict.fromkeys(path[1] for path in draft.keys if path[0] == table)
    found = [[draft.keys.get((table, name, key), ("", None))[0] for key in keys] for name in names]
    return [tuple(map(_pin, pins)) for pins in found if _board(pins[0]) == board]


def _board(pin: Value) -> str:
    return placed(str(pin))[0]


def _pin(pin: Value) -> str:
    return bare(placed(str(pin))[1])
