"""How well a simulated print follows its file: ringing, corners, and the width of the lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo import _core
from passo.motion.endstops import motors_of_actuators
from passo.printer.setup.simulated_world import head_dynamics

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.machine import MachineConfig
    from passo.job.batch.result import PrintResult
    from passo.job.batch.simulated_print import Print

_UM = 1000.0


@dataclass(frozen=True, slots=True)
class CornerSample:
    """The motion at `s` seconds after the motors have passed a corner: X and Y of the head and of
    the motors in mm, the deviation of the head across its line in µm, and the width of the line as
    a fraction of its nominal one (0: no line)."""

    s: float
    head_mm: tuple[float, float]
    motors_mm: tuple[float, float]
    across_um: float
    width: float


@dataclass(frozen=True, slots=True)
class ShownCorner:
    """One corner of a print, for a picture: its number among the sharp corners, its line in the
    file, where it is, and the directions in X and Y of the lines before and after it."""

    number: int
    line: int
    at_mm: tuple[float, float]
    before: tuple[float, float]
    after: tuple[float, float]
    samples: list[CornerSample]


@dataclass(frozen=True, slots=True)
class Quality:
    """The measured quality of a print, all lengths of deviations in µm.

    Ringing is the deviation of the head across its line for 0.1 s after each sharp corner, once the
    motors are on the line; rounding is the distance of the head's path from a corner; `off_path_um`
    is its distance from all printed lines. The width error is the mean of the lines over their
    length, as a fraction of the width. `lost` is the fraction of the time in which the motors were
    more than 2 mm from the path; nothing is measured then."""

    corners: int
    printed_mm: float
    ringing_rms_um: float
    ringing_peak_um: float
    rounding_um: float
    largest_rounding_um: float
    off_path_um: float
    largest_off_path_um: float
    width_error: float
    lost: float


@dataclass(frozen=True, slots=True)
class Measurement:
    """What was measured of a print or of a stream. The time is that without heating."""

    quality: Quality
    corner: ShownCorner | None
    print_time_s: float
    steps: int
    commands: int


def quality_of(measured: _core.PrintQuality) -> Quality:
    """The results of a measurement that has ended."""
    ringing, rounding = measured.ringing_mm, measured.rounding_mm
    off_path = measured.off_path_mm
    return Quality(
        corners=measured.corners,
        printed_mm=measured.printed_mm,
        ringing_rms_um=_UM * ringing[0],
        ringing_peak_um=_UM * ringing[1],
        rounding_um=_UM * rounding[0],
        largest_rounding_um=_UM * rounding[1],
        off_path_um=_UM * off_path[0],
        largest_off_path_um=_UM * off_path[1],
        width_error=measured.width_error,
        lost=measured.lost,
    )


def shown_corner(measured: _core.PrintQuality) -> ShownCorner | None:
    """The corner for a picture; None in a print without sharp corners."""
    number, line, at_mm, before, after, rows = measured.shown
    if not rows:
        return None
    samples = [
        CornerSample(s, (hx, hy), (mx, my), _UM * across, width)
        for s, hx, hy, mx, my, across, width in rows
    ]
    return ShownCorner(number, line, at_mm, before, after, samples)


class QualityWatch:
    """Follows one print from the steps that the simulated boards execute."""

    def __init__(
        self,
        machine: MachineConfig,
        followed: Print,
        corner: int | None = None,
        *,
        keep_path: bool = False,
    ) -> None:
        """`corner` is the number of the corner that is shown; None: the one with the largest
        ringing. `keep_path` keeps the path of the file for a recorded stream."""
        self._job, self._device, self._base = followed.job, followed.board.device, 0
        self._motors = motors_of_actuators(machine)
        self._head = head_dynamics(machine, followed.board)
        self.measured = _core.PrintQuality(machine.board.clock_hz, self._head)
        if keep_path:
            self.measured.keep_path()
        if corner is not None:
            self.measured.show(corner)

    def begin(self, base: int) -> None:
        """Call this when the job begins, at the home position; `base` is the main board's clock."""
        self._base = base
        self._head.follow(True)
        self.placed()
        self.measured.begin(self._job, base)

    def placed(self, errors_mm: Mapping[str, float] | None = None) -> None:
        """Call this after homing, which changes the position at the end of the plan without a move.
        Errors of homing do not matter here: the position is that of the plan."""
        rows = {
            row["name"]: row["count"] / row["steps_per_unit"]
            for row in self._job.motors.statistics()
        }
        self._head.place(self._base + self._job.clock, [rows[name] for name in self._motors])

    def look(self) -> None:
        """Measures the motion that the boards have executed since."""
        self.measured.run(self._job, self._device.now)

    def end(self) -> None:
        """Call this at the end of the print."""
        self.look()
        self.measured.end(self._job)
        self._head.follow(False)

    def measurement(self, result: PrintResult) -> Measurement:
        """What was measured of the print with this result, after its end."""
        return Measurement(
            quality_of(self.measured),
            shown_corner(self.measured),
            result.print_time_s - result.heat_time_s,
            sum(result.steps.values()),
            result.queue_step_commands,
        )
