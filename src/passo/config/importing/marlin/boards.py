"""Marlin's names of boards, and its pins on Passo's board files."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from passo.config.board_files import load_board
from passo.config.importing.draft import bad
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.board import Board, Function
    from passo.config.importing.marlin.defines import Defines

_TABLE = tomllib.loads(Path(__file__).with_name("boards.toml").read_text(encoding="utf-8"))
_LARGE = "octopus"  # a board with many sockets


class KnownBoard(NamedTuple):
    """A board file and its variant. `sockets`, for boards that number their sockets, are those of
    Marlin's X, Y, Z, a second Z and the extruders, in this order; empty for other boards.
    `unknown` is the name of a board that has no file: the sockets are those of another board, so
    that the machine can be simulated."""

    base: str
    variant: str | None = None
    sockets: tuple[str, ...] = ()
    unknown: str = ""


def _known(base: str, variant: str | None = None, unknown: str = "") -> KnownBoard:
    return KnownBoard(base, variant, tuple(_TABLE["sockets"].get(base, "").split()), unknown)


BOARDS = {name: _known(*file.split()) for name, file in _TABLE["boards"].items()}


def known_board(defines: Defines, given: str | None = None) -> KnownBoard:
    """The board file of MOTHERBOARD, or the `given` one; without a file, that of a large board.
    Raises ConfigError without MOTHERBOARD."""
    if given is not None:
        return _known(given)
    written = defines.text("MOTHERBOARD")
    if written is None:
        raise ConfigError.of("import.define", str(defines.files[0]), value="MOTHERBOARD")
    name = written.removeprefix("BOARD_")
    name = _TABLE["older"].get(name, name)
    return BOARDS.get(name) or _known(_LARGE, unknown=name)


class Pins:
    """The pins of a board file, by the names in a configuration of Marlin."""

    def __init__(self, defines: Defines, known: KnownBoard) -> None:
        self._defines = defines
        self.board: Board = load_board(known.base)
        self._sockets = known.sockets
        self._unknown = known.unknown
        variant = known.variant or self.board.variant
        self.functions: dict[str, Function] = (
            self.board.variants[variant] if variant else self.board.functions
        )

    def given(self, *names: str, analog: bool = False) -> str | None:
        """The pin that the configuration itself gives by one of these defines; None if it gives
        none, or -1. Raises ConfigError for a name that the board does not have."""
        name = self._defines.first(*names)
        if name is None:
            return None
        written = self._defines.text(name) or ""
        if written in ("-1", "P_NC", "NC"):
            return None
        pin = self._board_name(written, analog)
        if pin is None and self._unknown:
            return None
        if pin is None:
            limit = f"a pin of the board {self.board.name}"
            raise bad(self._defines.place(name), name, written[:40], limit)
        return pin

    def _board_name(self, written: str, analog: bool) -> str | None:
        names = [written]
        if written.isdigit():
            names = [f"{'A' if analog else 'D'}{written}", f"D{written}"]
        elif match := re.fullmatch(r"P(\d)_0*(\d+)", written):
            names = [f"P{match[1]}.{match[2]}"]
        elif (match := re.fullmatch(r"FAN(\d?)_PIN", written)) and written != "FAN_PIN":
            function = self.functions.get(f"fan{match[1] or 0}")
            names = [function.output] if function else names
        elif (other := self._defines.text_of(written)) is not None and other != written:
            names = [other]
        chip = self.board.chip
        known = {*self.board.pins, *self.board.pins.values(), *(chip.pins if chip else ())}
        loose = not self.board.numbering and re.fullmatch(r"P[A-K]\d+|P\d\.\d+|GP\d+", names[0])
        return next((name for name in names if name in known or loose), None)

    def endstop(self, letter: str, direction: str) -> str | None:
        """The board's endstop for an end of an axis."""
        for name in (f"{letter.upper()}_{direction.upper()}", f"{letter.upper()}_STOP"):
            if name in self.board.endstops:
                return name
        return None

    def socket(self, name: str) -> str | None:
        """The socket of a motor: X, Y, Z, Z2, or E and a number. A further motor without its own
        driver has none here."""
        if self._sockets:
            numbers = {word: at for at, word in enumerate(("X", "Y", "Z", "Z2"))}
            if name[0] == "E":
                numbers[name] = len(numbers) + int(name[1:] or 0)
            return dict(enumerate(self._sockets)).get(numbers.get(name, -1))
        if not name.startswith("E"):
            return name if name in self.board.sockets else None
        sockets = [one for one in self.board.sockets if re.fullmatch("E[0-9]*", one)]
        index = int(name[1:] or 0)
        return sockets[index] if index < len(sockets) else None
