"""Commands that a print must not skip silently: unknown ones that may move the machine, and bed
levelling on a machine that cannot level."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from passo.errors import Problem
from passo.gcode.command import Command
from passo.gcode.registry import row_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

# G codes that move the machine in other dialects, or change the path of later moves: splines,
# pockets, patterns, threads, calibration, probing, radius compensation, scaling, rotation, macros,
# cycles.
_MOVES = {5, 6, 13, 16, 26, 33, *range(35, 40), 41, 42, 46, 47, 51, 52, 65, 66, 68, 150, 425} | {
    *range(70, 80),
    *range(81, 90),
}
_CALLS = {96, 97, 98}  # M codes that call a sub-program
PROBING = frozenset({"G29", "G32", "G80", "BED_MESH_CALIBRATE", "BED_TILT_CALIBRATE"})
PROBE_MOVES = frozenset({"G38.2", "G38.3", "G38.4", "G38.5"})
OF_DELTAS = frozenset({"G33", "DELTA_CALIBRATE", "DELTA_ANALYZE"})
BY_HAND = frozenset({"DELTA_CALIBRATE", "DELTA_ANALYZE"})  # by the paper test, without a probe
OF_Z_MOTORS = frozenset({"G34", "Z_TILT_ADJUST", "QUAD_GANTRY_LEVEL"})
LEVELLING = PROBING | OF_DELTAS | OF_Z_MOTORS
# Klipper's commands and common macros of its users that neither move the machine nor change a
# position.
_STILL = re.compile(
    r"(?!SET_(?:GCODE_OFFSET|KINEMATIC_POSITION|DUAL_CARRIAGE)\b)"
    r"(?:SET_|GET_|QUERY_|DUMP_|SAVE_|CLEAR_|DISPLAY_|_?TIMELAPSE|BED_MESH_|SKEW_|UPDATE_DELAYED"
    r"|RESPOND\b|ECHO\b|STATUS\b|HELP\b|TUNING_TOWER\b|TEMPERATURE_WAIT\b|TURN_OFF_HEATERS\b)"
)
_MACRO = re.compile(r"[A-Z_][A-Z_][A-Z0-9_.]+\Z")  # the form of Klipper's own command names
_FLOW_OF_CONTROL = re.compile(
    r"\s*(?:sub|endsub|call|return|if|elseif|else|endif|while|endwhile|do|repeat|endrepeat"
    r"|break|continue)\b",
    re.IGNORECASE,
)


# The field of Skips that allows what an error of the catalogue refuses.
ALLOWED_BY = {
    "input.out-of-range": "clamp",
    "input.unreachable": "clamp",
    "input.actuator": "clamp",
    "input.missing-tool": "ignore_tools",
    "input.unknown-moves": "unknown",
    "input.no-macro": "unknown",
    "input.call": "unknown",
    "input.no-levelling": "levelling",
}


class Skips(NamedTuple):
    """What a print may do in place of a failure: skip unknown commands and bed levelling, move
    targets beyond the machine's limits to the limit (`clamp`), and keep the current tool where a
    tool is missing (`ignore_tools`). `levels` are the levelling commands that the machine
    supports."""

    unknown: bool = False
    levelling: bool = False
    clamp: bool = False
    ignore_tools: bool = False
    levels: frozenset[str] = frozenset()

    @property
    def allowed(self) -> list[str]:
        """The names of the fields that are True."""
        return [name for name in dict.fromkeys(ALLOWED_BY.values()) if getattr(self, name)]

    def allowing(self, names: Iterable[str]) -> Skips:
        """The same with these fields True as well."""
        return self._replace(**dict.fromkeys(names, True))

    def on(self, machine: MachineConfig) -> Skips:
        """The same options for this machine."""
        of_delta = OF_DELTAS if machine.geometry.kind == "delta" else frozenset[str]()
        if machine.probe is None:
            return self._replace(levels=of_delta & BY_HAND)
        of_motors = OF_Z_MOTORS if machine.levelling.motors else frozenset[str]()
        return self._replace(levels=PROBING | PROBE_MOVES | of_delta | of_motors)


def plain_advice(problem: Problem) -> str:
    """What to do next, for clients that offer by themselves what would allow the print: without the
    option of the command line, or the command of a console."""
    return problem.entry.action if problem.code in ALLOWED_BY else problem.advice


NOTHING = Skips()
ALL = Skips(unknown=True, levelling=True)


def unfit(command: Command, skips: Skips) -> Problem | None:
    """The problem that forbids to skip this command; None if it is known, harmless or allowed to be
    skipped."""
    code = command.code
    if code in LEVELLING:
        if skips.levelling or code in skips.levels:
            return None
        values = {"value": code, "limit": _lack(code, skips)}
        return Problem("input.no-levelling", line=command.line, values=values)
    known = row_of(code) is not None and code not in PROBE_MOVES - skips.levels
    if skips.unknown or known or not _may_move(command):
        return None
    unknown = "input.no-macro" if _MACRO.match(command.name) else "input.unknown-moves"
    values = {"value": code, "text": command.text.strip()}
    return Problem(unknown, line=command.line, values=values)


def _lack(code: str, skips: Skips) -> str:
    """What the machine has instead of what the levelling command needs."""
    if not skips.levels & PROBING:
        return "no probe"
    if code in OF_DELTAS:
        return "no towers of a delta"
    return "no [levelling.motors]" if code in OF_Z_MOTORS else "G29 and G32 for that"


def _may_move(command: Command) -> bool:
    """Whether an unknown command moves the machine, or changes its path, on other firmware."""
    name = command.name
    if command.letter == "G":
        return command.number in _MOVES
    if command.letter == "M":
        return command.number in _CALLS
    if re.fullmatch(r"O\d+", name):
        return _FLOW_OF_CONTROL.match(command.text) is not None
    return _MACRO.match(name) is not None and _STILL.match(name) is None
