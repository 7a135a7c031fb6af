"""The twist of X and Y: how the heights that the probe measures change along a twisted rail."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import fmean
from typing import TYPE_CHECKING, Literal, TypeAlias

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, integer, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Measured, Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure
from passo.probes.base import Twist

if TYPE_CHECKING:
    from passo.printer.commands.manual_probe import ManualProbe

_Axis: TypeAlias = Literal["x", "y"]
_LACKS = "This machine has no [probe.twist.x] or [probe.twist.y]."


class AxisTwistCommands:
    """Measures and sets the twist of the axes of a printer with a probe."""

    def __init__(self, prober: Prober, manual: ManualProbe) -> None:
        self._prober, self._manual = prober, manual

    @command(
        "AXIS_TWIST_COMPENSATION_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Finds the correction for the twist of an axis: measures places along it with the probe,"
        " and the same places by the paper test. M500 stores it.",
        choice("AXIS", "the axis, by default X", "X", "Y"),
        integer("SAMPLE_COUNT", "how many places", low=2, high=100, default=3),
        kind=Kind.SERVED,
        lacks=_LACKS,
    )
    def _calibrate(self, command: Command, reply: Reply) -> Wait | None:
        axis, prober = self._axis(command), self._prober
        twist = prober.twist[axis]
        probed: list[Place] = []
        for at in twist.places(int(command.value("SAMPLE_COUNT"))):
            x, y = (at, twist.across_mm) if axis == "x" else (twist.across_mm, at)
            probed.append(Place(x, y, f"the place X{x:g} Y{y:g}"))
        under = [replace(place, by_nozzle=True) for place in probed]
        prober.check([*probed, *under])
        triggers: list[float] = []

        def done(found: Sequence[Measured], reply: Reply) -> None:
            gaps = [z - paper.trigger_z_mm for z, paper in zip(triggers, found, strict=True)]
            self._put(axis, [round(fmean(gaps) - gap, 6) for gap in gaps])
            reply.say(f"// {self.line(axis)} ; M500 or SAVE_CONFIG stores it")

        test = self._manual.start(under, done, reply=reply)

        async def calibrate() -> None:
            triggers.extend(found.trigger_z_mm for found in await prober.measure(probed))
            await test.run()

        return WaitForProcedure(calibrate)

    @command(
        "SET_AXIS_TWIST",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets what is added to the heights that the probe measures, at places at equal distances"
        " along an axis. Without HEIGHTS it reports them.",
        choice("AXIS", "the axis, by default X", "X", "Y"),
        text("HEIGHTS", "2 to 100 heights in mm, with commas between them; 0 for none"),
        kind=Kind.SERVED,
        lacks=_LACKS,
    )
    def _set(self, command: Command, reply: Reply) -> Wait | None:
        axis, given = self._axis(command), command.string("HEIGHTS")
        if not given:
            reply.say(f"// {self.line(axis)}")
            return None
        try:
            heights = [] if given == "0" else [float(mm) for mm in given.split(",")]
            before = self._prober.twist[axis].model_dump()
            checked = Twist.model_validate(before | {"heights_mm": heights})
            if len(heights) == 1:
                raise ValueError
        except ValueError:
            limit = "2 to 100 numbers of -5 to 5, with commas between them"
            raise CommandError.of(
                "command.value", axis="HEIGHTS", value=given, limit=limit
            ) from None
        return WaitForMoves(lambda: self._put(axis, checked.heights_mm))

    def _put(self, axis: _Axis, heights_mm: list[float]) -> None:
        twist = self._prober.twist
        twist[axis] = twist[axis].model_copy(update={"heights_mm": heights_mm})

    def _axis(self, command: Command) -> _Axis:
        axis: _Axis = "y" if command.string("AXIS").upper() == "Y" else "x"
        if axis not in self._prober.twist:
            raise CommandError.of("probe.no-twist", axis=command.code, value=axis)
        return axis

    def line(self, axis: _Axis) -> str:
        """The command that restores the correction of an axis."""
        heights = ",".join(f"{mm:.6f}" for mm in self._prober.twist[axis].heights_mm)
        return f"SET_AXIS_TWIST AXIS={axis.upper()} HEIGHTS={heights or 0}"

    def setting_lines(self) -> Iterator[str]:
        """The commands that restore all corrections."""
        return map(self.line, self._prober.twist)
