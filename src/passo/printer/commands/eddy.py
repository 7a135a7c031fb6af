"""The calibration of an eddy current probe: the current of its coil, and its frequency at each
height."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from pydantic import ValidationError

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import integer, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Measured, Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForMoves
from passo.probes.eddy import EddyCurve, EddyPoint, EddyProbe, falling

if TYPE_CHECKING:
    from passo.motion.eddy_gauge import EddyGauge
    from passo.printer.commands.manual_probe import ManualProbe
    from passo.printer.commands.probe_offsets import ProbeOffsetCommands

_LACKS = "This machine has no eddy current probe."
_LOWEST_MM = 10.0  # the paper may be so far below Z 0, while Z is only roughly known
_FIRST_MM, _STEP_MM, _STEPS = 0.05, 0.1, 41
_LEAST = 8  # heights of a calibration


class EddyCommands:
    """The calibration of the eddy current probe of one printer."""

    def __init__(
        self, probe: EddyProbe, prober: Prober, manual: ManualProbe, offsets: ProbeOffsetCommands
    ) -> None:
        self._probe, self._prober = probe, prober
        self._manual, self._offsets = manual, offsets

    @property
    def _gauge(self) -> EddyGauge:
        gauge = self._prober.gauge
        assert gauge is not None
        return gauge

    @command(
        "LDC_CALIBRATE_DRIVE_CURRENT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Finds the current of the coil of an eddy current probe, about 20 mm above the bed. M500"
        " stores it.",
        text("CHIP", "the name of the probe"),
        kind=Kind.SERVED,
        lacks=_LACKS,
    )
    def _current(self, command: Command, reply: Reply) -> Wait | None:
        self._check_name(command)

        def find() -> None:
            self._gauge.drive_current = self._gauge.reader.find_current()
            reply.say(
                f"// probe_eddy_current {self._probe.name}: reg_drive_current:"
                f" {self._gauge.drive_current}"
            )
            reply.say("// M500 or SAVE_CONFIG stores it")

        return WaitForMoves(find)

    @command(
        "PROBE_EDDY_CURRENT_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Finds the frequencies of an eddy current probe at heights of 0 to 4 mm: starts a paper"
        " test where the nozzle is; after ACCEPT, the probe measures above the same place. M500"
        " stores them.",
        text("CHIP", "the name of the probe"),
        number("PROBE_SPEED", "the speed of Z", "mm/s", 0, 50, above=True, default=5.0),
        kind=Kind.SERVED,
        lacks=_LACKS,
    )
    def _calibrate(self, command: Command, reply: Reply) -> Wait | None:
        self._check_name(command)
        speed = command.value("PROBE_SPEED")
        x, y = self._prober.nozzle_xy_mm
        under = Place(x, y, "this place", by_nozzle=True)
        self._prober.check([under, Place(x, y, "this place")])

        async def measure(found: Sequence[Measured], reply: Reply) -> None:
            place, bed_mm = Place(x, y, "this place"), found[0].trigger_z_mm
            heights = [round(_FIRST_MM + _STEP_MM * i, 3) for i in range(_STEPS)]
            rows = await self._prober.frequencies(place, bed_mm, heights, speed)
            points = falling([EddyPoint(mm=mm, hz=round(hz, 3)) for mm, hz in rows])
            self._put(points)
            low, high = EddyCurve(points).range_mm
            hz = points[0].hz - points[-1].hz
            reply.say(f"// Total frequency range: {hz:.3f} Hz, {low:.2f} to {high:.2f} mm")
            reply.say("// M500 or SAVE_CONFIG stores it. Home Z again if the probe homes it")

        return self._manual.start(
            [under], lambda _, __: None, reply=reply, lowest_mm=_LOWEST_MM, stays=True, then=measure
        )

    @command(
        "SET_EDDY_CALIBRATION",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the frequencies of an eddy current probe, and the current of its coil. Without"
        " parameters it reports them.",
        text("POINTS", "heights in mm with their frequencies in Hz, as 0.05:3285400,1.05:3261000"),
        integer("DRIVE_CURRENT", "the current, in the unit of the chip", 0, 31),
        kind=Kind.SERVED,
        lacks=_LACKS,
    )
    def _set(self, command: Command, reply: Reply) -> Wait | None:
        if not command.has("POINTS") and not command.has("DRIVE_CURRENT"):
            reply.say(f"// {self.line()}")
            return None
        points = _points(command.string("POINTS")) if command.has("POINTS") else None

        def change() -> None:
            if command.has("DRIVE_CURRENT"):
                self._gauge.drive_current = command.integer("DRIVE_CURRENT")
            if points is not None:
                self._put(points)

        return WaitForMoves(change)

    def _put(self, points: Sequence[EddyPoint]) -> None:
        """Uses a calibration. The correction of the earlier one by M851 ends. Raises
        CommandError."""
        heights = self._probe.trigger_height_mm, self._probe.scan_mm
        if len(points) < _LEAST or not points[0].mm < min(heights) <= max(heights) < points[-1].mm:
            last = f"{points[-1].mm:g} mm" if points else "none"
            limit = f"more than {max(heights):g} mm"
            raise CommandError.of("probe.bad-calibration", value=last, limit=limit)
        self._gauge.points = points
        self._offsets.set_offsets({"Z": -self._probe.trigger_height_mm})

    def _check_name(self, command: Command) -> None:
        name = command.string("CHIP")
        if name and name.lower() != self._probe.name.lower():
            raise CommandError.of("command.value", axis="CHIP", value=name, limit=self._probe.name)

    def line(self) -> str:
        """The command that restores the calibration."""
        gauge = self._gauge
        rows = ",".join(f"{p.mm:g}:{p.hz:.3f}" for p in gauge.points)
        points = f" POINTS={rows}" if rows else ""
        return f"SET_EDDY_CALIBRATION DRIVE_CURRENT={gauge.drive_current}{points}"

    def setting_lines(self) -> Iterator[str]:
        """The command that restores the calibration."""
        yield self.line()


def _points(written: str) -> list[EddyPoint]:
    points: list[EddyPoint] = []
    for pair in written.split(","):
        mm, _, hz = pair.partition(":")
        try:
            points.append(EddyPoint.model_validate({"mm": float(mm), "hz": float(hz)}))
        except (ValueError, ValidationError):
            limit = "heights of -2 to 20 mm with frequencies in Hz, as 0.05:3285400"
            raise CommandError.of("command.value", axis="POINTS", value=pair, limit=limit) from None
    points.sort(key=lambda p: p.mm)
    if falling(points) != points:
        limit = "frequencies that fall with the height"
        raise CommandError.of("command.value", axis="POINTS", value=written[:40], limit=limit)
    return points
