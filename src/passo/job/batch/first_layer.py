"""How far the nozzle was from the simulated bed while a print extruded its first layer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo import _core
from passo.printer.setup.simulated_world import home_errors_mm

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_SAME_MM = 0.0005  # heights that differ by less are shown as one


@dataclass(frozen=True, slots=True)
class FirstLayer:
    """The smallest, the mean and the largest distance of the nozzle from the bed in mm, in
    samples that are 5 ms apart; X and Y of the nozzle at the smallest and at the largest one."""

    lowest_mm: float
    lowest_at_mm: tuple[float, float]
    mean_mm: float
    highest_mm: float
    highest_at_mm: tuple[float, float]

    def __str__(self) -> str:
        """One line for users."""
        if self.highest_mm - self.lowest_mm < _SAME_MM:
            return f"nozzle {self.mean_mm:.3f} mm above the bed"
        return (
            f"nozzle {self.lowest_mm:.3f} mm ({_place(self.lowest_at_mm)}) to"
            f" {self.highest_mm:.3f} mm ({_place(self.highest_at_mm)}) above the bed, on average"
            f" {self.mean_mm:.3f} mm"
        )


def _place(at_mm: tuple[float, float]) -> str:
    x, y = at_mm
    return f"X{x:.1f} Y{y:.1f}"


class FirstLayerWatch:
    """Follows the first layer of one print from the steps that the simulated boards execute, at
    next to no cost; it keeps nothing once that layer is over."""

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        follows: tuple[_core.NozzleGap, tuple[str, ...]],
    ) -> None:
        """`follows` is the result of `nozzle_gap`."""
        self._job = job
        self.area_mm = machine.bed_area_mm
        self._gap, self._motors = follows
        self._errors_mm: Mapping[str, float] = home_errors_mm(machine)
        self._going = True

    def begin(self, base: int) -> None:
        """Call this when the job begins, at the home position; `base` is the main board's clock."""
        self._gap.begin(self._job, base)
        self.placed()

    def placed(self, errors_mm: Mapping[str, float] | None = None) -> None:
        """Call this after homing, which changes the position at the end of the plan without a move.
        `errors_mm` is the real position of each motor minus its position in the plan, mm or
        degrees; with None, the last difference stays."""
        self._errors_mm = self._errors_mm if errors_mm is None else errors_mm
        rows = {
            row["name"]: row["count"] / row["steps_per_unit"]
            for row in self._job.motors.statistics()
        }
        at = [rows[name] + self._errors_mm[name] for name in self._motors]
        self._gap.place(self._job.clock, at)

    def look(self) -> None:
        """Samples the motion that the boards have executed since."""
        self._going = self._going and self._gap.follow(self._job)

    def end(self) -> None:
        """Call this at the end of the print."""
        self.look()
        if self._going:
            self._gap.end(self._job)
            self._going = False

    @property
    def layer(self) -> FirstLayer | None:
        """The measured distances; None if nothing was extruded along the bed."""
        if self._gap.samples == 0:
            return None
        (lowest, *at), (highest, *there) = self._gap.lowest, self._gap.highest
        return FirstLayer(lowest, (at[0], at[1]), self._gap.mean, highest, (there[0], there[1]))

    @property
    def cells(self) -> list[list[float | None]]:
        """The mean distance in each cell of the bed, in rows from the front, mm; None where nothing
        was extruded."""
        n = _core.GAP_CELLS
        found = [mean if samples else None for mean, samples in self._gap.cells]
        return [found[i : i + n] for i in range(0, n * n, n)]
