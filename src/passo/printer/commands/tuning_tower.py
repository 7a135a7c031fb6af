"""TUNING_TOWER: a value that grows with the height of a print."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import floor, inf
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import ignored, number, text
from passo.gcode.registry import Subject, When, command

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.wait_requests import Reply

_END_MM = 2.0  # lower than before by this: another print has begun
_SAME_MM = 1e-6  # heights of one layer may differ by this
_FINEST_MM = 0.01  # without bands a value changes after this rise at most
_NUMBERED = re.compile(r"([GM])(\d+)(?:\.(\d+))?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Tower:
    """The command and its parameter that a tower varies, and how the value depends on the height,
    mm."""

    command: str
    parameter: str
    start: float
    factor: float
    band_mm: float
    step: float
    step_mm: float
    skip_mm: float

    def value(self, z_mm: float) -> float:
        """The value at this height of the print."""
        height = max(0.0, z_mm - self.skip_mm)
        if self.step_mm:
            return self.start + self.step * _part(height, self.step_mm)
        if self.band_mm:
            height = (_part(height, self.band_mm) + 0.5) * self.band_mm
        return self.start + self.factor * height

    def up_to(self, z_mm: float) -> float:
        """The height, mm, up to which the value is the same as at `z_mm`."""
        size = self.step_mm or self.band_mm
        if not size:
            return z_mm + _FINEST_MM
        height = max(0.0, z_mm - self.skip_mm)
        return self.skip_mm + (_part(height, size) + 1) * size - 2 * _SAME_MM

    def line(self, line: int, z_mm: float) -> Command:
        """The command that sets the value for this height."""
        code, _, words = self.command.partition(" ")
        text = numeral(self.value(z_mm))
        numbered = _NUMBERED.fullmatch(code)
        if numbered is None:
            words = f"{words} {self.parameter}={text}".strip()
            return Command(line, "", 0, 0, code.upper(), words)
        letter, number, minor = numbered.groups()
        words = f"{words} {self.parameter}{text}".strip()
        return Command(line, letter.upper(), int(number), int(minor or 0), "", words)


class TuningTower:
    """The tower of one job. `due` is the command that sets the value for the current height of the
    print; the caller executes it."""

    def __init__(self, machine: MachineConfig, job: _core.Job) -> None:
        self._job = job
        self._tower: Tower | None = None
        self._last_mm = -inf
        self.due: Command | None = None

    @command(
        "TUNING_TOWER",
        Subject.SPEED,
        When.PLANNED,
        "Sets a value by the height of the print: COMMAND with PARAMETER and START + FACTOR * Z,"
        " in bands of BAND mm, or START + STEP_DELTA for each STEP_HEIGHT mm, from SKIP mm on. It"
        " ends without parameters, and where the print begins again lower down.",
        text("COMMAND", "the command that sets the value"),
        text("PARAMETER", "its letter or key"),
        number("START", "the value at the bottom", default=0),
        number("FACTOR", "the change of the value", "per mm", default=0),
        number("BAND", "the height of a band", "mm", 0, default=0),
        number("STEP_DELTA", "the change with each step", default=0),
        number("STEP_HEIGHT", "the height of a step", "mm", 0, default=0),
        number("SKIP", "the height at which it begins", "mm", 0, default=0),
        ignored("Z"),
    )
    def _start(self, command: Command, reply: Reply) -> None:
        pairs = command.pairs()
        if pairs.keys() == {"Z"}:
            self._reach(command.line, command.value("Z"), reply)
            return
        self._tower = tower_of(command) if pairs else None
        self._last_mm = -inf
        if self._tower is None:
            self._job.program.watch_height(-inf, inf)
            reply.say("Ending tuning test")
            return
        self._job.program.watch_height(inf, inf)
        given = ("START", "FACTOR", "BAND", "STEP_DELTA", "STEP_HEIGHT", "SKIP")
        values = [f"{key.lower()}={command.value(key):.6f}" for key in given if key in pairs]
        reply.say(f"Starting tuning test ({' '.join(values)})")

    def _reach(self, line: int, z_mm: float, reply: Reply) -> None:
        """The next move prints at this height."""
        if self._tower is None:
            return
        if z_mm < self._last_mm - _END_MM:
            self._tower = None
            reply.say("Ending tuning test")
            return
        self._last_mm = z_mm
        self.due = self._tower.line(line, z_mm)
        self._job.program.watch_height(z_mm - _SAME_MM, self._tower.up_to(z_mm))


def tower_of(command: Command) -> Tower:
    """The tower that the parameters describe. Raises CommandError."""
    for key in ("COMMAND", "PARAMETER"):
        if not command.string(key):
            raise CommandError.of("command.value", axis=key, value="missing", limit="a text")
    keys = "START", "FACTOR", "BAND", "STEP_DELTA", "STEP_HEIGHT", "SKIP"
    numbers = (command.value(key) for key in keys)
    tower = Tower(command.string("COMMAND"), command.string("PARAMETER"), *numbers)
    by_steps, by_factor = tower.step != 0 and tower.step_mm != 0, tower.factor != 0
    if by_steps == by_factor:
        limit = "FACTOR, or both STEP_DELTA and STEP_HEIGHT, not 0"
        shown = "both" if by_steps else "missing"
        raise CommandError.of("command.value", axis="FACTOR", value=shown, limit=limit)
    if tower.command.split(maxsplit=1)[0].upper() == "TUNING_TOWER":
        raise CommandError.of(
            "command.value", axis="COMMAND", value="TUNING_TOWER", limit="another command"
        )
    return tower


def _part(height_mm: float, size_mm: float) -> int:
    return floor((height_mm + _SAME_MM) / size_mm)
