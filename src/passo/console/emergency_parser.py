"""Emergency parser: commands that act as soon as their line is received, before the queued ones."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from passo.console.upload import Upload
from passo.gcode.command import Command, words_of
from passo.gcode.registry import row_of
from passo.printer.control import Control

_RESUMES = ("M24", "M602")
RESTARTS = ("M999", "RESTART", "FIRMWARE_RESTART")
LIFTS = ("M922", *RESTARTS)


def halts(command: Command) -> bool:
    """True for M112, even after another command in its line, and even if that command is
    refused."""
    if command.code == "M112":
        return True
    if command.name or "112" not in command.text:
        return False
    if command.letter == "M":  # other letters begin a move, or a line that repeats the last move
        row = row_of(command.code)
        if row is None or row.takes_text or row.takes_anything:  # the text may contain any label
            return False
    return ("M", 112.0) in words_of(command.text)


def answers(command: Command) -> bool:
    """Whether the command ends a wait for a user."""
    answer = command.code == "M876" and "S" in command.words()
    return answer or command.code in ("M108", *_RESUMES)


@dataclass(slots=True)
class _Answer:
    """A queued line that ends a wait for the user. `used`: it has already ended a wait. `done`: it
    needs no action when it is reached."""

    used: bool
    done: bool


class EmergencyParser:
    """Checks the lines of one console when they are received, before they are queued."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self._in_hand = 0  # number of M28 and M29 in the queue
        self._opens = False  # whether the last of these opens a file
        self._numbered = False  # whether the lines for the file are numbered
        self._answers: deque[_Answer] = deque()  # answers in the queue
        # failure count at the receipt of each queued command of LIFTS
        self._failures: deque[int] = deque()

    def see(self, command: Command, number: int | None, upload: Upload | None) -> bool:
        """Executes M108, M112, M410, M876, and commands that end the pause of a host. Returns False
        for a line of an upload, which is text: `upload` is open, or a queued line will open one. In
        an upload with line numbers, a line without a number is a command. When a command is taken
        from the queue, call `reached` for M28 and M29, `answered` if it `answers`, and `outdated`
        for one of LIFTS."""
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
            self._failures.append(self._control.state.failures)
        self.act(command)
        return True

    def reached(self) -> None:
        """Call this when a queued M28 or M29 is reached."""
        self._in_hand -= 1

    def answered(self) -> bool:
        """Call this when a queued command that `answers` is reached. Returns True if it has taken
        effect already."""
        return self._answers.popleft().done

    def take_answer(self) -> bool:
        """Call this when a wait for the user begins. Returns True if an answer was received before
        the wait and is still in the queue; then end the wait. Each answer ends at most one wait. If
        the answer is M24 or M602, it also resumes a paused file when it is reached."""
        answer = next((answer for answer in self._answers if not answer.used), None)
        if answer is None:
            return False
        answer.used = True
        answer.done = not (self._control.rig.job.stops.suspended and self._control.state.busy())
        return True

    def outdated(self) -> bool:
        """Call this when a queued command of LIFTS is reached. Returns True if a failure has
        occurred after its receipt, so that its sender did not know of the failure."""
        return self._failures.popleft() != self._control.state.failures

    def _resume(self) -> bool:
        """Ends a wait for the user, including the pause of a host. Returns True if this was
        sufficient, and False for a paused file, which must still be resumed.
        """
        control = self._control
        awaited = control.prompts.awaited
        if awaited:
            control.waits.go_on()
        if control.rig.job.stops.suspended and control.state.busy():
            return False
        return awaited or (control.rig.job.stops.suspended and control.waits.busy)

    def _ends_wait(self, command: Command) -> bool:
        """Whether the command is M108 during a wait, or M876 that answers the question of a
        wait."""
        control = self._control
        if command.code == "M108":
            return control.waits.busy or control.waits.for_room or control.prompts.asking
        return control.prompts.awaited and answers(command)

    def act(self, command: Command) -> None:
        """Executes the command if it is an emergency command."""
        code = command.code
        if halts(command):
            self._control.stops.emergency_stop()
        elif code == "M108" or (code == "M876" and self._ends_wait(command)):
            self._control.waits.go_on()
        elif code == "M410":
            self._control.stops.stop_all("M410")
