"""Emergency parser: commands that act as soon as their line is received, before the queued ones."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from passo.console.upload import Upload
from passo.gcode.command import Command, words_of
from passo.gcode.registry import ANY, row_of
from passo.printer.printer import Printer

_RESUMES = ("M24", "M602")
RESTARTS = ("M999", "RESTART", "FIRMWARE_RESTART")
LIFTS = ("M922", *RESTARTS)


def halts(command: Command) -> bool:
    """True for M112, also after another command in its line, even if that one is refused."""
    if command.code == "M112":
        return True
    if command.name or "112" not in command.text:
        return False
    if command.letter == "M":  # else a move, or an axis of a line that repeats the last one
        row = row_of(command.code)
        if row is None or row.bare in (None, ANY):  # the text may hold labels
            return False
    return ("M", 112.0) in words_of(command.text)


def answers(command: Command) -> bool:
    """The command ends a wait for a user."""
    said = command.code == "M876" and "S" in command.words()
    return said or command.code in ("M108", *_RESUMES)


@dataclass(slots=True)
class _Answer:
    """A queued line that ends a wait for the user. `used`: it has ended a wait; `done`: nothing is
    left to do when it is reached."""

    used: bool
    done: bool


class EmergencyParser:
    """Checks the lines of one console when they are received, before its queue is processed."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._in_hand = 0  # M28 and M29 in the queue
        self._opens = False  # whether the last of them opens a file
        self._numbered = False  # whether the lines for the file are numbered
        self._answers: deque[_Answer] = deque()  # those in the queue
        self._failures: deque[int] = deque()  # that those of LIFTS in hand may know of

    def see(self, command: Command, number: int | None, upload: Upload | None) -> bool:
        """Acts on M108, M112, M410 and M876, and on commands that end the pause of a host, unless
        they are text of an upload that is open, or that a queued line will open; `upload` is the
        open one. In an upload with line numbers a line without one is a command. Returns False for
        text. For each command, call `reached` if it is M28 or M29, `answered` if it `answers`, and
        `outdated` if it is one of LIFTS, when the line is taken from the queue."""
        code = command.code
        into_file = self._opens if self._in_hand else upload is not None and upload.takes_all
        numbered = self._numbered or (not self._in_hand and upload is not None and upload.numbered)
        if into_file and code != "M29" and (number is not None or not numbered):
            self._numbered = number is not None
            return False
        if code in ("M28", "M29"):
            self._in_hand += 1
            self._opens = code == "M28"
            self._numbered = False
        if answers(command):
            ends = self._resume() if code in _RESUMES else self._ends_wait(command)
            self._answers.append(_Answer(ends, ends))
        if code in LIFTS:
            self._failures.append(self._printer.state.failures)
        self.act(command)
        return True

    def reached(self) -> None:
        """A queued M28 or M29 is reached."""
        self._in_hand -= 1

    def answered(self) -> bool:
        """A queued command that `answers` is reached; True if it has acted already."""
        return self._answers.popleft().done

    def take_answer(self) -> bool:
        """A wait for the user begins; True if a queued answer ends it: one that was received too
        early, and has ended no other wait. After M24 and M602 a paused file has still to resume."""
        answer = next((answer for answer in self._answers if not answer.used), None)
        if answer is None:
            return False
        answer.used = True
        answer.done = not (self._printer.job.suspended and self._printer.state.busy())
        return True

    def outdated(self) -> bool:
        """A queued one of LIFTS is reached; True if a failure occurred after it was received, of
        which its sender did not know."""
        return self._failures.popleft() != self._printer.state.failures

    def _resume(self) -> bool:
        """Ends a wait for the user, also the pause of a host. True if nothing is left to do, for
        example when such a pause is about to end. False for a paused file, which must still resume.
        """
        printer = self._printer
        awaited = printer.prompts.awaited
        if awaited:
            printer.go_on()
        if printer.job.suspended and printer.state.busy():
            return False
        return awaited or (printer.job.suspended and printer.waits.busy)

    def _ends_wait(self, command: Command) -> bool:
        """Whether this is M108 while something waits, or M876 that answers the question of a
        wait."""
        printer = self._printer
        if command.code == "M108":
            return printer.waits.busy or printer.waits.for_room or printer.prompts.asking
        return printer.prompts.awaited and answers(command)

    def act(self, command: Command) -> None:
        """Executes the command if it is an emergency command."""
        code = command.code
        if halts(command):
            self._printer.emergency_stop()
        elif code == "M108" or (code == "M876" and self._ends_wait(command)):
            self._printer.go_on()
        elif code == "M410":
            self._printer.stop_all("M410")
