"""The sections of a printer.cfg as Klipper shows them: texts as written, and typed settings with
the defaults of all options that are not written."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from passo.config.klipper_options import OPTIONS, kind_of, option_of
from passo.config.part_names import found_name

if TYPE_CHECKING:
    from passo.config.klipper_options.option import Value
    from passo.config.machine import MachineConfig

Texts = Mapping[str, str]
Settings = Mapping[str, "Value"]


class Sections:
    """The sections of one machine. They are made at the first use. Do not change the values."""

    def __init__(self, machine: MachineConfig) -> None:
        self._machine = machine

    @cached_property
    def _own(self) -> dict[str, dict[str, str]]:
        """The sections of the parts that Passo drives."""
        from passo.config.exporting.klipper import sections_of

        return sections_of(self._machine)

    @cached_property
    def left_out(self) -> dict[str, dict[str, str]]:
        """The sections of parts that Passo does not drive, which the machine file keeps for
        macros."""
        kept = self._machine.klipper
        return {name: kept[name] for name in kept if found_name(self._own, name) is None}

    @cached_property
    def texts(self) -> dict[str, dict[str, str]]:
        """The options as written, by section: the machine's own values, and those that its file
        keeps."""
        written = self._own | self.left_out
        return {
            section: {name.lower(): _stripped(value) for name, value in options.items()}
            for section, options in written.items()
        }

    @cached_property
    def settings(self) -> dict[str, dict[str, Value]]:
        """All options with typed values, by section in lower case."""
        return {name.lower(): typed(name, options) for name, options in self.texts.items()}


def typed(section: str, written: Texts) -> dict[str, Value]:
    """The options of a section with their types, and the defaults of those that are not written.
    An option that the table does not know is a text."""
    rows = OPTIONS.get(kind_of(section), ())
    found: dict[str, Value] = {}
    for row in rows:
        if row.name in written:
            found[row.name] = row.read(written[row.name])
        elif (default := row.default_in(found)) is not None:
            found[row.name] = default
    for name, value in written.items():
        if name not in found:
            row = option_of(section, name)
            found[name] = value if row is None else row.read(value)
    return found


def _stripped(value: str) -> str:
    """A value of several lines without their indentation."""
    return "\n".join(line.strip() for line in value.split("\n"))
