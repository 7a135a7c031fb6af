"""G38.2 to G38.5: straight moves that end when the probe triggers or opens."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import number
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Prober
from passo.printer.commands.probing import NO_PROBE
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.rig import Rig

_SLOTS = {"X": 0, "Y": 1, "Z": 2}
_SHORTEST_MM = 0.0275  # as in Marlin
_WORDS = "X Y Z (mm) F(mm/min)"


class ProbeMoveCommands:
    """The probing moves of one printer. The position of the trigger is reported in the format of
    grbl."""

    def __init__(self, rig: Rig, prober: Prober) -> None:
        self._rig, self._prober = rig, prober

    @command(
        "G38.2",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Moves straight until the probe triggers; an error if it does not.",
        number("X Y Z", "the end of the move", "mm"),
        number("F", "the feedrate", "mm/min", 0, above=True),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "G38.3",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As G38.2, without the error.",
        number("X Y Z", "the end of the move", "mm"),
        number("F", "the feedrate", "mm/min", 0, above=True),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "G38.4",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Moves straight until the probe opens; an error if it does not.",
        number("X Y Z", "the end of the move", "mm"),
        number("F", "the feedrate", "mm/min", 0, above=True),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "G38.5",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As G38.4, without the error.",
        number("X Y Z", "the end of the move", "mm"),
        number("F", "the feedrate", "mm/min", 0, above=True),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _seek(self, command: Command, reply: Reply) -> Wait | None:
        given = {letter: command.value(letter) for letter in _SLOTS if command.has(letter)}
        if not given:
            raise CommandError.of("input.missing-word", axis=command.code, value="X, Y or Z")
        speed_mm_s = command.value("F", 60 * self._prober.probe.slow_mm_s) / 60
        if speed_mm_s > self._prober.probe.travel_mm_s:
            limit = f"up to {60 * self._prober.probe.travel_mm_s:g} mm/min"
            raise CommandError.bad_value("F", 60 * speed_mm_s, limit)
        return WaitForProcedure(lambda: self._sought(command.code, given, speed_mm_s, reply))

    async def _sought(
        self, code: str, given: dict[str, float], speed_mm_s: float, reply: Reply
    ) -> None:
        job, axes = self._rig.job, self._rig.machine.axes
        absolute, *_ = job.modes.now
        target: dict[int, float] = {}
        for letter, mm in given.items():
            slot = _SLOTS[letter]
            shift = job.machine_position[slot] - (job.program_position[slot] if absolute else 0.0)
            target[slot] = mm + shift
            axis = axes[letter.lower()]
            if not axis.min_mm <= target[slot] <= axis.max_mm:
                limit = f"{axis.min_mm:g} to {axis.max_mm:g} mm of the machine"
                raise CommandError.bad_value(letter, round(target[slot], 3), limit)
        way = max(abs(mm - job.machine_position[slot]) for slot, mm in target.items())
        if way < _SHORTEST_MM:
            return
        opening = code in ("G38.4", "G38.5")
        found, hit = await self._prober.seek(target, speed_mm_s, opening=opening)
        place = ",".join(f"{mm:.3f}" for mm in found)
        reply.say(f"[PRB:{place}:{int(hit)}]")
        if not hit and code in ("G38.2", "G38.4"):
            x, y, z = found
            raise CommandError.of("probe.no-contact", position=f"X{x:.3f} Y{y:.3f} Z{z:.3f}")
