"""The state that all parts of one printer share: halted, paused, and the listeners."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.board.faults import HeaterFault
from passo.errors import MachineError, PassoError, Problem
from passo.gcode.command import Command
from passo.printer.console_lines import ConsoleLines
from passo.printer.wait_requests import Reply, Stopped

if TYPE_CHECKING:
    from passo.printer.status import Status

_log = logging.getLogger(__name__)


class State:
    """The state of one printer, and its listeners. It survives a restart (M999). `halted` is the
    reason why the printer is halted until M999, or empty; `cause` is the same as an error of the
    catalogue. `failures` counts halts and failed heaters, so that an M999 or M922 that was sent
    before a failure does not clear it. `host_paused`: the print of a host is paused, and its lines
    wait. `numbered_move_s` is the host time of the last numbered move of a console. `ended`: the
    current wait has to end. `program` is the source of the last planned moves. `start_failure` is
    the reason why the first start failed, until M999.
    """

    def __init__(self) -> None:
        self.halted = ""
        self.cause: PassoError | None = None
        self.failures = 0
        self.host_paused = False
        self.numbered_move_s: float | None = None
        self.ended = False
        self.program: Reply | None = None
        self.start_failure: MachineError | None = None
        self.console_lines = ConsoleLines(asyncio.get_running_loop().time)
        # messages from before the first console, for the first console that opens
        self.unreported: list[str] = []
        self.listeners: list[Callable[[str], None]] = []
        self.command_listeners: list[Callable[[Command, Reply], None]] = []  # of executed commands
        # called when a line of a console begins, or is `done`
        self.line_listeners: list[Callable[[bool], None]] = []
        self.stop_listeners: list[Callable[[str], None]] = []
        # called with the cause of a halt
        self.halt_listeners: list[Callable[[PassoError], None]] = []
        self.fault_listeners: list[Callable[[HeaterFault], None]] = []
        # called when M108 finds no wait of a command: resumes a file that waits for the user
        self.go_on_listeners: list[Callable[[], None]] = []
        # Each gives the name of the file that it prints or has paused, or None.
        self.prints: list[Callable[[], str | None]] = []
        self.stores: list[Callable[[], object]] = []  # each stores the settings
        self.greetings: list[Callable[[], str]] = []  # each gives text for a console that opens
        self.status_parts: list[Callable[[Status], Status]] = []  # each adds its fields

    def busy(self) -> bool:
        """Whether a print is running or paused."""
        return any(name() is not None for name in self.prints)

    @property
    def printed_file(self) -> str:
        """The name of the file that is being printed or paused, or empty."""
        return next((found for name in self.prints if (found := name())), "")

    def store_settings(self) -> None:
        """Stores the settings, if they can be stored."""
        for store in self.stores:
            store()

    def greeting(self) -> str:
        """The text for a console that opens, or empty."""
        return next((text for greeting in self.greetings if (text := greeting())), "")

    def halt(self, cause: PassoError, reason: str = "") -> None:
        """Marks the printer as halted until M999. `reason` is shown; the default is the text of the
        cause."""
        self.halted = (reason or str(cause)).rstrip(".")
        self.cause = cause
        self.failures += 1
        program = cause.__cause__  # for a fault of the program, the exception with its traceback
        _log.error(
            "Printer halted: %s", self.halted, extra=cause.problems[0].log_fields, exc_info=program
        )
        for listener in self.halt_listeners:
            listener(cause)

    def restarted(self) -> None:
        """Call this after M999 has restarted the printer."""
        self.halted = ""
        self.cause = None

    def announce(
        self, log: logging.Logger, level: int, text: str, problem: Problem | None = None
    ) -> None:
        """Sends a line to all consoles and to the log; `problem` gives the log record its code and
        values."""
        log.log(level, "%s", text, extra=problem.log_fields if problem else None)
        self.tell(f"echo:{text}")

    def tell(self, text: str) -> None:
        """Sends a line to all consoles."""
        self.console_lines.sent(0, text)
        for listener in list(self.listeners):
            listener(text)

    def is_other_source(self, reply: Reply) -> bool:
        """True if `reply` is not the source of the moves that are being planned: for a console
        during a print from the card, or while another console moves the machine."""
        return reply is not self.program

    @property
    def why_halted(self) -> str:
        """The reason why the printer is halted, and the next action."""
        named = self.halted.endswith("M999")
        return self.halted if named else f"{self.halted}. Make the printer safe, then send M999"

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
