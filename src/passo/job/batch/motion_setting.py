"""The settings of the motion that the laboratory compares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.config.motion import JUNCTIONS, Backlash, Junction, Shaping
from passo.config.shapers import MAX_HZ, MIN_HZ, SHAPER_TYPES, ShaperType
from passo.config.simulated_motion import simulated_masses

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.config.motion import Extruder

ADVANCED: ShaperType = "mzv"
"""The shaper that is also printed with advance."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of the motion: the shaper of X and Y, pressure advance and the jerk limit, which
    makes S-curves of the changes of speed, on or off, and the law of junctions if it is not that of
    the machine file."""

    shaper: ShaperType | None = None
    advance: bool = False
    jerk_limit: bool = False
    junction: Junction | None = None

    @property
    def name(self) -> str:
        """Its name in tables."""
        parts = [self.shaper or "", "S-curve (jerk limit)" if self.jerk_limit else ""]
        parts.append("advance" if self.advance else "")
        if self.junction:
            parts.append(f"junction {self.junction.replace('_', ' ')}")
        return " + ".join(part for part in parts if part) or "none"

    def on(self, machine: MachineConfig) -> MachineConfig:
        """The machine with this setting and no other filter. Filters have the values of the machine
        file, else those that fit its simulated masses and nozzle: the jerk limit then averages over
        one cycle of the slower axis. The laboratory measures the motion, not the calibration of the
        machine: drives have no gap, and a delta has the geometry of its file."""
        limits = machine.limits.model_copy(
            update={
                "jerk_mm_s3": _jerk_mm_s3(machine) if self.jerk_limit else None,
                "junction": self.junction or machine.limits.junction,
            }
        )
        extruders = _advanced(machine) if self.advance else _not_advanced(machine)
        return machine.model_copy(
            update={
                "shaping": _shaping(machine, self.shaper) if self.shaper else {},
                "extruders": extruders,
                "limits": limits,
                "backlash": Backlash(),
                "simulated": machine.simulated.model_copy(update={"delta": None}),
            }
        )


def _advanced(machine: MachineConfig) -> dict[str, Extruder]:
    fits = machine.simulated.nozzle_pressure_s
    return {
        name: extruder.model_copy(update={"advance_s": extruder.advance_s or fits})
        for name, extruder in machine.extruders.items()
    }


def _not_advanced(machine: MachineConfig) -> dict[str, Extruder]:
    off = {"advance_s": None, "advance_smooth_s": None, "advance_knees": list[list[float]]()}
    return {name: extruder.model_copy(update=off) for name, extruder in machine.extruders.items()}


def _jerk_mm_s3(machine: MachineConfig) -> float:
    x, y, _ = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    cycle_s = 1 / min(x.frequency_hz, y.frequency_hz)
    return machine.limits.jerk_mm_s3 or 2 * machine.largest_accel_mm_s2 / cycle_s


def _shaping(machine: MachineConfig, kind: ShaperType) -> dict[str, Shaping]:
    x, y, _ = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    shaping: dict[str, Shaping] = {}
    for name, mass in (("x", x), ("y", y)):
        given = machine.shaping.get(name)
        hz = given.frequency_hz if given else min(max(mass.frequency_hz, MIN_HZ), MAX_HZ)
        damping = given.damping if given else min(mass.damping, 0.2)
        shaping[name] = Shaping(type=kind, frequency_hz=hz, damping=damping)
    return shaping


def settings_for(machine: MachineConfig) -> list[Setting]:
    """Each filter and each law of junctions by itself, and a shaper with advance."""
    settings = [Setting(), *(Setting(shaper) for shaper in SHAPER_TYPES), Setting(jerk_limit=True)]
    settings += [Setting(advance=True), Setting(ADVANCED, advance=True)]
    laws = [Setting(junction=law) for law in JUNCTIONS]
    return settings + [setting for setting in laws if setting.junction != machine.limits.junction]
