"""G30 and the other commands that measure with the probe."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.gcode.command import Command
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Place, Prober
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.rig import Rig


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
        kind=Kind.SERVED,
        lacks="This machine has no probe.",
    )
    def _probe(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        return WaitForProcedure(lambda: self._probe_once(words, reply))

    async def _probe_once(self, words: dict[str, float], reply: Reply) -> None:
        here = self._prober.place_here()
        place = Place(words.get("X", here.x), words.get("Y", here.y), here.name)
        (measured,) = await self._prober.measure([place])
        reply.say(f"Bed X: {place.x:.2f} Y: {place.y:.2f} Z: {measured.height_mm:.3f}")
