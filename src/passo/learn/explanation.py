"""The explanation of one line of a file, as data, and as the text of `passo explain`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from passo.config.pin_names import MAIN

_MAX_WIRE = 12  # maximum commands in the text
MAX_MACRO_LINES = 40  # maximum lines of macros in the text


@dataclass(frozen=True, slots=True)
class ExplainedCommand:
    """A command of the line: its effect, and its words as read by the lexer. `code` is empty for a
    move without a G."""

    code: str
    text: str
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ExplainedMacro:
    """The call of a macro, and the lines to which it was expanded."""

    call: str
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ExplainedMove:
    """A planned move: lengths in `unit`, mm or degrees; speeds in units/s, accelerations in
    units/s², times in seconds. `start_s` and `end_s` are print times. `start_mm` and `end_mm` are
    positions of X, Y, Z and E. The `kind` of a wait is `dwell`. `shape` is trapezoid, triangle or
    constant speed. `tolerance_us` is the maximum error of the step times, which is larger where the
    board's budget requires it."""

    kind: str
    unit: str
    length: float
    start_mm: tuple[float, ...]
    end_mm: tuple[float, ...]
    shape: str
    start_speed: float
    cruise_speed: float
    speed_cap: float
    end_speed: float
    accelerate_length: float
    accelerate_s: float
    cruise_length: float
    cruise_s: float
    decelerate_length: float
    decelerate_s: float
    start_s: float
    end_s: float
    speed_limit: str
    acceleration: float
    accel_limit: str
    tolerance_us: float


@dataclass(frozen=True, slots=True)
class ExplainedSteps:
    """The executed steps of a motor, with the print times of the first and the last step."""

    motor: str
    count: int
    first_s: float | None
    last_s: float | None


@dataclass(frozen=True, slots=True)
class WireCommand:
    """A command on the link: its text, and its bytes in hexadecimal digits."""

    board: str
    motor: str
    text: str
    payload: str


@dataclass(frozen=True, slots=True)
class Explanation:
    """The explanation of one line. `number` is its line number (N), empty without one; `checksum`:
    it has a checksum.

    `planned` is the number of planned moves; `moves` has all of them, or the first and the last.
    `junction_before` and `junction_after` describe the limit of the speed before and after the
    moves; both are empty for a line without moves. `filters` describe the effects of the motion
    filters. `sub_program`: the line calls a sub-program, whose lines contain the moves. `wire` has
    the commands for boards with recorded bytes; `frame` is a frame with the first command.
    `tick_ns` is the length of a clock tick, by board; the name of the main board is empty.
    `unseen`: commands for other boards are missing in `wire`.
    """

    place: str
    line: str
    number: str
    checksum: bool
    commands: tuple[ExplainedCommand, ...]
    macros: tuple[ExplainedMacro, ...] = ()
    planned: int = 0
    moves: tuple[ExplainedMove, ...] = ()
    junction_before: str = ""
    junction_after: str = ""
    filters: tuple[str, ...] = ()
    sub_program: bool = False
    steps: tuple[ExplainedSteps, ...] = ()
    wire: tuple[WireCommand, ...] = ()
    frame: str = ""
    tick_ns: dict[str, float] | None = None
    unseen: bool = False


def explanation_text(explanation: Explanation) -> str:
    """The text of `passo explain`."""
    parts = [f"{explanation.place}: {explanation.line}", _commands(explanation)]
    if explanation.macros:
        parts.append(_macros(explanation.macros))
    if not explanation.planned:
        parts.append(
            "The lines of the sub-program move; explain one of them."
            if explanation.sub_program
            else "This line moves nothing, so there is no plan and no step of its own."
        )
        return "\n\n".join(parts)
    if len(explanation.moves) < explanation.planned:
        parts.append(
            f"The line became {explanation.planned} planned moves; the first and the last:"
        )
    parts += [_move(move) for move in explanation.moves]
    parts.append(f"Junction before: {explanation.junction_before}.")
    parts.append(f"Junction after: {explanation.junction_after}.")
    if explanation.filters:
        parts.append(
            "\n".join(("Filters between plan and steps:", *(f"  {x}" for x in explanation.filters)))
        )
    parts.append(_steps(explanation.steps))
    if explanation.wire or not explanation.unseen:
        parts.append(_wire(explanation))
    if explanation.unseen:
        parts.append(
            "The commands for a simulated board with Passo's firmware are not shown;"
            ' with firmware = "virtual" they are.'
        )
    return "\n\n".join(parts)


