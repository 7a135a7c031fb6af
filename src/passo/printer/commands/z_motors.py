"""G34, Z_TILT_ADJUST and QUAD_GANTRY_LEVEL: level the gantry or the bed with the Z motors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from statistics import fmean
from typing import TYPE_CHECKING

from passo.config.klipper_names import stepper_object
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import ignored, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.levelling.z_motors import check_progress, gantry_adjustments, lifts, tilt_adjustments
from passo.motion.axis_slots import Z
from passo.motion.lone_motors import LoneMotors
from passo.motion.probing import Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.calibration import ZMotors
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.positions import Positions
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import TriggeredMoves

NO_MOTORS = "The machine file has no [levelling.motors], or no probe."
_DIGITS = 6  # decimals of mm, so that stored and active values are equal


def has_endstops(machine: MachineConfig) -> bool:
    """Whether each Z motor has its own endstop."""
    return "z" in machine.homing and len(machine.homing["z"].stepper_pins) > 1


class EndstopOffsets:
    """The endstop offsets of one printer's Z motors; `has_endstops` must be True for its machine.
    The active offsets are those of the rig."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig

    @property
    def offsets(self) -> dict[str, float]:
        """For each motor, the height above the home position at which its endstop triggers, mm."""
        config = self._rig.machine.homing["z"]
        return {name: config.offsets_mm.get(name, 0.0) for name in config.stepper_pins}

    def use(self, offsets_mm: Mapping[str, float]) -> None:
        """Sets the offsets, mm by motor; they take effect when Z is homed the next time."""
        machine = self._rig.machine
        rounded = {name: round(mm, _DIGITS) + 0.0 for name, mm in offsets_mm.items()}
        z = machine.homing["z"].model_copy(update={"offsets_mm": rounded})
        homing = machine.homing | {"z": z}
        self._rig.use_geometry(machine.model_copy(update={"homing": homing}))

    def setting_lines(self) -> Iterator[str]:
        """Commands that restore the offsets exactly."""
        for n, mm in enumerate(self.offsets.values(), 1):
            yield f"M666 S{n} Z{mm:.{_DIGITS}f}"


