"""Converts the pins and boards of a printer.cfg."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.cfg import Config, Option, Section
from passo.config.part_names import part_name
from passo.config.pin_names import bare, named_on

if TYPE_CHECKING:
    from passo.config.importing.draft import Draft

MAIN = "mcu"
JOINED = "multi_pin"  # in place of a board: several outputs under one name
_ALIAS = re.compile(r"\s*([^\s=,]+)\s*=\s*([^\s,]+)\s*")
_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_./-]*")


class Pins:
    """The boards and pins of a configuration."""

    def __init__(self, config: Config, draft: Draft) -> None:
        self._draft = draft
        self._boards = {MAIN: ""}
        self._aliases: dict[tuple[str, str], str] = {}
        for section in config.of(MAIN):
            if section.rest:
                self._boards[section.rest] = board_name(section.rest)
        for section in config.of("board_pins"):
            boards = [name.strip() for name in section.text("mcu", MAIN).split(",")]
            names = [name for name in section.options if name.startswith("aliases")]
            for name in names:
                for alias, pin in _ALIAS.findall(section.text(name)):
                    for board in boards:
                        self._aliases[board, alias] = pin

    @property
    def further(self) -> dict[str, str]:
        """The names of further boards in the machine file, by their names in the configuration."""
        return {name: board for name, board in self._boards.items() if name != MAIN}

    def of(self, section: Section, name: str) -> str | None:
        """The pin of an option in the form of a machine file; None if the section does not have the
        option. An option that does not name a pin of a board is reported, and gives None. Raises
        ConfigError."""
        found = section.option(name)
        return None if found is None else self.pin(section, name, found)

    def pin(self, section: Section, name: str, found: Option) -> str | None:
        """Like `of`, for an option that was found."""
        written = re.sub(r"\s+", "", found.text)
        body = bare(written)
        marks = written[: len(written) - len(body)]
        board, colon, rest = body.partition(":")
        if not colon:
            board, rest = MAIN, body
        if board not in self._boards:
            text = f"{found.text} is a pin of {board}, which is not a board that Passo drives"
            if board == JOINED:
                text = "Passo does not switch several outputs together"
            self._draft.dropped(found.place, f"[{section.name}] {name}", text)
            return None
        pin = self._aliases.get((board, rest), rest)
        marks, pin = marks + pin[: len(pin) - len(bare(pin))], bare(pin)
        if not _WORD.fullmatch(pin):
            raise bad(found.place, f"{name} in [{section.name}]", found.text, "a pin of a board")
        return named_on(self._boards[board], _marks(marks) + pin)


def board_name(name: str) -> str:
    """The name of a further board in the machine file."""
    return part_name(name)


def _marks(marks: str) -> str:
    """Each mark once; two `!` cancel each other."""
    inverted = "!" if marks.count("!") % 2 else ""
    pull = "^" if "^" in marks else "~" if "~" in marks else ""
    return inverted + pull
