"""Marlin's names of boards, and its pins on Passo's board files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from passo.config.board_files import load_board
from passo.config.importing.draft import bad
from passo.config.importing.marlin.older_boards import known_name
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.board import Board, Function
    from passo.config.importing.marlin.defines import Defines

_RAMPS = ("RAMPS_OLD", "RAMPS_13", "RAMPS_14", "RAMPS_14_RE_ARM", "RAMPS_PLUS")
# Marlin's letters of what is on D10, D9 and D8, and MK4duo's.
_ON_RAMPS = {
    "EFB": "HFB",
    "EEB": "HHB",
    "EFF": "HFF",
    "EEF": "HHF",
    **{name: name for name in ("HFB", "HHB", "HFF", "HHF", "HHH")},
}


class KnownBoard(NamedTuple):
    """A board file and its variant. `sockets`, for boards that number their sockets, are those of
    Marlin's X, Y, Z, a second Z and the extruders, in this order; empty for other boards.
    `unknown` is the name of a board that has no file: the sockets are those of another board, so
    that the machine can be simulated."""

    base: str
    variant: str | None = None
    sockets: tuple[str, ...] = ()
    unknown: str = ""


# X, Y, Z, a second Z, then the extruders.
_OCTOPUS = tuple(f"MOTOR{number}" for number in range(8))
_MANTA = tuple(f"M{number}" for number in range(1, 9))

BOARDS: dict[str, KnownBoard] = {
    **{
        f"{ramps}_{letters}": KnownBoard("ramps", variant)
        for ramps in _RAMPS
        for letters, variant in _ON_RAMPS.items()
    },
    "RAMPS_CREALITY": KnownBoard("ramps", "HFB"),
    "RAMPS_ENDER_4": KnownBoard("ramps", "HFB"),
    "TRIGORILLA_13": KnownBoard("ramps", "HFB"),
    "TRIGORILLA_14": KnownBoard("ramps", "HFB"),
    "MKS_GEN_13": KnownBoard("mks-gen"),
    "MKS_BASE": KnownBoard("mks-gen"),
    "MKS_GEN_L": KnownBoard("mks-gen"),
    "MKS_GEN_L_V2": KnownBoard("mks-gen-l"),
    "MKS_GEN_L_V21": KnownBoard("mks-gen-l"),
    "MELZI": KnownBoard("melzi"),
    "MELZI_V2": KnownBoard("melzi"),
    "MELZI_CREALITY": KnownBoard("melzi"),
    "MELZI_MALYAN": KnownBoard("melzi"),
    "MELZI_TRONXY": KnownBoard("melzi"),
    "RADDS": KnownBoard("radds"),
    "BTT_SKR_MINI_E3_V2_0": KnownBoard("skr-mini-e3-v2"),
    "BTT_SKR_MINI_E3_V3_0": KnownBoard("skr-mini-e3-v3"),
    "BTT_SKR_V1_3": KnownBoard("skr-1.3"),
    "BTT_SKR_V1_4": KnownBoard("skr-1.4"),
    "BTT_SKR_V1_4_TURBO": KnownBoard("skr-1.4-turbo"),
    "BTT_SKR_V2_0_REV_A": KnownBoard("skr-2"),
    "BTT_SKR_V2_0_REV_B": KnownBoard("skr-2"),
    "BTT_SKR_PICO": KnownBoard("skr-pico"),
    "BTT_OCTOPUS_V1_0": KnownBoard("octopus", sockets=_OCTOPUS),
    "BTT_OCTOPUS_V1_1": KnownBoard("octopus", sockets=_OCTOPUS),
    "BTT_MANTA_M8P_V1_0": KnownBoard("manta-m8p", sockets=_MANTA),
    "BTT_MANTA_M8P_V1_1": KnownBoard("manta-m8p", sockets=_MANTA),
    "FYSETC_SPIDER": KnownBoard("spider"),
    "FYSETC_SPIDER_V2_2": KnownBoard("spider"),
    "CREALITY_V4": KnownBoard("creality-4.2.2"),
    "CREALITY_V422": KnownBoard("creality-4.2.2"),
    "CREALITY_V427": KnownBoard("creality-4.2.7"),
    "EINSY_RAMBO": KnownBoard("einsy-rambo"),
    "RAMPS_FD_V1": KnownBoard("ramps-fd"),
    "RAMPS_FD_V2": KnownBoard("ramps-fd"),
}


def known_board(defines: Defines, given: str | None = None) -> KnownBoard:
    """The board file of MOTHERBOARD, or the `given` one; without a file, that of a large board.
    Raises ConfigError without MOTHERBOARD."""
    if given is not None:
        same = (known for known in BOARDS.values() if known.base == given and known.sockets)
        return next(same, KnownBoard(given))
    written = defines.text("MOTHERBOARD")
    if written is None:
        raise ConfigError.of("import.define", str(defines.files[0]), value="MOTHERBOARD")
    name = known_name(written)
    return BOARDS.get(name, KnownBoard("octopus", None, _OCTOPUS, name))


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
