"""Reports commands that reach the board only shortly before they are due, with the cause."""

from __future__ import annotations

from passo import _core
from passo.board.connection import Connection
from passo.errors import Problem

LATE_S = _core.LATE_S
_NAMES = {
    _core.Cause.PLAN: "planned late",
    _core.Cause.STALL: "stalls",
    _core.Cause.BYTES: "link full",
    _core.Cause.RETRANSMITS: "sent again",
    _core.Cause.SLOTS: "no slot",
}


def is_late(connection: Connection, slack: _core.Slack) -> bool:
    """Whether the smallest slack, in ticks, is less than `LATE_S`."""
    return slack.known and slack.slack < LATE_S * connection.board.clock_hz


def problem_of(
    connection: Connection,
    slack: _core.Slack,
    again: int,
    file: str = "",
    line: int | None = None,
) -> Problem:
    """The problem to report for commands that arrived with this slack. `file` and `line` name the
    move. `again` is the number of bytes that were sent again to any board: repeats to one board
    delay all boards, because they get each commit together."""
    hz = connection.board.clock_hz
    values = {
        "value": _before(slack.slack / hz),
        "limit": LATE_S * 1e3,
        "held": slack.held / hz,
        "slots": connection.move_count,
        "bytes": again,
    }
    return Problem(f"late.{slack.cause.name.lower()}", file, line, values)


def summary(connection: Connection) -> str:
    """`Link: least slack 123 ms; late frames: 3 of 1200 (3 stalls); …`, since the board was
    configured."""
    hz, link = connection.board.clock_hz, connection.link
    least = link.min_slack
    slack = f"{least.slack / hz * 1e3:.0f} ms" if least.known else "unknown"
    late = {cause: n for cause, n in link.late_frames.items() if n}
    causes = ", ".join(f"{n} {_NAMES[cause]}" for cause, n in late.items())
    whose = f" of {connection.name}" if connection.name else ""
    return (
        f"Link{whose}: least slack {slack}; late frames: {sum(late.values())} of {link.frames}"
        f"{f' ({causes})' if causes else ''}; longest stall {link.longest_stall / hz * 1e3:.0f} ms;"
        f" {link.wire_bytes} bytes, {link.retransmitted_bytes} of them again"
    )


def _before(seconds: float) -> str:
    return f"{abs(seconds) * 1e3:.0f} ms {'before' if seconds >= 0 else 'after'}"
