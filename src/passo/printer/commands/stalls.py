"""The thresholds of stall detection: M914, M915, and STALL_CALIBRATE, which finds one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from passo.board.trinamic.stall import stall_threshold
from passo.config.stalls import STALL_KINDS, threshold_range, watched_motors
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import axes, ignored, integer, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.stall_trials import StallTrials, Thresholds
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.homing import Homer
    from passo.printer.watch.driver_status import DriverWatch

NO_STALLS = "No axis of this machine homes by stall detection."


class StallCommands:
    """M914, M915 and STALL_CALIBRATE of one printer. The threshold of an axis is that of the first
    of its motors that its homing watches."""

    def __init__(self, machine: MachineConfig, watch: DriverWatch, homer: Homer) -> None:
        self._machine, self._watch, self._homer = machine, watch, homer

    @property
    def _motors(self) -> dict[str, list[str]]:
        """The watched motors of each axis that homes by a stall."""
        homing = self._machine.homing
        return {n: watched_motors(self._machine, n) for n, h in homing.items() if h.stall}

    def threshold(self, home: str) -> int:
        """The present threshold of an axis."""
        return stall_threshold(self._watch.states[self._motors[home][0]].settings)

    def use(self, home: str, threshold: int) -> None:
        """Sets the threshold of an axis."""
        for motor in self._motors[home]:
            settings = self._watch.states[motor].settings
            field = STALL_KINDS[settings.chip].field
            fields = {**settings.fields, field: threshold}
            self._watch.set(motor, replace(settings, fields=fields))

    def _range(self, home: str) -> tuple[int, int]:
        return threshold_range(self._watch.states[self._motors[home][0]].settings.chip)

    def _home(self, name: str, letter: str) -> str:
        """The axis of this name. Raises CommandError."""
        if name.lower() in self._motors:
            return name.lower()
        limit = f"an axis that homes by a stall: {', '.join(self._motors).upper() or 'none does'}"
        raise CommandError.of("command.value", axis=letter, value=name or "missing", limit=limit)

    @command(
        "M914",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the threshold with which an axis homes by the stall of its motor: SGTHRS, where a"
        " high value stops early, or SGT, where a low value stops early. Without parameters it"
        " reports them.",
        axes("X Y Z", "the threshold", "", -64, 255, but="I"),
        integer("I", "which motor of the axis; all of them have the same threshold", 0),
        kind=Kind.SERVED,
        lacks=NO_STALLS,
    )
    def _thresholds(self, command: Command, reply: Reply) -> Wait | None:
        words = {k: v for k, v in command.words().items() if k != "I"}
        if not words:
            for home in self._motors:
                reply.say(f"{home.upper()} homing sensitivity: {self.threshold(home)}")
            return None
        self._use([(x, self._home(x, "M914"), value) for x, value in words.items()])
        return None

    @command(
        "M915",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the threshold of homing by stalls as M914, with S for the axes that are named.",
        axes("X Y Z", "the axis", alone=True, but="SFHTR"),
        integer("S", "the threshold", -64, 255),
        integer("R", "what a stall does in a print: only 0, nothing", 0, 0),
        ignored("F H T"),
        kind=Kind.SERVED,
        lacks=NO_STALLS,
    )
    def _sensitivity(self, command: Command, reply: Reply) -> Wait | None:
        homes = {x: self._home(x, "M915") for x in command.letters() if x not in "SRFHT"}
        if not command.has("S"):
            for home in homes.values() or self._motors:
                reply.say(f"{home.upper()}: stall threshold {self.threshold(home)}")
            return None
        self._use([("S", home, command.value("S")) for home in homes.values()])
        return None

    def _use(self, wanted: list[tuple[str, str, float]]) -> None:
        for letter, home, value in wanted:
            least, most = self._range(home)
            if value != int(value) or not least <= value <= most:
                raise CommandError.bad_value(letter, value, f"a whole number, {least} to {most}")
        for _, home, value in wanted:
            self.use(home, int(value))

    @command(
        "STALL_CALIBRATE",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Finds the threshold with which an axis homes by the stall of its motor, homes with it, and"
        " reports how exactly. Before, move the axis to the middle of its travel by hand.",
        text("AXIS", "the axis", required=True),
        integer("REPEATS", "how often it homes to measure how exactly", 2, 20, default=5),
        kind=Kind.SERVED,
        lacks=NO_STALLS,
    )
    def _calibrate(self, command: Command, reply: Reply) -> Wait:
        home = self._home(command.string("AXIS"), "AXIS")
        return WaitForProcedure(partial(self._find, home, command.integer("REPEATS"), reply))

    async def _find(self, home: str, repeats: int, reply: Reply) -> None:
        before, (least, most) = self.threshold(home), self._range(home)
        motor = self._motors[home][0]
        rising = STALL_KINDS[self._watch.states[motor].settings.chip].silent
        trials = StallTrials(
            *(self._homer, home, Thresholds(least, most, rising)),
            *(partial(self.use, home), reply.say),
        )
        chosen = before
        try:
            chosen = await trials.find()
            self.use(home, chosen)
            spread = await trials.spread(repeats)
        except BaseException:
            self.use(home, before)
            raise
        unit = "degrees" if home in self._machine.geometry.rotary else "mm"
        reply.say(
            f"{home.upper()}: threshold {chosen} in place of {before}; {repeats} times it stopped"
            f" within {spread:.3f} {unit}. Save it with M500 or SAVE_CONFIG"
        )

    def setting_lines(self) -> Iterator[str]:
        """M914 for each axis."""
        for home in self._motors:
            yield f"M914 {home.upper()}{numeral(self.threshold(home))}"
