"""Tells when commands reach the board with little time to spare, and why."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.board.lateness import is_late, problem_of, summary

if TYPE_CHECKING:
    from passo import _core
    from passo.printer.printer import Printer

_AGAIN_S = 10.0  # between two lines on the consoles


class LatenessWatch:
    """The slack of one printer's link. `program` names the file that is printed; `worst` is what
    there is to say of the print that is under way, or was the last one."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self.program: Callable[[], str] = str
        self.worst = ""
        self._least = 0  # slack of `worst`
        self._next_word = 0
        self._pending: tuple[int, str] | None = None

    def begin(self) -> None:
        """A print begins."""
        self.worst = ""

    def time_passed(self) -> None:
        """Looks at what has arrived since; tells the least slack of the last ten seconds."""
        printer = self._printer
        printer.job.line_at(printer.drive.now)  # what lies behind it is forgotten
        self.look()
        now = printer.connection.now
        if self._pending is not None and now >= self._next_word:
            self._next_word = now + int(_AGAIN_S * printer.drive.hz)
            self._tell()

    def look(self) -> None:
        """Takes notice of what has happened since the last look."""
        slack = self._printer.connection.link.take_slack()
        self._printer.braking.look_at(slack)
        if not is_late(self._printer.connection, slack):
            return
        sentence = self._sentence(slack)
        if self._pending is None or slack.slack < self._pending[0]:
            self._pending = slack.slack, sentence
        if not self.worst or slack.slack < self._least:
            self._least, self.worst = slack.slack, sentence

    def board_failed(self) -> None:
        """What is known is told at once: it may be why."""
        self.look()
        self._next_word = 0  # the board's clock may begin anew
        self._tell()

    def summary(self) -> str:
        """One line for M122."""
        return summary(self._printer.connection)

    def _tell(self) -> None:
        if self._pending is not None:
            self._printer.tell(f"echo:{self._pending[1]}")
            self._pending = None

    def _sentence(self, slack: _core.Slack) -> str:
        printer, file = self._printer, self.program()
        line = printer.job.line_near(slack.clock - printer.drive.base) if file else 0
        return str(problem_of(printer.connection, slack, file, line or None))
