"""A console for the program that embeds the printer: takes commands and returns replies, without
text streams."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from passo.console.session import Session
from passo.errors import CommandError, Problem
from passo.gcode.command import Command
from passo.gcode.line_protocol import LONGEST, uncommented
from passo.printer.control import Control


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer to a command, line by line, without `ok`; empty for most commands."""

    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The lines as one text."""
        return "\n".join(self.lines)


class _NoWire:
    """A wire that drops bytes, because the client receives answers as text."""

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        """Drops the bytes."""

    def hold(self, held: bool) -> None:
        """Does nothing, because there is no input stream."""


class Client(Session):
    """A console whose lines come from `send`. Commands are executed in the order of the calls,
    except those that act at once (M108, M112, M410)."""

    def __init__(self, control: Control) -> None:
        self._pending: deque[tuple[asyncio.Future[Reply], Callable[[str], None] | None]] = deque()
        self._answer_lines: list[str] = []
        self._failure: CommandError | None = None
        super().__init__(control, _NoWire())
        self.every("wait", 0, None)
        self.busy_s = 0.0

    async def send(self, line: str, on_line: Callable[[str], None] | None = None) -> Reply:
        """Executes one line of G-code and returns its answer. `on_line` is called at once with each
        line of the answer, in the form for consoles. The answer to a move comes when the move is
        planned; `M400` waits until the machine is at standstill. Raises CommandError if the line is
        refused, and ValueError for more than one line. If the calling task is cancelled, a line
        that has not started is dropped, and a wait ends as with M108; planned moves are still
        executed.
        """
        text = line.strip()
        if "\n" in text or "\r" in text:
            raise ValueError("send() takes one line; call it once for each line")
        data = text.encode() + b"\n"
        if len(data) > LONGEST:
            raise ValueError(f"send() takes at most {LONGEST} bytes, not {len(data)}")
        if not uncommented(text):
            return Reply()
        return await self._answer(lambda: self.receive(data), on_line)

    async def execute(
        self, command: Command, on_line: Callable[[str], None] | None = None
    ) -> Reply:
        """As `send`, for a command with values."""
        return await self._answer(lambda: self.call(command), on_line)

    async def _answer(
        self, take: Callable[[], None], on_line: Callable[[str], None] | None
    ) -> Reply:
        reply: asyncio.Future[Reply] = asyncio.get_running_loop().create_future()
        self._pending.append((reply, on_line))
        take()
        try:
            return await reply
        except asyncio.CancelledError:
            if self._working and self._pending[0][0] is reply:
                self._control.waits.end()
            raise

    def fail_all(self, error: BaseException) -> None:
        """Ends all open calls: the printer has ended, and no command is answered any more."""
        while self._pending:
            reply, _ = self._pending.popleft()
            if not reply.done():
                reply.set_exception(error)

    def say(self, text: str) -> None:
        """Receives a line of the answer."""
        self._shown.sent(self.number, text)
        if text.startswith("Error:"):
            self.fail(text.removeprefix("Error:"))
            return
        self._answer_lines.append(text.removeprefix("echo:"))
        if self._pending and (on_line := self._pending[0][1]) is not None:
            on_line(text)

    def _hear_all(self, text: str) -> None:
        """Does nothing, because lines to all consoles are events."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Receives the reason why the command was refused."""
        found = list(problems) or [Problem("command.failed", values={"value": text.rstrip(".")})]
        self._failure = CommandError(found)

    def no_part(self, code: str, why: str) -> None:
        """An error, so that a script can distinguish it from success."""
        problem = Problem("command.no-part", values={"axis": code, "value": why.rstrip(".")})
        self.fail(problem.sentence, [problem])

    def warming(self, text: str) -> None:
        """Does nothing, because the status has the temperatures."""

    def _refused(self, code: str) -> bool:
        """Reports a refused line, even if its caller was cancelled."""
        return self._pending[0][0].cancelled() or super()._refused(code)

    def _acknowledge(self, number: int | None) -> None:
        lines, self._answer_lines = [*self._answer_lines, *([self._ok] if self._ok else [])], []
        failure, self._failure = self._failure, None
        reply, _ = self._pending.popleft()
        if reply.done():
            return
        if failure is not None:
            reply.set_exception(failure)
        else:
            reply.set_result(Reply(tuple(lines)))
