"""Reports commands that reach the board only shortly before they are due, and the cause."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from passo.board.lateness import is_late, problem_of, summary

if TYPE_CHECKING:
    from passo import _core
    from passo.board.connection import Connection
    from passo.errors import Problem
    from passo.motion.rig import Rig
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_AGAIN_S = 10.0  # between two lines on the consoles


class LateCommandWatch:
    """Monitors the slack of one printer's links. `worst` is the worst report of the current or the
    last print."""

    def __init__(self, rig: Rig, state: State) -> None:
        self._rig, self._state = rig, state
        self.worst = ""
        self._least_s = 0.0  # the slack of `worst`
        self._next_word = 0
        self._pending: tuple[float, Problem] | None = None

    def reset(self) -> None:
        """Call this when a print begins."""
        self.worst = ""

    def time_passed(self) -> None:
        """Handles the slack reports since the last call; reports the least slack of the last ten
        seconds."""
        rig = self._rig
        rig.job.history.line_at(rig.queue.passed)  # past lines are dropped
        self.look()
        now = rig.connection.now
        if self._pending is not None and now >= self._next_word:
            self._next_word = now + int(_AGAIN_S * rig.queue.hz)
            self._tell()

    def look(self) -> None:
        """Handles the slack reports since the last call."""
        for connection in self._rig.connection.connections:
            slack = connection.link.take_slack()
            if not is_late(connection, slack):
                continue
            seconds = slack.slack / connection.board.clock_hz
            problem = self._problem(connection, slack)
            if self._pending is None or seconds < self._pending[0]:
                self._pending = seconds, problem
            if not self.worst or seconds < self._least_s:
                self._least_s, self.worst = seconds, str(problem)

    def board_failed(self) -> None:
        """Call this when a board has failed: reports pending lateness at once, because it may be
        the cause."""
        self.look()
        self._next_word = 0  # the board's clock may restart
        self._tell()

    def summaries(self) -> list[str]:
        """A line of M122 for each board."""
        return [summary(connection) for connection in self._rig.connection.connections]

    def _tell(self) -> None:
        if self._pending is not None:
            problem = self._pending[1]
            self._state.announce(_log, logging.WARNING, str(problem), problem)
            self._pending = None

    def _problem(self, connection: Connection, slack: _core.Slack) -> Problem:
        rig, file = self._rig, self._state.printed_file
        clock = connection.main_clock(slack.clock) - rig.queue.base
        line = rig.job.history.line_near(clock) if file else 0
        again = sum(c.link.retransmitted_bytes for c in rig.connection.connections)
        return problem_of(connection, slack, again, file, line or None)
