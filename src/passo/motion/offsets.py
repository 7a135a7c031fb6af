"""The offsets of a live printer: home offsets and babysteps."""

from __future__ import annotations

from collections.abc import Iterable

from passo.config.machine import MachineConfig
from passo.config.motor_roles import axis_order


class Offsets:
    """Home offsets (M206) and babysteps (M290) of one printer, mm by axis. `babysteps_mm` is the
    sum of live babysteps since the axis was homed; `kept_mm` is what homing leaves of it: the
    offset of SET_GCODE_OFFSET."""

    def __init__(self, machine: MachineConfig) -> None:
        homed = [a for a in axis_order(machine.axes) if not machine.axes[a].extruder]
        self.home_mm = dict.fromkeys(homed, 0.0)
        self.babysteps_mm = dict.fromkeys("xyz", 0.0)
        self.kept_mm = dict.fromkeys("xyz", 0.0)
        self._suspended_mm = dict.fromkeys("xyz", 0.0)  # babysteps of the suspended job only

    def homed(self, axes: Iterable[str]) -> None:
        """Call this after homing these axes: their babysteps that are not kept now apply only to
        the suspended job."""
        for axis in axes:
            if axis in self.babysteps_mm:
                self._suspended_mm[axis] += self.babysteps_mm[axis] - self.kept_mm[axis]
                self.babysteps_mm[axis] = self.kept_mm[axis]

    def restarted(self) -> None:
        """Call this when the printer has restarted, with a job that keeps no offset."""
        self.kept_mm = dict.fromkeys("xyz", 0.0)
        self.homed("xyz")

    def keep(self, axis: str, mm: float) -> float:
        """The offset that homing keeps is `mm` now. Returns the change."""
        by, self.kept_mm[axis] = mm - self.kept_mm[axis], mm
        return by

    def absorbed(self, axis: str) -> float:
        """Call this when the babysteps have become part of another offset. Returns the change of
        the offset that homing keeps."""
        self.babysteps_mm[axis] = 0.0
        return self.keep(axis, 0.0)

    def suspend(self) -> None:
        """Call this when the job is suspended: stores its babysteps."""
        self._suspended_mm = dict.fromkeys("xyz", 0.0)

    def resume(self) -> None:
        """Call this when the job resumes: restores its babysteps."""
        self.babysteps_mm = self.of_program_mm(suspended=True)

    def of_program_mm(self, *, suspended: bool) -> dict[str, float]:
        """The babysteps of the program, mm by axis. `suspended`: its job is suspended."""
        if not suspended:
            return dict(self.babysteps_mm)
        return {axis: mm + self._suspended_mm[axis] for axis, mm in self.babysteps_mm.items()}
