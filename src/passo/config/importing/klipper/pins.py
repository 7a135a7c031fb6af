"""Converts the pins and boards of a printer.cfg."""

from __future__ import annotations

import re
from string import digits
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.cfg import Config, Option, Section
from passo.config.part_names import part_name
from passo.config.pin_names import bare, named_on, placed

if TYPE_CHECKING:
    from passo.config.importing.draft import Draft

MAIN = "mcu"
JOINED = "multi_pin"  # in place of a board: several outputs under one name
# The outputs that may have several pins.
_JOINABLE = (
    *("extruder", "heater_bed", "heater_generic", "output_pin", "pwm_tool", "pwm_cycle_time"),
    *("fan", "heater_fan", "controller_fan", "fan_generic", "temperature_fan"),
)
_ALIAS = re.compile(r"\s*([^\s=,]+)\s*=\s*([^\s,]+)\s*")
_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_./-]*")


class Pins:
    """The boards and pins of a configuration."""

    def __init__(self, config: Config, draft: Draft) -> None:
        self._config, self._draft = config, draft
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
        if found is None:
            return None
        joined = self._joined(section, found)
        return self.pin(section, name, joined[0] if joined else found)

    def others_of(self, section: Section, name: str) -> list[str]:
        """The pins of a [multi_pin] after the first one, which `of` returns; empty for an option
        that names one pin. Raises ConfigError for pins of several boards."""
        found = section.option(name)
        pins = [self.pin(section, name, one) for one in self._joined(section, found)[1:]]
        further = [pin for pin in pins if pin is not None]
        boards = {placed(pin)[0] for pin in (self.of(section, name), *further) if pin is not None}
        if len(boards) > 1:
            raise section.wrong(name, "pins of one board")
        return further

    def _joined(self, section: Section, found: Option | None) -> list[Option]:
        """The pins of the [multi_pin] that an output's option names; empty if it names none."""
        if found is None or section.kind.rstrip(digits) not in _JOINABLE:
            return []
        board, _, name = bare(written := found.text.replace(" ", "")).partition(":")
        joined = self._config.get(f"{JOINED} {name}") if board == JOINED else None
        if joined is None:
            return []
        marks = written[: len(written) - len(bare(written))]
        place = joined.at("pins")
        pins = [pin.strip() for pin in joined.text("pins").split(",")]
        return [Option(marks + pin, place) for pin in pins if pin]

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
                text = "only heaters, fans and outputs have the pins of a [multi_pin]"
                if self._config.get(f"{JOINED} {rest}") is None:
                    text = f"there is no [{JOINED} {rest}]"
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
