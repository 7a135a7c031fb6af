"""PID gains that are probably in another unit than 1/255 of full power."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from passo.config.findings import Finding
from passo.config.heat import PidControl

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_UNIT = 255.0  # full power in the unit of gains
# Gains of real heaters, in 1/255 of full power per °C, per °C·s and per °C/s; 0 is valid for ki and
# kd. There is a gap between these ranges and the same ranges divided by 255.
_HOTEND = {"kp": (1.5, 1000.0), "ki": (0.02, 100.0), "kd": (2.0, 20_000.0)}
_SLOW = {"kp": (4.0, 2500.0), "ki": (0.001, 250.0), "kd": (2.0, 50_000.0)}  # bed, chamber
_NAMES = {"hotend": "a hotend", "bed": "a bed", "chamber": "a chamber"}


class Doubt(NamedTuple):
    """A gain that is implausible for its kind of heater; `meant` are the gains in the usual unit,
    if another unit explains the value."""

    key: str
    value: float
    usual: str
    meant: Mapping[str, float]

    @property
    def hint(self) -> str:
        """A question with the gains that were probably meant; empty if no other unit explains the
        value."""
        if not self.meant:
            return ""
        gains = ", ".join(f"{key} = {value:.4g}" for key, value in self.meant.items())
        times = "multiplied" if self.meant[self.key] > self.value else "divided"
        return f"Did you mean {gains} ({times} by 255)?"


def doubt(kind: str, gains: Mapping[str, float]) -> Doubt | None:
    """The first of the gains (kp, ki, kd) that is implausible for a heater of this kind, or
    None."""
    bounds = _HOTEND if kind == "hotend" else _SLOW
    for key, (least, most) in bounds.items():
        value = gains.get(key, 0.0)
        if value == 0 or least <= value <= most:
            continue
        factor = _UNIT if value < least else 1 / _UNIT
        fits = least <= value * factor <= most
        same_unit = gains if key == "kp" or "kp" not in gains else {key: value}
        meant = {k: v * factor for k, v in same_unit.items()} if fits else {}
        usual = f"{_NAMES[kind]} has {least:g} to {most:g}, where full power is 255"
        return Doubt(key, value, usual, meant)
    return None


def question_gains(machine: MachineConfig) -> Iterator[Finding]:
    """One finding for each heater with implausible gains."""
    for name, heater in machine.heaters.items():
        control = heater.control
        if not isinstance(control, PidControl):
            continue
        given = {key: getattr(control, key) for key in ("kp", "ki", "kd")}
        found = doubt(heater.kind, {key: v for key, v in given.items() if v is not None})
        if found is not None:
            path = ("heaters", name, "control", found.key)
            yield Finding("config.gain", path, found.value, found.usual, found.hint)
