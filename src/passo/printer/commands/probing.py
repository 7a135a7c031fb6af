"""G30 and the other commands that measure with the probe."""

from __future__ import annotations

from statistics import fmean, median, pstdev
from typing import TYPE_CHECKING

from passo.gcode.command import Command
from passo.gcode.parameters import choice, ignored, integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.rig import Rig

NO_PROBE = "This machine has no probe."
SCANS = "scan", "rapid_scan"


def scan_of(command: Command) -> str | None:
    """The scan that METHOD asks for, if it does."""
    method = command.string("METHOD").lower()
    return method if method in SCANS else None


class ProbeCommands:
    """Commands of a printer with a probe."""

    def __init__(self, rig: Rig, prober: Prober) -> None:
        self._rig, self._prober = rig, prober

    @command(
        "G30",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures the height of the bed at X and Y of the probe, by default where it is.",
        number("X Y", "the place of the probe", "mm"),
        ignored("Z S P H E"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _probe(self, command: Command, reply: Reply) -> Wait | None:
        return WaitForProcedure(lambda: self._probe_once(command, reply))

    @command(
        "PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures the height of the bed where the probe is, as Klipper reports it. METHOD=scan"
        " measures without a descent, with an eddy current probe.",
        choice("METHOD", "scan: without a descent", *SCANS, "automatic"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _probe_here(self, command: Command, reply: Reply) -> Wait | None:
        scans = scan_of(command) is not None

        async def measure() -> None:
            place = self._prober.place_here()
            if scans:
                height = await self._prober.height_here()
            else:
                (found,) = await self._prober.measure([place])
                height = found.height_mm
            where = f"at {place.x:.3f},{place.y:.3f}"
            reply.say(f"// Result: {where} estimate contact at z={height:.6f}")

        return WaitForProcedure(measure)

    @command(
        "QUERY_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Reports whether the probe is triggered.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _query(self, _: Command, reply: Reply) -> Wait | None:
        def ask() -> None:
            reply.say(f"// probe: {'TRIGGERED' if self._prober.triggered() else 'open'}")

        return WaitForMoves(ask)

    @command(
        "M48",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures one place P times (10), and reports how much the heights differ.",
        number("P", "how often", low=4, high=50, default=10),
        number("X Y", "the place of the probe", "mm"),
        ignored("V E L S"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _repeatability(self, command: Command, reply: Reply) -> Wait | None:
        count, place = int(command.value("P")), self._place(command)

        async def measure() -> None:
            reply.say("M48 Z-Probe Repeatability Test")
            heights = await self._prober.samples(place, count)
            reply.say("Finished!")
            low, high = min(heights), max(heights)
            reply.say(
                f"Mean: {fmean(heights):.6f} Min: {low:.3f} Max: {high:.3f} Range: {high - low:.3f}"
            )
            reply.say(f"Standard Deviation: {pstdev(heights):.6f}")

        return WaitForProcedure(measure)

    @command(
        "PROBE_ACCURACY",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As M48 where the probe is, as Klipper reports it.",
        integer("SAMPLES", "how often", 4, 50, default=10),
        ignored("PROBE_SPEED LIFT_SPEED SAMPLE_RETRACT_DIST SAMPLES_RESULT"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _accuracy(self, command: Command, reply: Reply) -> Wait | None:
        count = command.integer("SAMPLES")

        async def measure() -> None:
            heights = await self._prober.samples(self._prober.place_here(), count)
            low, high = min(heights), max(heights)
            reply.say(
                f"// probe accuracy results: maximum {high:.6f}, minimum {low:.6f}, range"
                f" {high - low:.6f}, average {fmean(heights):.6f}, median {median(heights):.6f},"
                f" standard deviation {pstdev(heights):.6f}"
            )

        return WaitForProcedure(measure)

    def _place(self, command: Command) -> Place:
        """X and Y of the command, or where the probe is."""
        here = self._prober.place_here()
        return Place(command.value("X", here.x), command.value("Y", here.y), here.name)

    async def _probe_once(self, command: Command, reply: Reply) -> None:
        place = self._place(command)
        (measured,) = await self._prober.measure([place])
        reply.say(f"Bed X: {place.x:.2f} Y: {place.y:.2f} Z: {measured.height_mm:.3f}")
