"""The paper test: the user lowers the nozzle until a sheet of paper just moves, and sends
ACCEPT."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Measured, Place, Prober
from passo.printer.commands.probe_offsets import ProbeOffsetCommands
from passo.printer.commands.probing import NO_PROBE, SCANS
from passo.printer.status import ManualProbeStatus
from passo.printer.wait_requests import NullReply, Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.bed_correction import BedCorrection

LOWEST_MM = 2.0  # below the last measured bed
_SPEED_MM_S = 5.0
METHODS = "manual", "automatic", *SCANS

Done = Callable[[Sequence[Measured], Reply], None]
Then = Callable[[Sequence[Measured], Reply], Awaitable[None]]


@dataclass(slots=True)
class _Run:
    """A test in progress: the remaining places, the heights so far, and the function to call at the
    end. `screws` are all screws of the bed if the test adjusts screws, with the nozzle at Z 0 above
    each. `lowest_mm`, `stays` and `then`: see `ManualProbe.start`."""

    places: list[Place]
    done: Done
    report: Callable[[Measured, Reply], None]
    count: int
    found: list[Measured]
    tried: list[float]
    screws: tuple[Place, ...] = ()
    lowest_mm: float = LOWEST_MM
    stays: bool = False
    then: Then | None = None


class ManualProbe:
    """The paper test of one printer. During a test, the bed correction is off, so that Z is the
    machine's."""

    def __init__(
        self, prober: Prober, correction: BedCorrection, offsets: ProbeOffsetCommands
    ) -> None:
        self._prober, self._correction, self._offsets = prober, correction, offsets
        self._run: _Run | None = None

    def reset(self) -> None:
        """Call this after the boards have been replaced: ends a test."""
        self._run = None

    @property
    def status(self) -> ManualProbeStatus | None:
        """The status of the test; None without a test."""
        run = self._run
        if run is None:
            return None
        z = self._prober.z_mm
        below, above = _neighbours(run.tried, z)
        return ManualProbeStatus(len(run.found) + 1, run.count, z, below, above)

    def start(
        self,
        places: Sequence[Place],
        done: Done,
        report: Callable[[Measured, Reply], None] = lambda _, __: None,
        reply: Reply | None = None,
        *,
        screws: bool = False,
        lowest_mm: float = LOWEST_MM,
        stays: bool = False,
        then: Then | None = None,
    ) -> WaitForProcedure:
        """Starts a test that moves the nozzle to each place in turn; `done` is called with the
        heights. The nozzle may go `lowest_mm` below the last measured bed. With `stays`, it does
        not move at the start. `then` runs after `done`, and may move. Raises CommandError."""
        if self._run is not None:
            raise CommandError.of("probe.manual-active")
        self._prober.check(places)
        shown = tuple(places) if screws else ()
        run = _Run(list(places), done, report, len(places), [], [], shown, lowest_mm, stays, then)

        async def begin() -> None:
            self._correction.suspend()
            self._run = run
            try:
                await self._next(reply or NullReply())
            except BaseException:
                self._end()
                raise

        return WaitForProcedure(begin)

    def adjust_screws(self, screws: Sequence[Place], reply: Reply) -> Wait:
        """Starts a paper test that moves the nozzle over each screw at Z 0. It ends when the user
        has accepted every screw without an adjustment in between. Raises CommandError."""

        def done(_: Sequence[Measured], reply: Reply) -> None:
            reply.say("// All screws are as high as the bed at Z 0")

        return self.start(screws, done, reply=reply, screws=True)

    def _end(self) -> None:
        self._run = None
        self._correction.resume()

    async def _next(self, reply: Reply) -> None:
        run = self._active
        if not run.stays:
            await self._prober.approach(run.places[0])
        run.tried = []
        if run.screws:
            await self._prober.to_height(0.0, _SPEED_MM_S)
            reply.say(f"// Screw {run.places[0].name}, {len(run.found)} of {run.count} accepted")
            reply.say(
                "// ACCEPT if a sheet of paper just moves, ADJUSTED after turning it, or ABORT"
            )
            return
        if run.count > 1:
            place = f"{len(run.found) + 1} of {run.count}"
            reply.say(f"echo:Manual probing point {place}, at {run.places[0]}")
        reply.say("// Starting manual Z probe. Use TESTZ to adjust position.")
        reply.say("// Finish with ACCEPT or ABORT command.")
        self._say(reply)

    def _require(self) -> None:
        if self._run is None:
            raise CommandError.of("probe.manual-idle")

    @property
    def _active(self) -> _Run:
        if self._run is None:
            raise CommandError.of("probe.manual-idle")
        return self._run

    def _say(self, reply: Reply) -> None:
        z = self._prober.z_mm
        below, above = _neighbours(self._active.tried, z)
        texts = ["??????" if mm is None else f"{mm:.3f}" for mm in (below, above)]
        reply.say(f"// Z position: {texts[0]} --> {z:.3f} <-- {texts[1]}")

    @command(
        "TESTZ",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Moves the nozzle in the paper test: by Z=-0.1 or Z=+0.1; Z=- or Z=+ to the middle between"
        " here and the next height that was tried; Z=-- or Z=++ to that.",
        text("Z", "a distance in mm, or +, ++, -, --"),
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _test(self, command: Command, reply: Reply) -> Wait | None:
        self._require()
        given = command.string("Z")
        return WaitForProcedure(lambda: self._move(given, reply))

    async def _move(self, given: str, reply: Reply) -> None:
        run, z = self._active, self._prober.z_mm
        below, above = _neighbours(run.tried, z)
        if given in ("+", "++", "-", "--"):
            found = above if given[0] == "+" else below
            if found is None:
                limit = "a distance: no height was tried there yet"
                raise CommandError.of("command.value", axis="Z", value=given, limit=limit)
            target = found if len(given) == 2 else (z + found) / 2
        else:
            try:
                target = z + float(given)
            except ValueError:
                limit = "a distance in mm, +, ++, - or --"
                raise CommandError.of(
                    "command.value", axis="Z", value=given or "missing", limit=limit
                ) from None
        place = self._prober.place_here()
        low = self._correction.expected(place.x, place.y) - run.lowest_mm
        if not low <= target <= z + self._prober.carried.start_mm:
            limit = f"Z {low:.3f} to {z + self._prober.carried.start_mm:.3f}"
            raise CommandError.of("command.value", axis="Z", value=f"{target:.3f}", limit=limit)
        run.tried.append(z)
        await self._prober.to_height(round(target, 6), _SPEED_MM_S)
        self._say(reply)

    @command(
        "ACCEPT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "The paper just moves: the bed is here, in the paper test.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def accept(self, _: Command, reply: Reply) -> Wait | None:
        """ACCEPT: stores the height, and moves to the next place."""
        self._require()
        return WaitForProcedure(lambda: self._accepted(reply))

    async def _accepted(self, reply: Reply) -> None:
        run, z = self._active, self._prober.z_mm
        place = run.places.pop(0)
        run.found.append(Measured(place, round(z + place.offset_mm, 6), z))
        try:
            run.report(run.found[-1], reply)
            if run.places:
                await self._next(reply)
                return
            await self._prober.clear_bed()
        except BaseException:
            self._end()
            raise
        self._end()
        run.done(run.found, reply)
        if run.then is not None:
            await run.then(run.found, reply)

    @command(
        "ADJUSTED",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "The screw was turned: BED_SCREWS_ADJUST shows the next one, and each other one once more.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _adjusted(self, _: Command, reply: Reply) -> Wait | None:
        if not self._active.screws:
            raise CommandError.of("levelling.no-screw")
        return WaitForProcedure(lambda: self._turned(reply))

    async def _turned(self, reply: Reply) -> None:
        run = self._active
        after = run.screws.index(run.places[0]) + 1
        run.places = [*run.screws[after:], *run.screws[:after]]
        run.found.clear()
        try:
            await self._next(reply)
        except BaseException:
            self._end()
            raise

    @command(
        "ABORT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Ends the paper test; nothing changes.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def abort(self, _: Command, reply: Reply) -> Wait | None:
        """ABORT: lifts the nozzle, and ends the test."""
        self._require()

        async def end() -> None:
            try:
                await self._prober.clear_bed()
            finally:
                self._end()
            reply.say("// Manual probe aborted")

        return WaitForProcedure(end)

    @command(
        "MANUAL_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Starts a paper test where the nozzle is, and reports the height.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _manual(self, _: Command, reply: Reply) -> Wait | None:
        def done(found: Sequence[Measured], reply: Reply) -> None:
            reply.say(f"// Z position is {found[0].height_mm:.3f}")

        x, y = self._prober.nozzle_xy_mm
        return self.start([Place(x, y, "this place", by_nozzle=True)], done, reply=reply)

    @command(
        "PROBE_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Finds the trigger height of the probe: measures the bed where the probe is, then the same"
        " place by the paper test. M500 stores it.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _calibrate(self, _: Command, reply: Reply) -> Wait | None:
        if self._run is not None:
            raise CommandError.of("probe.manual-active")
        place = self._prober.place_here()
        under = Place(place.x, place.y, "the place under the probe", by_nozzle=True)
        self._prober.check([place, under])
        measured: list[float] = []

        def done(found: Sequence[Measured], reply: Reply) -> None:
            before = self._prober.trigger_height_mm
            height = round(measured[0] - found[0].trigger_z_mm, 6)
            self._offsets.set_offsets({"Z": -height})
            reply.say(f"// probe: z_offset: {height:.3f}")
            reply.say(f"// It was {before:.3f}. M500 or SAVE_CONFIG stores it")

        async def calibrate() -> None:
            (found,) = await self._prober.measure([place])
            measured.append(found.trigger_z_mm + self._prober.twisted_mm(place))
            self._correction.suspend()
            self._run = _Run([under], done, lambda _, __: None, 1, [], [])
            try:
                await self._next(reply)
            except BaseException:
                self._end()
                raise

        return WaitForProcedure(calibrate)


def by_hand(command: Command) -> bool:
    """Whether METHOD asks for the paper test."""
    return command.string("METHOD").lower() == "manual"


def _neighbours(tried: Sequence[float], z: float) -> tuple[float | None, float | None]:
    """The nearest heights that were tried, below and above."""
    below = max((mm for mm in tried if mm < z), default=None)
    above = min((mm for mm in tried if mm > z), default=None)
    return below, above
