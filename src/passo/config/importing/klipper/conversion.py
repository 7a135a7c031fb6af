"""The state of an import, shared by the modules for the parts of a configuration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from passo.config.importing.draft import Draft
from passo.config.importing.klipper.cfg import Config, Section
from passo.config.importing.klipper.pins import Pins
from passo.errors import ConfigError


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
            section.used.update(section.options)
            self.left_out.add(section.name)
        return done

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
            place, key = section.at(option), f"{option} in [{section.name}]"
            raise ConfigError.of(
                "config.value", place.file, place.line, key=key, value=name, limit="a heater"
            )
        return self.heaters[name]

    def motor(self, section: Section, name: str) -> str:
        """The motor of the machine file by its name in the configuration. Raises ConfigError."""
        motors, found = self.motors, self.config.get(name)
        step = self.pins.of(found, "step_pin") if found else None
        for motor in motors:
            if step is not None and self.draft.keys["steppers", motor, "step_pin"][0] == step:
                return motor
        place, key = section.at("stepper"), f"stepper in [{section.name}]"
        raise ConfigError.of(
            "config.value", place.file, place.line, key=key, value=name, limit="a motor"
        )
