"""G35 and other commands that adjust the screws of the bed, with the probe or with a sheet of
paper."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Literal

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.levelling.screws import Screw, adjustments
from passo.motion.probing import Measured, Place, Prober
from passo.printer.status import ScrewStatus
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.calibration import Screws, Thread
    from passo.printer.commands.manual_probe import ManualProbe

NO_SCREWS = "The machine file has no [levelling.screws], or no probe."
_THREADS: dict[int, Thread] = {
    30: "M3 cw",
    31: "M3 ccw",
    40: "M4 cw",
    41: "M4 ccw",
    50: "M5 cw",
    51: "M5 ccw",
}  # as Marlin numbers them
Direction = Literal["CW", "CCW"]


class ScrewCommands:
    """Measures the bed above the screws of `config`."""

    def __init__(self, config: Screws, prober: Prober, manual: ManualProbe) -> None:
        self._config, self._prober, self._manual = config, prober, manual
        self.measured: tuple[ScrewStatus, ...] = ()
        self.exceeded_mm: float | None = None  # MAX_DEVIATION, if the screws differ by more

    @command(
        "G35",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures the bed above its screws, and reports how far to turn each so that all are as"
        " high as the first. S30, S31, S40, S41, S50 and S51 are screws M3 to M5 in place of those"
        " of the machine file; with 1, clockwise lowers the bed.",
        integer("S", "the thread: M3, M4 or M5, and 1 if clockwise lowers the bed", 30, 51),
        kind=Kind.PROBED,
        lacks=NO_SCREWS,
    )
    def _assist(self, command: Command, reply: Reply) -> Wait | None:
        thread = self._config.thread
        if (code := command.integer("S", None)) is not None:
            if code not in _THREADS:
                raise CommandError.bad_value("S", code, ", ".join(map(str, _THREADS)))
            thread = _THREADS[code]

        async def measure() -> None:
            for screw in _adjusted(await self._heights(), thread, None)[1:]:
                turn = f"{'CW' if screw.clockwise else 'CCW'} by {screw.turns} turns"
                away = f"{screw.minutes} minutes ({-screw.mm:.3f}mm)"
                reply.say(f"Turn {screw.name} {turn} and {away}")

        return WaitForProcedure(measure)

    @command(
        "SCREWS_TILT_CALCULATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As G35, as Klipper reports it: turns and minutes of a clock. With DIRECTION no screw is"
        " turned the other way. It is an error if the screws differ by more than MAX_DEVIATION.",
        choice("DIRECTION", "no screw is turned the other way", "CW", "CCW"),
        number("MAX_DEVIATION", "an error if the screws differ by more", "mm"),
        kind=Kind.PROBED,
        lacks=NO_SCREWS,
    )
    def _calculate(self, command: Command, reply: Reply) -> Wait | None:
        most, given = command.value("MAX_DEVIATION", None), command.string("DIRECTION").upper()
        direction: Direction | None = "CW" if given == "CW" else "CCW" if given else None
        return WaitForProcedure(partial(self._report, direction, most, reply))

    @command(
        "BED_SCREWS_ADJUST",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Leads the nozzle over each screw, at Z 0: turn it until a sheet of paper just moves, then"
        " send ADJUSTED, or ACCEPT if it need not be turned.",
        kind=Kind.SERVED,
        lacks=NO_SCREWS,
    )
    def _adjust(self, _: Command, reply: Reply) -> Wait | None:
        places = [Place(s.x, s.y, s.name, by_nozzle=True) for s in self._config.places]
        return self._manual.adjust_screws(places, reply)

    async def _report(self, direction: Direction | None, most: float | None, reply: Reply) -> None:
        measured = await self._heights()
        thread = self._config.thread
        screws = {s.name: s for s in _adjusted(measured, thread, direction)}
        base = next(iter(screws))
        reply.say("// 01:20 means 1 full turn and 20 minutes, CW=clockwise, CCW=counter-clockwise")
        for m in measured:
            name = m.place.name
            where = f"x={m.place.x:.1f}, y={m.place.y:.1f}, z={m.height_mm:.5f}"
            if name == base:
                reply.say(f"// {name} (base) : {where}")
            else:
                reply.say(f"// {name} : {where} : adjust {screws[name].adjust}")
        self.measured = tuple(
            ScrewStatus(name, m.height_mm, screws[name].adjust, name == base)
            for m in measured
            for name in (m.place.name,)
        )
        heights = [m.height_mm for m in measured]
        apart = max(heights) - min(heights)
        self.exceeded_mm = None
        if most is not None and apart > most:
            self.exceeded_mm = most
            raise CommandError.of("levelling.screws", value=apart, limit=most)

    async def _heights(self) -> list[Measured]:
        places = [Place(screw.x, screw.y, screw.name) for screw in self._config.places]
        return await self._prober.measure(places)


def _adjusted(measured: list[Measured], thread: Thread, direction: Direction | None) -> list[Screw]:
    """The adjustment of each screw. The first screw is the one that stays: the base screw of the
    machine file or, if all screws must turn in one direction, the highest or the lowest."""
    heights = [(m.place.name, m.height_mm) for m in measured]
    if direction is not None:
        lifts = (direction == "CW") == thread.endswith(" cw")
        pick = max if lifts else min
        base = pick(heights, key=lambda screw: screw[1])
        heights.remove(base)
        heights.insert(0, base)
    return adjustments(heights, thread)
