"""The error catalogue: what may go wrong, said once, the same on every console, page and log.

An entry names the part of Passo or of the printer that it concerns, the sentence (with the measured
value and the limit in it), the next action for the person who reads it, and the exit status.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any


class ExitStatus(IntEnum):
    """What the `passo` command returns to the shell."""

    DONE = 0
    USAGE = 2
    BAD_CONFIG = 3
    BAD_INPUT = 4
    MACHINE_FAULT = 5


@dataclass(frozen=True, slots=True)
class Entry:
    """One row of the catalogue; `says` is a format string over a problem's values."""

    part: str
    says: str
    action: str
    status: ExitStatus


def _config(says: str, action: str) -> Entry:
    return Entry("config", says, action, ExitStatus.BAD_CONFIG)


def _input(part: str, says: str, action: str) -> Entry:
    return Entry(part, says, action, ExitStatus.BAD_INPUT)


def _heat(says: str, action: str) -> Entry:
    return Entry("heat", says, f"{action}, then rearm it", ExitStatus.MACHINE_FAULT)


CATALOGUE: Mapping[str, Entry] = {
    "config.unknown-machine": _config(
        "there is no machine called {value!r}",
        "Name a shipped machine (see `passo machines`) or the path of a TOML file",
    ),
    "config.unreadable": _config("cannot be read: {value}", "Check the path and its permissions"),
    "config.syntax": _config("is not valid TOML: {value}", "Mend the syntax at this place"),
    "config.unknown-key": _config("{key} is not a known key", "Remove it or correct its name"),
    "config.missing-key": _config("{key} is missing: expected {limit}", "Add the key"),
    "config.value": _config("{key} is {value!r}: expected {limit}", "Correct the value"),
    "config.conflict": _config("{key} is {value!r}: expected {limit}", "Change or remove it"),
    "input.unreadable": _input("file", "cannot be read: {value}", "Check the path and permissions"),
    "input.empty": _input("file", "holds no command", "Slice the model again"),
    "input.garbage": _input(
        "gcode", "is not G-code: {value}", "Give a sliced text file, not a model or a binary"
    ),
    "input.number": _input(
        "gcode",
        "the word {value!r} has no valid number",
        "Write a decimal number of at most 1e9 without exponent",
    ),
    "input.out-of-range": _input(
        "motion",
        "{axis} {value:.3f} mm is beyond the limit of {limit:.3f} mm",
        "Move the model on the bed, choose the right machine, or allow --out-of-range clamp",
    ),
    "input.unreachable": _input(
        "geometry",
        "the point {value} mm cannot be reached by this machine",
        "Move the model on the bed, choose the right machine, or allow --out-of-range clamp",
    ),
    "input.actuator": _input(
        "geometry",
        "motor {axis} would go to {value:.3f}, beyond its limit of {limit:.3f}",
        "Move the model on the bed, choose the right machine, or allow --out-of-range clamp",
    ),
    "input.feedrate": _input(
        "gcode", "the feed rate F{value:g} must be above 0", "Give the speed in mm per minute"
    ),
    "input.arc": _input(
        "gcode",
        "the arc has no circle: {value} does not fit its end",
        "Give I and J, or an R of at least half the distance",
    ),
    "input.checksum": _input(
        "gcode",
        "the checksum {value} is wrong: the line's is *{limit}",
        "Send the line again",
    ),
    "input.no-line": _input(
        "file", "there is no line {value}: the file has {limit}", "Name a line of the file"
    ),
    "input.point": _input(
        "heat",
        "{value!r} is no pair of temperatures from 0 to 400 °C",
        "Write the shown and the true temperature as 200:187",
    ),
    "input.missing-tool": _input(
        "printer",
        "tool T{value} does not exist: the machine has {limit} tool(s)",
        "Choose a machine with this tool, or allow --missing-tool ignore",
    ),
    "output.unwritable": _input(
        "file", "cannot be written: {value}", "Check the path, its permissions and the free space"
    ),
    "console.unopened": Entry(
        "console",
        "{axis} cannot be opened: {value}",
        "Check the name, its permissions, and that nobody else has it",
        ExitStatus.USAGE,
    ),
    "machine.slow-heater": Entry(
        "heat",
        "heater {axis} has reached only {value:.1f} °C of {limit:.1f} °C in an hour",
        "Check its cartridge, its supply and its sensor's place",
        ExitStatus.MACHINE_FAULT,
    ),
    "heat.sensor-open": _heat(
        "heater {axis} was switched off: its sensor is open, it says {value:.1f} °C where at least"
        " {limit:.1f} °C is possible",
        "Check the sensor's plug and wires",
    ),
    "heat.sensor-short": _heat(
        "heater {axis} was switched off: its sensor is short-circuited, it says {value:.1f} °C"
        " where at most {limit:.1f} °C is allowed",
        "Check the sensor's wires where they may touch",
    ),
    "heat.sensor-erratic": _heat(
        "heater {axis} was switched off: its sensor, at {value:.1f} °C now, keeps jumping by more"
        " than {limit:.1f} °C",
        "Check the sensor's plug and wires where they move",
    ),
    "heat.min-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, below its least {limit:.1f} °C",
        "Check the sensor, and that the room is not too cold",
    ),
    "heat.max-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, above its limit of {limit:.1f}"
        " °C",
        "Let it cool, and check its sensor and its control",
    ),
    "heat.heating-failed": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C and did not come to {limit:.1f} °C"
        " in time",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.runaway": _heat(
        "heater {axis} was switched off: it fell to {value:.1f} °C and stayed below {limit:.1f} °C",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.stuck-on": _heat(
        "heater {axis} gets hotter without power: it is at {value:.1f} °C, above {limit:.1f} °C",
        "Cut its supply at once: its switch may be broken",
    ),
    "heat.model-deviation": _heat(
        "heater {axis} was switched off: at {value:.1f} °C it does not behave as its model, by more"
        " than {limit:.2f} of full power",
        "Check cartridge, sensor and fan, or tune its model again",
    ),
    "machine.shutdown": Entry(
        "board",
        "the board shut down: {value}",
        "Read the cause, make the printer safe, and start again",
        ExitStatus.MACHINE_FAULT,
    ),
}


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong: a code of the catalogue, where it stands, and its values."""

    code: str
    file: str = ""
    line: int | None = None
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    hint: str = ""

    @property
    def entry(self) -> Entry:
        return CATALOGUE[self.code]

    @property
    def place(self) -> str:
        """`file:line`, as editors understand it; empty where there is no file."""
        return self.file if self.line is None else f"{self.file}:{self.line}"

    def __str__(self) -> str:
        """One line: place, sentence, hint or next action."""
        sentence = self.entry.says.format_map(self.values)
        head = f"{self.place}: " if self.place else ""
        advice = self.hint or self.entry.action
        return f"{head}{sentence}. {advice}{'' if advice.endswith('?') else '.'}"

    def as_dict(self) -> dict[str, Any]:
        """The problem for `--json`: code, part, message, file, line, values, action."""
        return {
            "code": self.code,
            "part": self.entry.part,
            "message": str(self),
            "file": self.file,
            "line": self.line,
            "values": dict(self.values),
            "action": self.hint or self.entry.action,
        }


class PassoError(Exception):
    """Raised for what a person must mend; carries every problem that was found, not only the first.

    `status` is what the command line returns.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        if not problems:
            raise ValueError("an error needs at least one problem")
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = tuple(problems)
        self.status = problems[0].entry.status


class ConfigError(PassoError):
    """A machine file or its name is wrong."""


class InputError(PassoError):
    """A G-code file is unreadable, garbage, or asks for what the machine cannot do."""


class MachineError(PassoError):
    """The printer or its board failed."""
