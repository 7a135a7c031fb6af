"""The state of an import, shared by the modules for the parts of a configuration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.importing.draft import Draft, Place, Value, bad
from passo.config.importing.klipper.cfg import Config, Section
from passo.config.importing.klipper.pins import JOINED, Pins
from passo.config.importing.table import table_of
from passo.config.shapers import SHAPER_FORMS, shaper_form
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath

TABLE = table_of(Path(__file__).with_name("table.toml"))
_SAMPLES = {"average": "mean", "median": "median"}


@dataclass
class Import:
    """The configuration that is read, the draft that is made, and results of one module that others
    need."""

    config: Config
    draft: Draft
    pins: Pins
    used: set[str] = field(default_factory=set[str])
    left_out: set[str] = field(default_factory=set[str])  # of `used`, those that gave no part
    kept: set[str] = field(default_factory=set[str])  # left out, and kept for macros
    heaters: dict[str, str] = field(default_factory=dict[str, str])
    probe_pin: str | None = None
    probe_offset: tuple[float, float] = (0.0, 0.0)
    lost_heaters: list[str] = field(default_factory=list[str])
    fan_numbers: int = 0

    def put(self, group: str, section: Section, *others: Section, **names: str) -> None:
        """Sets the keys of a group of the table from a section. An option that it does not have
        comes from the first of the `others` that has it."""
        TABLE.put(self.draft, group, _Source(self.pins, (section, *others)), names)

    def put_value(self, path: KeyPath, section: Section, option: str, value: Value | None) -> None:
        """Sets a key that comes from an option in another form; None leaves it to the default."""
        self.draft.put(path, value, section.at(option))

    def leave_out(self, section: Section) -> None:
        """Marks a section as read that gives no part."""
        section.used.update(section.options)
        self.used.add(section.name)
        self.left_out.add(section.name)

    def part(
        self,
        section: Section,
        convert: Callable[[Import, Section], None],
        what: str = "the section",
    ) -> bool:
        """Converts a section without which the machine works too, or `what` of it. If that is not
        possible, it is left out, which is reported, and the result is False."""
        self.used.add(section.name)
        name = f"[{section.name}]"
        done = self.draft.attempt(section.place, name, lambda: convert(self, section), what)
        if not done:
            self.leave_out(section)
        return done

    def parts(self, *kinds: str, convert: Callable[[Import, Section], None]) -> None:
        """Converts each section of these names, as `part` does."""
        for kind in kinds:
            section = self.config.get(kind)
            if section is not None:
                self.part(section, convert)

    @property
    def motors(self) -> list[str]:
        """The motors of the draft, in order."""
        return [
            path[1] for path in self.draft.keys if path[0] == "steppers" and path[2] == "step_pin"
        ]

    def required(self, name: str) -> Section:
        """A section that Klipper requires, which is marked as read. Raises ConfigError."""
        section = self.config.get(name)
        if section is None:
            raise ConfigError.of("import.section", value=name)
        self.used.add(name)
        return section

    def heater(self, section: Section, option: str, name: str) -> str:
        """The heater of the machine file by its name in the configuration. Raises ConfigError."""
        if name not in self.heaters:
            raise section.wrong(option, "a heater", name)
        return self.heaters[name]

    def motor(self, section: Section, name: str) -> str:
        """The motor of the machine file by its name in the configuration. Raises ConfigError."""
        motors, found = self.motors, self.config.get(name)
        step = self.pins.of(found, "step_pin") if found else None
        for motor in motors:
            if step is not None and self.draft.keys["steppers", motor, "step_pin"][0] == step:
                return motor
        raise section.wrong("stepper", "a motor", name)


class _Source:
    """Sections of which the first that has an option counts, as a source of rows."""

    def __init__(self, pins: Pins, sections: tuple[Section, ...]) -> None:
        self._pins, self._sections = pins, sections

    def _of(self, option: str) -> Section:
        self._sections[0].used.add(option)
        return next((s for s in self._sections if option in s.options), self._sections[0])

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of an option and its place; None without the option, or if it is empty."""
        section = self._of(option)
        found = section.option(option)
        if found is None or (not found.text and unit != "gcode"):
            return None
        value = _value(self._pins, section, option, unit)
        return None if value is None else (value, found.place)

    def at(self, option: str) -> Place:
        """The place of an option, or of its default."""
        return self._of(option).at(option)

    def what(self, option: str) -> str:
        """The name of an option in a report."""
        return f"[{self._of(option).name}] {option}"

    def lacks(self, option: str, why: str) -> ConfigError:
        """The error of a missing option."""
        return self._of(option).missing(option, why)


def _value(pins: Pins, section: Section, option: str, unit: str) -> Value | None:
    """The value of an option that the section has. Raises ConfigError."""
    match unit:
        case "text":
            return section.text(option)
        case "word":
            return section.text(option).lower()
        case "gcode":
            return section.commented(option)
        case "given":
            return True
        case "flag":
            return section.flag(option, False)
        case "count":
            return section.whole(option)
        case "numbers":
            pair = section.pair(option)
            return [*pair] if pair else None
        case "pin":
            return pins.of(section, option)
        case "own pin":
            pin, written = pins.of(section, option), section.text(option)
            if pin is None:
                limit = "a pin of a board"
                if written.startswith(JOINED):
                    limit = "a pin of a board, or a [multi_pin] of this file"
                raise section.wrong(option, limit)
            return pin
        case "samples":
            result = section.text(option).lower()
            if result not in _SAMPLES:
                raise bad(section.at(option), f"{option} in [probe]", result, "median or average")
            return _SAMPLES[result]
        case "shaper":
            try:
                return shaper_form(section.text(option).lower())
            except ValueError:
                raise section.wrong(option, SHAPER_FORMS, section.text(option).lower()) from None
        case _:
            return section.number(option)
