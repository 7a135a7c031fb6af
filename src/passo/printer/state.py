"""The state that all parts of one printer share: whether it is halted or paused, and its
subscribers."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable

from passo.board.faults import HeaterFault
from passo.errors import MachineError, PassoError, Problem
from passo.gcode.command import Command
from passo.printer.console_lines import ConsoleLines
from passo.printer.program_restart import ProgramRestart
from passo.printer.wait_requests import Reply, Stopped

_log = logging.getLogger(__name__)


class State:
    """The state of one printer, and the subscriptions to it. It survives a restart (M999).

    `halted`: why nothing moves or heats until M999, or empty; `cause`: the same as an error of the
    catalogue. `failures`: count of halts and failed heaters; an M999 or M922 that was sent before
    one does not clear it. `host_paused`: the print of a host is paused, and its lines wait.
    `ended`: the current wait has to end. `program`: the source of the moves that were planned last.
    `start_failure`: why the first start failed, until M999.
    """

    def __init__(self) -> None:
        self.halted = ""
        self.cause: PassoError | None = None
        self.failures = 0
        self.host_paused = False
        self.ended = False
        self.program: Reply | None = None
        self.start_failure: MachineError | None = None
        self.console_lines = ConsoleLines(asyncio.get_running_loop().time)
        self.unheard: list[str] = []  # told before anybody listened, for the console that opens
        self.listeners: list[Callable[[str], None]] = []
        self.command_listeners: list[Callable[[Command, Reply], None]] = []  # of executed commands
        self.line_listeners: list[Callable[[bool], None]] = []  # a console's begins, or was `done`
        self.stop_listeners: list[Callable[[str], None]] = []
        self.halt_listeners: list[Callable[[PassoError], None]] = []  # of its cause
        self.fault_listeners: list[Callable[[HeaterFault], None]] = []
        # Callbacks of the parts above the printer.
        self.busy: Callable[[], bool] = lambda: False  # a print is running or paused
        self.end_asking: Callable[[], None] = lambda: None  # resumes a file that waits for the user
        self.settings: Callable[[], Iterable[str]] = tuple  # commands that restore the settings
        self.store_settings: Callable[[], object] | None = None  # durably; None: nowhere
        self.greeting: Callable[[], str] = str  # for a console that opens
        self.program_restart: ProgramRestart | None = None  # None: nothing would start it again

    def halt(self, cause: PassoError, reason: str = "") -> None:
        """From now on nothing moves or heats until M999, and the reason is shown: by default the
        text of the cause."""
        self.halted = (reason or str(cause)).rstrip(".")
        self.cause = cause
        self.failures += 1
        program = cause.__cause__  # a fault of the program, with its trace
        _log.error(
            "Printer halted: %s", self.halted, extra=cause.problems[0].log_fields, exc_info=program
        )
        for listener in self.halt_listeners:
            listener(cause)

    def restarted(self) -> None:
        """M999 has started the printer again."""
        self.halted = ""
        self.cause = None

    def announce(
        self, log: logging.Logger, level: int, text: str, problem: Problem | None = None
    ) -> None:
        """A line to all consoles and to the log; `problem` gives the record its code and values."""
        log.log(level, "%s", text, extra=problem.log_fields if problem else None)
        self.tell(f"echo:{text}")

    def tell(self, text: str) -> None:
        """Sends a line to all consoles."""
        self.console_lines.sent(0, text)
        for listener in list(self.listeners):
            listener(text)

    def beside(self, reply: Reply) -> bool:
        """True if `reply` is not the source of the moves being planned: a console during a print
        from the card, or another console."""
        return reply is not self.program

    @property
    def why_halted(self) -> str:
        """`halted`, and the next action."""
        said = self.halted.endswith("M999")
        return self.halted if said else f"{self.halted}. Make the printer safe, then send M999"

    @property
    def interrupted(self) -> bool:
        """Whether M108, M410 or a halt has to end the current wait."""
        return self.ended or bool(self.halted)

    def raise_if_interrupted(self) -> None:
        """Raises Stopped after M108, M410 or a halt."""
        self.raise_if_halted()
        if self.ended:
            raise Stopped("it was stopped")

    def raise_if_halted(self) -> None:
        """Raises Stopped while the printer is halted."""
        if self.halted:
            raise Stopped(self.halted)
