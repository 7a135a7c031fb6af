"""Presets of materials, by number: temperatures and fan speed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import numeral
from passo.printer.commands.ranges import beyond

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_MARGIN_C = 15.0  # minimum distance of a preset from a heater's limit
_HOTTEST_C = 1200.0  # limit if the machine has no such heater


class Preset:
    """A material of M145: hotend and bed in °C, fan 0 to 255."""

    def __init__(self, hotend_c: float, bed_c: float, fan: float) -> None:
        self.hotend_c, self.bed_c, self.fan = hotend_c, bed_c, fan


class Presets:
    """The materials that M145 sets and that I of M104, M109, M140 and M190 names."""

    def __init__(self, machine: MachineConfig) -> None:
        self._machine = machine
        self._materials = [Preset(190, 60, 255), Preset(235, 100, 0), Preset(230, 80, 128)]

    def set(self, words: dict[str, float]) -> str:
        """Sets the given values of material S, clamped to their limits; without S it changes
        nothing. Returns a note about clamped values, or an empty text. Raises CommandError."""
        if "S" not in words:
            return ""
        preset = self._of("S", words["S"])
        ranges = {"H": self._most("hotend"), "B": self._most("bed"), "F": 255.0}
        taken = {k: min(max(words[k], 0.0), most) for k, most in ranges.items() if k in words}
        preset.hotend_c = taken.get("H", preset.hotend_c)
        preset.bed_c = taken.get("B", preset.bed_c)
        preset.fan = taken.get("F", preset.fan)
        notes = (beyond(f"M145 {k}", words[k], (0.0, ranges[k])) for k in taken)
        return ". ".join(note for note in notes if note)

    def celsius(self, number: float, kind: str) -> float:
        """The temperature of a material for the hotend or the bed. Raises CommandError."""
        preset = self._of("I", number)
        return preset.hotend_c if kind == "hotend" else preset.bed_c

    def lines(self) -> Iterable[str]:
        """The materials as commands."""
        for i, p in enumerate(self._materials):
            yield f"M145 S{i} H{numeral(p.hotend_c)} B{numeral(p.bed_c)} F{numeral(p.fan)}"

    def _of(self, letter: str, number: float) -> Preset:
        if int(number) not in range(len(self._materials)):
            raise CommandError.bad_value(letter, number, f"0 to {len(self._materials) - 1}")
        return self._materials[int(number)]

    def _most(self, kind: str) -> float:
        limits = [h.max_c for h in self._machine.heaters.values() if h.kind == kind]
        return min(limits, default=_HOTTEST_C) - _MARGIN_C
