"""The states of parts that a machine file keeps only for macros."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from passo.config.klipper_options.left_out import stand_in
from passo.config.part_names import found_name

if TYPE_CHECKING:
    from passo.config.exporting.settings import Sections
    from passo.printer.klipper.objects import Objects

FANS = ("fan_generic", "heater_fan", "controller_fan")
HEATERS = ("heater_generic",)
PINS = ("output_pin", "pwm_tool", "pwm_cycle_time")
SERVOS = ("servo",)
LIGHTS = ("neopixel", "dotstar", "led", "pca9533", "pca9632")
FILAMENT_SENSORS = ("filament_switch_sensor", "filament_motion_sensor")


class StandIns:
    """The states of the parts of one machine that Passo does not drive, by Klipper's names. Macros
    read them; nothing is switched or measured."""

    def __init__(self, sections: Sections) -> None:
        self._sections = sections
        self._states: dict[str, dict[str, Any]] | None = None

    @property
    def objects(self) -> Objects:
        """For each part, by name, a function that copies its state."""
        return {name: partial(dict[str, Any], state) for name, state in self.states.items()}

    @property
    def states(self) -> dict[str, dict[str, Any]]:
        """The states. They are made at the first use."""
        if self._states is None:
            settings = self._sections.settings
            parts = ((name, stand_in(name)) for name in self._sections.left_out)
            self._states = {
                name: part.begun(settings[name.lower()]) for name, part in parts if part
            }
        return self._states

    def named(self, kinds: tuple[str, ...], name: str) -> dict[str, Any] | None:
        """The state of the part with one of these kinds and this name, or with its whole name."""
        named = [section for section in self.states if section.startswith(kinds)]
        names = {section.partition(" ")[2]: section for section in named}
        known = found_name(names, name)
        whole = names[known] if known is not None else found_name(named, name)
        return None if whole is None else self.states[whole]