class ZMotorCommands:
    """Levels the gantry of one printer with `config`."""

    def __init__(
        self,
        rig: Rig,
        config: ZMotors,
        prober: Prober,
        correction: BedCorrection,
        triggered: TriggeredMoves,
        motors: LoneMotors,
        endstops: EndstopOffsets | None,
    ) -> None:
        self._rig, self._config, self._prober = rig, config, prober
        self._correction, self._triggered = correction, triggered
        self._motors, self._endstops = motors, endstops
        self._levelled: tuple[Positions, int] | None = None  # the state at the last levelling

    @property
    def level(self) -> bool:
        """Whether the gantry was levelled, and its motors have been on since then."""
        positions = self._rig.positions
        return self._levelled == (positions, positions.invalidations)

    @command(
        "G34",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures the tilt of the gantry, and levels it by the motors of Z, at most I times, until"
        " the tilt is at most T. If each motor has an endstop, G28 keeps it level from then on.",
        number("I", "how often at most", low=1, high=30),
        number("T", "the tilt that is small enough", "mm", 0.001, 1),
        ignored("S Z A"),
        kind=Kind.PROBED,
        lacks=NO_MOTORS,
    )
    def _align(self, command: Command, reply: Reply) -> Wait | None:
        retries = command.value("I", self._config.retries)
        tolerance = command.value("T", self._config.tolerance_mm)
        return WaitForProcedure(partial(self._level, int(retries), tolerance, reply))

    @command(
        "Z_TILT_ADJUST",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Levels the gantry as G34.",
        number("RETRIES", "how often at most, after the first time", low=0, high=30),
        number("RETRY_TOLERANCE", "the tilt that is small enough", "mm", 0.001, 1),
        kind=Kind.PROBED,
        lacks=NO_MOTORS,
    )
    @command(
        "QUAD_GANTRY_LEVEL",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Levels the gantry as G34.",
        number("RETRIES", "how often at most, after the first time", low=0, high=30),
        number("RETRY_TOLERANCE", "the tilt that is small enough", "mm", 0.001, 1),
        kind=Kind.PROBED,
        lacks=NO_MOTORS,
    )
    def _adjust(self, command: Command, reply: Reply) -> Wait | None:
        retries = command.value("RETRIES", self._config.retries)
        tolerance = command.value("RETRY_TOLERANCE", self._config.tolerance_mm)
        return WaitForProcedure(partial(self._level, int(retries), tolerance, reply))

    async def _level(self, retries: int, tolerance_mm: float, reply: Reply) -> None:
        """Measures and adjusts until the tilt between the motors is at most `tolerance_mm`. Then
        the mean of the points is Z 0."""
        points = self._config.points
        places = [Place(p.x, p.y, f"point {n}") for n, p in enumerate(points, 1)]
        moved = dict.fromkeys(self._config.pivots, 0.0)  # change of each motor's endstop offset, mm
        tilts: list[float] = []
        while True:
            measured = await self._prober.measure(places)
            heights = [m.height_mm for m in measured]
            adjustments = self._adjustments([(m.place.x, m.place.y, m.height_mm) for m in measured])
            tilts.append(max(adjustments.values()) - min(adjustments.values()))
            reply.say(
                f"Retries: {len(tilts) - 1}/{retries} Tilt between the motors: {tilts[-1]:.4f} mm"
                f" tolerance: {tolerance_mm:g} mm"
            )
            if tilts[-1] <= tolerance_mm:
                break
            check_progress(tilts, list(adjustments))
            if len(tilts) > retries:
                raise CommandError.of(
                    "levelling.motor-retries", value=tilts[-1], limit=tolerance_mm, times=retries
                )
            by_mm = lifts(adjustments, self._config.max_adjust_mm)
            reply.say("Making the following Z adjustments:")
            for name, mm in by_mm.items():
                reply.say(f"{stepper_object(self._rig.machine, name)} = {mm:.6f}")
            mean = await self._lift(by_mm)
            moved = {name: mm + mean - by_mm[name] for name, mm in moved.items()}
        self._finish(moved, fmean(heights), reply)

    def _adjustments(self, points: Sequence[tuple[float, float, float]]) -> dict[str, float]:
        pivots = {name: (x, y) for name, (x, y) in self._config.pivots.items()}
        if len(pivots) < 4:
            found = tilt_adjustments(list(pivots.values()), points)
        else:
            first, _, third, _ = pivots.values()
            found = gantry_adjustments([(x, y, -z) for x, y, z in points], (first, third))
        return dict(zip(pivots, found, strict=True))

    async def _lift(self, by_mm: Mapping[str, float]) -> float:
        """Moves each motor up. Returns the rise of Z in the middle, mm. After an error, Z must be
        homed again."""
        rig, mean = self._rig, fmean(by_mm.values())
        self._levelled = None
        try:
            with self._correction.suspended(), self._triggered.prepared():
                await self._motors.move("z", by_mm, self._prober.probe.lift_mm_s)
                rig.job.axes.set([(Z, rig.job.machine_position[Z] + mean)])
        except BaseException:
            rig.lock(["z"])
            raise
        return mean

    def _finish(self, moved: Mapping[str, float], mean_mm: float, reply: Reply) -> None:
        """Ends the levelling: sets Z 0 to the bed, and the endstop offsets to the new trigger
        positions."""
        rig, correction = self._rig, self._correction
        self._levelled = rig.positions, rig.positions.invalidations
        if correction.on:
            correction.use(correction.correction, on=False)
            reply.say("The correction of the bed is off: measure it again (G29 or G32)")
        rig.job.axes.set([(Z, rig.job.machine_position[Z] - mean_mm)])
        if self._endstops is not None:
            found = self._endstops.offsets
            self._endstops.use({name: found[name] + mm - mean_mm for name, mm in moved.items()})
            lines = ", ".join(self._endstops.setting_lines())
            reply.say(f"G28 keeps it level from now on: {lines}")
            reply.say("M500 stores these offsets; M501 or M502 takes them back")
