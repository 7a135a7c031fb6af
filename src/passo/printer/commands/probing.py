"""G30 and the other commands that measure with the probe."""

from __future__ import annotations

from statistics import fmean, median, pstdev
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.rig import Rig

NO_PROBE = "This machine has no probe."


class ProbeCommands:
    """Commands of a printer with a probe."""

    def __init__(self, rig: Rig, prober: Prober) -> None:
        self._rig, self._prober = rig, prober

    @command(
        "G30",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "X Y (mm)",
        "Measures the height of the bed at X and Y of the probe, by default where it is.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _probe(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        return WaitForProcedure(lambda: self._probe_once(words, reply))

    @command(
        "PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "",
        "Measures the height of the bed where the probe is, as Klipper reports it.",
        kind=Kind.PROBED,
        bare=None,
        lacks=NO_PROBE,
    )
    def _probe_here(self, _: Command, reply: Reply) -> Wait | None:
        async def measure() -> None:
            place = self._prober.place_here()
            (found,) = await self._prober.measure([place])
            where = f"at {place.x:.3f},{place.y:.3f}"
            reply.say(f"// Result: {where} estimate contact at z={found.height_mm:.6f}")

        return WaitForProcedure(measure)

    @command(
        "QUERY_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "",
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
        "P(4-50) X Y (mm)",
        "Measures one place P times (10), and reports how much the heights differ.",
        kind=Kind.PROBED,
        bare="VE",
        lacks=NO_PROBE,
    )
    def _repeatability(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        count = words.get("P", 10.0)
        if not 4 <= count <= 50:
            raise CommandError.bad_value("P", count, "4 to 50")
        here = self._prober.place_here()
        place = Place(words.get("X", here.x), words.get("Y", here.y), here.name)

        async def measure() -> None:
            reply.say("M48 Z-Probe Repeatability Test")
            heights = await self._prober.samples(place, int(count))
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
        "SAMPLES(4-50)",
        "As M48 where the probe is, as Klipper reports it.",
        kind=Kind.PROBED,
        bare=None,
        lacks=NO_PROBE,
    )
    def _accuracy(self, command: Command, reply: Reply) -> Wait | None:
        text = command.pairs().get("SAMPLES", "10")
        if not (text.isdecimal() and 4 <= int(text) <= 50):
            raise CommandError.of("command.value", axis="SAMPLES", value=text, limit="4 to 50")

        async def measure() -> None:
            heights = await self._prober.samples(self._prober.place_here(), int(text))
            low, high = min(heights), max(heights)
            reply.say(
                f"// probe accuracy results: maximum {high:.6f}, minimum {low:.6f}, range"
                f" {high - low:.6f}, average {fmean(heights):.6f}, median {median(heights):.6f},"
                f" standard deviation {pstdev(heights):.6f}"
            )

        return WaitForProcedure(measure)

    async def _probe_once(self, words: dict[str, float], reply: Reply) -> None:
        here = self._prober.place_here()
        place = Place(words.get("X", here.x), words.get("Y", here.y), here.name)
        (measured,) = await self._prober.measure([place])
        reply.say(f"Bed X: {place.x:.2f} Y: {place.y:.2f} Z: {measured.height_mm:.3f}")
