"""A console of the program that embeds the printer: commands in, replies out, without text
streams."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from passo.console.session import Session
from passo.errors import CommandError, Problem
from passo.gcode.line_protocol import LONGEST, uncommented
from passo.printer.printer import Printer


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer to a command, line by line, without `ok`; empty for most commands."""

    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The lines as one text."""
        return "\n".join(self.lines)


class _NoWire:
    """The client takes its answers before they become bytes."""

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        """Drops the bytes."""

    def hold(self, held: bool) -> None:
        """Does nothing: there is no input to hold back."""


class Client(Session):
    """A console whose lines come from `send`. Commands are carried out in the order of the calls,
    and those that act at once (M108, M112, M410) act at once."""

    def __init__(self, printer: Printer) -> None:
        self._pending: deque[tuple[asyncio.Future[Reply], Callable[[str], None] | None]] = deque()
        self._said: list[str] = []
        self._failure: CommandError | None = None
        super().__init__(printer, _NoWire())
        self.every("wait", 0, None)
        self.busy_s = 0.0

    async def send(self, line: str, heard: Callable[[str], None] | None = None) -> Reply:
        """Carries out one line of G-code and returns its answer. `heard` is called with each line
        of the answer at once, as a console would receive it.

        A move is done when it is planned; `M400` waits until the machine is at standstill. Raises
        CommandError if the line is not carried out, and ValueError for more than one line. If the
        calling task is cancelled, a line that has not begun is not carried out, and a wait ends as
        with M108: moves that are planned still happen.
        """
        text = line.strip()
        if "\n" in text or "\r" in text:
            raise ValueError("send() takes one line; call it once for each line")
        data = text.encode() + b"\n"
        if len(data) > LONGEST:
            raise ValueError(f"send() takes at most {LONGEST} bytes, not {len(data)}")
        if not uncommented(text):
            return Reply()
        reply: asyncio.Future[Reply] = asyncio.get_running_loop().create_future()
        self._pending.append((reply, heard))
        self.receive(data)
        try:
            return await reply
        except asyncio.CancelledError:
            if self._working and self._pending[0][0] is reply:
                self._printer.waits.end()
            raise

    def fail_all(self, error: BaseException) -> None:
        """Ends all open calls: the printer has ended, and no command is answered any more."""
        while self._pending:
            reply, _ = self._pending.popleft()
            if not reply.done():
                reply.set_exception(error)

    def say(self, text: str) -> None:
        """A line of the answer."""
        self._shown.sent(self.number, text)
        if text.startswith("Error:"):
            self.fail(text.removeprefix("Error:"))
            return
        self._said.append(text.removeprefix("echo:"))
        if self._pending and (heard := self._pending[0][1]) is not None:
            heard(text)

    def _hear_all(self, text: str) -> None:
        """Does nothing: lines to all consoles come as events."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """The command was not carried out."""
        found = list(problems) or [Problem("command.failed", values={"value": text.rstrip(".")})]
        self._failure = CommandError(found)

    def warming(self, text: str) -> None:
        """Does nothing: temperatures come with the status."""

    def _refused(self, code: str) -> bool:
        """Reports a refused line, also one whose caller was cancelled."""
        return self._pending[0][0].cancelled() or super()._refused(code)

    def _acknowledge(self, number: int | None) -> None:
        lines, self._said = [*self._said, *([self._ok] if self._ok else [])], []
        failure, self._failure = self._failure, None
        reply, _ = self._pending.popleft()
        if reply.done():
            return
        if failure is not None:
            reply.set_exception(failure)
        else:
            reply.set_result(Reply(tuple(lines)))
