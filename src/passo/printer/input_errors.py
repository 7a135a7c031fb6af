"""Converts errors of the interpreter to problems of the catalogue."""

from __future__ import annotations

from math import inf

from passo import _core
from passo.errors import Problem
from passo.gcode.command import written
from passo.gcode.stray import stray_problem
from passo.geometry.base import GeometryModel, Point

Error = tuple[int, _core.Fault, str, float, float, Point]  # an error in the form of the core


def problem_of(job: _core.Job, path: str, geometry: GeometryModel) -> Problem:
    """The error that stopped `job.advance`, as a problem of the catalogue."""
    return problem(job.error, path, geometry)


def problem(error: Error, path: str, geometry: GeometryModel) -> Problem:
    """An error of a job on a machine of this geometry, as a problem of the catalogue."""
    line, fault, word, value, limit, point = error
    faults = _core.Fault
    if fault == faults.OUT_OF_RANGE:
        return Problem("input.out-of-range", path, line, _beyond(word.upper(), value, limit))
    if fault == faults.ACTUATOR:
        unit = " degrees" if word in geometry.rotary else " mm"
        return Problem("input.actuator", path, line, _beyond(word, value, limit) | {"unit": unit})
    if fault == faults.TOO_LONG:
        return Problem("input.too-long", path, line, {"axis": word, "value": value, "limit": limit})
    if fault == faults.TOO_SLOW:
        return Problem("input.too-slow", path, line, {"axis": word, "value": value, "limit": limit})
    if fault == faults.UNREACHABLE:
        where = ", ".join(f"{letter} {x:.3f}" for letter, x in zip("XYZ", point, strict=True))
        values = {"value": where, "limit": geometry.why_not(point)}
        return Problem("input.unreachable", path, line, values)
    if fault == faults.NOT_HOMED:
        return Problem("input.not-homed", path, line, {"axis": word.upper()})
    if fault == faults.UNSAVED:
        return Problem("input.unsaved", path, line, {"value": f"S{value:g}"})
    if fault == faults.COLD:
        return Problem("input.cold", path, line)
    if fault == faults.MISSING_TOOL:
        return Problem("input.missing-tool", path, line, {"value": int(value), "limit": int(limit)})
    if fault == faults.NUMBER:
        return Problem(
            "input.number", path, line, {"value": word + (written(value) if value else "")}
        )
    if fault == faults.RANGE:
        limit = f"{point[0]:g} to {limit:g}" if limit < inf else f"at least {point[0]:g}"
        values = {"axis": word, "value": f"{value:g}", "limit": limit}
        return Problem("command.value", path, line, values)
    if fault == faults.MISSING_WORD:
        command, lacking = word.split(" ", 1)
        return Problem("input.missing-word", path, line, {"axis": command, "value": lacking})
    if fault == faults.CALL:
        return call_problem(line, word, _core.CallFault(int(value)), path)
    if fault == faults.FEEDRATE:
        return Problem("input.feedrate", path, line, {"value": value})
    if fault == faults.ARC:
        return Problem("input.arc", path, line, {"value": word})
    if fault == faults.CENTRE:
        return Problem("input.centre", path, line, {"value": word})
    if fault == faults.RADII:
        return Problem("input.radii", path, line, {"value": value, "limit": limit})
    if fault == faults.LETTER:
        command, letter, *axes = word.split()
        values = {"axis": command, "value": letter, "limit": ", ".join(axes)}
        return Problem("input.letter", path, line, values)
    if fault == faults.REPEATED:
        return Problem("input.repeated", path, line, {"value": word})
    if fault == faults.CHECKSUM:
        return Problem("input.checksum", path, line, {"value": word, "limit": int(value)})
    if fault == faults.LINE_TOO_LONG:
        return Problem("input.garbage", path, line, {"value": "a line is longer than 64 KiB"})
    if fault == faults.STRAY:
        return stray_problem(word, int(value), path, line)
    if fault == faults.UTF_16:
        return Problem("input.utf-16", path, line)
    if fault in (faults.HOLE, faults.AFTER_END):
        code = "input.hole" if fault == faults.HOLE else "input.after-end"
        return Problem(code, path, line, {"value": int(value)})
    if fault == faults.WORD:
        return Problem("input.garbage", path, line, {"value": f"{word!r} is no command"})
    return Problem("input.garbage", path, line, {"value": "it holds bytes that are not text"})


_CALLS = {  # reasons why a call fails
    _core.CallFault.UNREADABLE: "expected a number P, and at most 9999 repeats L",
    _core.CallFault.MISSING: "the file has no such O number after the end of its main program",
    _core.CallFault.NESTED: "10 sub-programs are under way within each other already",
    _core.CallFault.UNENDED: "no M99 ends the sub-program",
    _core.CallFault.IDLE: "it repeats 100,000 calls without a move",
    _core.CallFault.NO_FILE: "sub-programs are read from a file alone, of at most 16 MiB of them",
}


def call_problem(line: int, call: str, fault: _core.CallFault, path: str = "") -> Problem:
    """The problem of a failed M98 or M99; `call` is the command as written."""
    return Problem("input.call", path, line, {"axis": call, "value": _CALLS[fault]})


def _beyond(axis: str, value: float, limit: float) -> dict[str, str | float]:
    """The value and the limit of a problem, with enough decimals to distinguish them."""
    decimals = next((d for d in range(3, 9) if round(value, d) != round(limit, d)), 9)
    return {"axis": axis, "value": value, "limit": limit, "decimals": decimals}
