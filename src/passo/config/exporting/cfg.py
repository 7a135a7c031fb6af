"""A printer.cfg under construction, and remarks on the parts of the machine that it cannot
contain."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.config.pin_names import bare, placed

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

Option = str | float | int | bool | None


@dataclass
class Cfg:
    """The sections in their order, each with its options, and remarks on the parts that were left
    out. `motors` are the sections of the motors, by their names in the machine file."""

    machine: MachineConfig
    sections: dict[str, dict[str, str]] = field(default_factory=dict[str, dict[str, str]])
    motors: dict[str, str] = field(default_factory=dict[str, str])
    left_out: list[str] = field(default_factory=list[str])

    def put(self, section: str, **options: Option) -> None:
        """Adds options to a section; None leaves one out."""
        found = self.sections.setdefault(section, {})
        found |= {name: _text(value) for name, value in options.items() if value is not None}

    def pin(self, written: str) -> str:
        """A pin in Klipper's form: its marks, the board, and the name of the pin on the chip."""
        board, _ = placed(written)
        pin = self.machine.pin(written)
        name = bare(pin)
        marks = pin[: len(pin) - len(name)].replace("!^", "^!").replace("!~", "~!")
        name = re.sub(r"^GP(\d+)$", r"gpio\1", name)  # of an RP2040
        return f"{marks}{board}:{name}" if board else f"{marks}{name}"

    def output(self, name: str, pin: str, further: Sequence[str]) -> str:
        """The pin of an output, or the [multi_pin] of this name for all its pins."""
        if not further:
            return self.pin(pin)
        self.put(f"multi_pin {name}", pins=", ".join(map(self.pin, (pin, *further))))
        return f"multi_pin:{name}"

    def text(self, head: str) -> str:
        """The file: `head` as comments, then the sections: sensors and joined pins come before the
        parts that name them, as Klipper requires."""
        lines = [f"# {line}".rstrip() for line in head.splitlines()]
        later = {name: own for name, own in self.sections.items() if not _comes_first(name)}
        first = {name: own for name, own in self.sections.items() if _comes_first(name)}
        for section, options in {**first, **later}.items():
            lines += ["", f"[{section}]", *(f"{name}: {value}" for name, value in options.items())]
        return "\n".join(lines) + "\n"


def _comes_first(section: str) -> bool:
    return section.startswith(("thermistor ", "multi_pin "))


def _text(value: str | float | int | bool) -> str:
    if isinstance(value, float):
        return f"{value:.8g}"
    return str(value).replace("\n", "\n  ")