def _commands(explanation: Explanation) -> str:
    rows: list[str] = []
    if explanation.number:
        sum_ = "; its checksum is right" if explanation.checksum else ""
        rows.append(f"The line has the number {explanation.number}, which is skipped{sum_}.")
    if not explanation.commands:
        rows.append("There is no command on this line.")
    for command in explanation.commands:
        rows.append(f"{command.code}: {command.text}" if command.code else command.text)
        rows += [f"  {word}" for word in command.words]
    return "\n".join(rows)


def _macros(macros: Sequence[ExplainedMacro]) -> str:
    """The non-empty lines of macros and of the macros that they call."""
    rows: list[str] = []
    for macro in macros:
        rows.append(f"{macro.call} became:")
        rows += [f"  {line}" for line in macro.lines]
    if len(rows) > MAX_MACRO_LINES:
        rows[MAX_MACRO_LINES:] = [f"and {len(rows) - MAX_MACRO_LINES} more lines"]
    return "\n".join(rows)


def _move(move: ExplainedMove) -> str:
    if move.kind == "dwell":
        return f"Planned: the machine waits {move.cruise_s:.3f} s."
    unit = move.unit
    start, end = (
        ", ".join(f"{a} {p[i]:.3f}" for i, a in enumerate("XYZE"))
        for p in (move.start_mm, move.end_mm)
    )
    wide = f"  its steps may miss their ideal times by {move.tolerance_us:.1f} µs"
    return "\n".join(
        (
            f"Planned: a {move.kind} move of {move.length:.3f} {unit}, from {start} to {end}",
            f"  {move.shape}: starts at {move.start_speed:.2f} {unit}/s, reaches"
            f" {move.cruise_speed:.2f} (at most {move.speed_cap:.2f}), ends at"
            f" {move.end_speed:.2f}",
            f"  speeds up over {move.accelerate_length:.3f} {unit}"
            f" in {move.accelerate_s * 1e3:.2f} ms"
            f", cruises {move.cruise_length:.3f} {unit} in {move.cruise_s * 1e3:.2f} ms"
            f", slows down over {move.decelerate_length:.3f} {unit}"
            f" in {move.decelerate_s * 1e3:.2f} ms",
            f"  from {move.start_s:.6f} s to {move.end_s:.6f} s of print time",
            f"  speed is bound by: {move.speed_limit}"
            f"; acceleration {abs(move.acceleration):.0f} {unit}/s² by: {move.accel_limit}",
            *([wide + ": the board's budget of commands"] if move.tolerance_us > 0 else []),
        )
    )


def _steps(steps: Sequence[ExplainedSteps]) -> str:
    rows = ["Steps, as the board executed them (print time):"]
    for one in steps:
        rows.append(
            f"  {one.motor}: {one.count}, the first at {one.first_s:.6f} s,"
            f" the last at {one.last_s:.6f} s"
            if one.count
            else f"  {one.motor}: none"
        )
    return "\n".join(rows)


def _wire(explanation: Explanation) -> str:
    if not explanation.wire:
        return "On the wire: nothing of this line."
    ticks = [
        f"{ns:.1f} ns{f' on {name}' * (name != MAIN)}"
        for name, ns in (explanation.tick_ns or {}).items()
    ]
    rows = [
        "On the wire: an interval is the ticks to the first step, `count` the steps, `add` what",
        f"the interval grows by after each; a tick is {', '.join(ticks)}. "
        f"{len(explanation.wire)} commands:",
    ]
    for command in explanation.wire[:_MAX_WIRE]:
        where = f"{command.board}: " * (command.board != MAIN)
        rows.append(f"  {command.payload:<30} {where}{command.motor}: {command.text}")
    if len(explanation.wire) > _MAX_WIRE:
        rows.append(f"  and {len(explanation.wire) - _MAX_WIRE} more")
    rows.append("A frame with the first of them alone (length, sequence, payload, CRC, 7e):")
    rows.append(f"  {explanation.frame}")
    return "\n".join(rows)
