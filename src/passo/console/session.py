"""One console: executes its lines in order, answers each with `ok`, and sends it broadcast
messages."""

from __future__ import annotations

import asyncio
import logging
import re
from collections.abc import Callable, Sequence
from typing import Protocol

from passo import _core
from passo.console.emergency_parser import LIFTS, RESTARTS, EmergencyParser, answers, halts
from passo.console.receive_queue import Received, ReceiveQueue
from passo.console.timers import Timers
from passo.console.upload import Upload
from passo.errors import CardError, PassoError, Problem, in_words, printable
from passo.gcode.command import Command
from passo.gcode.line_protocol import Line, LineProtocol, Refusal, decoded
from passo.motion.motion_queue import MAX_QUEUED
from passo.printer.control import Control
from passo.printer.unfit_commands import unfit
from passo.printer.wait_requests import Stopped, Wait, without_effect

_log = logging.getLogger(__name__)

AT_ONCE = 1024  # lines that are executed before other tasks run: all lines of one read
AT_ONCE_S = 0.005  # time of the loop after which other tasks run: lines like M503 take long
WAIT_S = 1.0  # an idle console says `wait` this often
# a terminal would execute these characters
_CONTROLS = {chr(i): "?" for i in (*range(9), *range(11, 32), 127)}
_PLAIN = str.maketrans(_CONTROLS)
# Units in texts of Passo are replaced by ASCII, which every host can show. Names stay unchanged.
_UNITS = re.compile(r"(?<=\d )°(?=C(?:[/\s,;:)]|\.?$|\.\s))|(?<=\d )µ(?=[ms]\b)|(?<=/s)²")
_UNIT = {"°": "", "µ": "u", "²": "2"}
_NO_TEXT = ("M29", "M110", "M932", "M933")  # these are never text, even while a file is written
_EVEN_AFTER_FAILURE = (*_NO_TEXT, "M108", "M112", "M410", "M876", *RESTARTS)
# A line with this beginning moves the machine; an axis word alone repeats the last move.
_MOVES = re.compile(r"G([0-3]|10|11|28|61)\Z|M(60[01]|70[12])\Z|[A-EH-LO-RU-Z][-+.\d]")
_TOOL = re.compile(r"T\d")  # if it fails, the filament of another tool would be printed
_EXPONENT = re.compile(r"[\d.][Ee][-+\d]")
# Match only the code at the beginning of a line, because the rest may be a text.
_HEAD = re.compile(r"\s*([A-Za-z])\s*(\d{1,9})(?:\.(\d))?\s*(.*)\Z", re.DOTALL | re.ASCII)


class Wire(Protocol):
    """The destination of a console's text. Never blocks; text for a slow reader is dropped."""

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        """Sends text. Dispensable text is sent only if there is space."""

    def hold(self, held: bool) -> None:
        """Stops or resumes reading."""


def command_of(text: str) -> Command:
    """The command at the beginning of a line; a name if it has no letter and number."""
    text = decoded(text)
    if _EXPONENT.search(text):
        text = _core.without_exponents(text)
    head = _HEAD.match(text)
    if head is None:
        name, _, rest = text.strip().partition(" ")
        return Command(0, "", 0, 0, name.upper(), rest)
    return Command(0, head[1].upper(), int(head[2]), int(head[3] or 0), "", head[4])


def prints(code: str) -> bool:
    """Whether a print is spoilt if this command fails. Also True for a line that begins with a
    character that is not G-code."""
    return bool(_MOVES.match(code) or _TOOL.match(code)) or not code[:1].isascii()


def _encoded(text: str) -> bytes:
    """A line in UTF-8. It is ASCII, which every host can read, except for names and texts of
    users."""
    if not text.isascii():
        text = _UNITS.sub(lambda unit: _UNIT[unit[0]], text)
    return text.translate(_PLAIN).encode("utf-8", "replace") + b"\n"


class Session:
    """A console in operation. Call `receive` with the arriving bytes. Use it in one event loop."""

    def __init__(self, control: Control, wire: Wire) -> None:
        self._control, self._state, self._wire = control, control.state, wire
        self._protocol = LineProtocol()
        self._shown = self._state.console_lines
        self.number = self._shown.join()
        self.sender = ""  # the sender of the next lines, if known
        self._lines = ReceiveQueue()
        self._loop = asyncio.get_running_loop()
        self._task: asyncio.Task[None] | None = None
        # the scheduled call that continues with queued lines
        self._soon: asyncio.Handle | None = None
        self._ok = ""
        self._timers = Timers(control.rig)
        self._emergency_parser = EmergencyParser(control)
        self._held = False
        self.strict = False  # M932: after a failure, no line is executed
        self.failed = False
        self.busy_s = 2.0  # M113
        self.advanced_ok = False
        self._upload: Upload | None = None
        self.on_upload: Callable[[], None] = lambda: None  # called when an upload begins or ends
        self._given_up = 0  # number of queued lines that were received before a stop of the machine
        self._overtaken = False  # whether the line that waits for the motion lock is one of them
        self._working = False  # this console's line has the motion lock and is running
        self._printed = False  # the line is a numbered move, probably of a print
        self.closed = False
        self._unanswered = False  # the input has ended, and only a user could end the wait
        self._noted: set[str] = set()
        self._then: Callable[[], None] | None = None  # called after the last line
        self._state.listeners.append(self._hear_all)
        self._state.stop_listeners.append(self._stopped)
        control.prompts.wait_listeners.append(self._user_wanted)
        self.every("wait", WAIT_S, self._say_wait)

    @property
    def upload(self) -> Upload | None:
        """The open upload (M28), into which lines are written; None without one."""
        return self._upload

    @upload.setter
    def upload(self, upload: Upload | None) -> None:
        """Sets the upload for the next lines; None executes them."""
        self._upload = upload
        self.on_upload()

    @property
    def unfinished(self) -> bool:
        """Whether the beginning of a line has arrived, but not its end."""
        return self._protocol.unfinished

    # -- bytes ------------------------------------------------------------------------------------

    def receive(self, data: bytes) -> None:
        """Handles bytes that the host has sent."""
        received = self._protocol.feed(data)
        for line in received:
            whole = isinstance(line, Line)
            text = line.text if whole else f"{line.text} ({line.reason})"
            self._shown.received(self.number, text, self.sender)
            if whole:
                command = command_of(line.text)
                seen = self._emergency_parser.see(command, line.number, self._upload)
                self._lines.append((line, command, seen))
            else:
                # execute a stop even if the line has to be resent
                if halts(command := command_of(line.text)):
                    self._emergency_parser.see(command, line.resend, self._upload)
                self._lines.append(line)
        if received and self._resting:
            self._work()
        if self._lines.full and not self._held:
            self._held = True
            self._wire.hold(True)

    def call(self, command: Command) -> None:
        """Executes a command with values, after the lines before it."""
        line = Line(f"{command.code} {command.text}".rstrip())
        self._shown.received(self.number, line.text, self.sender)
        seen = self._emergency_parser.see(command, None, self._upload)
        self._lines.append((line, command, seen))
        if self._resting:
            self._work()

    def close(self) -> None:
        """The host has disconnected: discards its queued lines and ends its wait."""
        self.closed = True
        self._timers.stop()
        self._lines.clear()
        if self._soon is not None:
            self._soon.cancel()
        if self._upload is not None:
            self._upload.abort()
            self._upload = None
        if self._working:
            if self._control.waits.person:
                # no client is left that could resume and need the heaters
                self._control.targets.cooled_c.clear()
            # end the wait, because a cancelled task would leave the machine moving
            self._control.waits.end()
        elif self._task is not None:
            self._task.cancel()
        if self._hear_all in self._state.listeners:
            self._state.listeners.remove(self._hear_all)
            self._state.stop_listeners.remove(self._stopped)
            self._control.prompts.wait_listeners.remove(self._user_wanted)

    @property
    def gone(self) -> bool:
        """Whether the console has closed, so that no answer can come from it."""
        return self.closed or self._unanswered

    def end(self, then: Callable[[], None]) -> None:
        """Call this when the input has ended. Queued lines are executed; then the session closes,
        and `then` is called. A wait that only a user can end is ended, and the lines after it are
        dropped."""
        self._then = then
        if self._working and self._control.prompts.for_ever:
            self._end_unanswered()
        if self._resting:
            self._work()

    # -- answers ----------------------------------------------------------------------------------

    def say(self, text: str) -> None:
        """Sends a line of the answer."""
        if not self.closed:
            self._shown.sent(self.number, text)
            self._wire.write(_encoded(text))

    def hear(self, text: str) -> None:
        """Sends a report or a busy message, which a slow reader may miss."""
        self._shown.sent(self.number, text)
        self._hear_all(text)

    def _hear_all(self, text: str) -> None:
        """Like `hear`, for a line to all consoles."""
        self._wire.write(_encoded(text), dispensable=True)

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Sends a line once for each `about`, or each time if `again`."""
        if again or about not in self._noted:
            self._noted.add(about)
            self.say(f"echo:{text}")

    def no_part(self, code: str, why: str) -> None:
        """As a note: a host's print continues."""
        self.note(code, without_effect(code, why))

    def with_ok(self, text: str) -> None:
        """Sets the text after this command's `ok`."""
        self._ok = text

    def warming(self, text: str) -> None:
        """Sends the temperatures during a wait, unless M155 reports them anyway."""
        if not self._timers.runs("temperatures"):
            self.hear(text)

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Reports a refused command. Only a strict console receives `Error:`, because it makes
        hosts disconnect. A host that prints is asked to pause, because the print would be spoilt
        after a missing move."""
        self.failed = True
        fields = problems[0].log_fields if problems else {}
        _log.warning("%s", text, extra={**fields, "console": self.number})
        self.say(("Error:" if self.strict else "echo:") + text)
        if self._printed:
            self.say("// action:pause")

    def every(self, name: str, seconds: float, action: Callable[[], None] | None) -> None:
        """Calls an action at an interval of host time, instead of the earlier action of this name;
        0 stops it."""
        if not self.closed:
            self._timers.set(name, seconds, action)

    def report_every(self, name: str, seconds: float, action: Callable[[], None]) -> None:
        """Like `every`, for a report; the interval is print time if that is faster."""
        if not self.closed:
            self._timers.set(name, seconds, action, report=True)

    # -- work -------------------------------------------------------------------------------------

    @property
    def _resting(self) -> bool:
        """Whether no line is being executed or scheduled."""
        return self._task is None and self._soon is None

    def _next(self) -> Received:
        """Takes the next queued line, and resumes reading when there is space."""
        received = self._lines.popleft()
        if self._held and self._lines.half_empty:
            self._held = False
            self._wire.hold(False)
        return received

    def _work(self) -> None:
        """Executes lines until one of them has to wait, or until other tasks must run."""
        self._soon = None
        others_s = self._loop.time() + AT_ONCE_S
        for _ in range(AT_ONCE):
            if not self._lines or self._loop.time() > others_s:
                break
            received = self._next()
            given_up = self._given_up > 0
            self._given_up -= given_up
            self._ok = ""
            if isinstance(received, Refusal):
                if received.lost and self._upload is not None and self._upload.takes_all:
                    self._upload.lose(received.reason)
                if received.lost:
                    self._printed = prints(command_of(received.text).code)
                    self.fail(f"{received.reason}. Send shorter lines")
                elif received.resend is None:
                    self.say(f"echo:{received.reason}")
                else:
                    _log.warning("%s", received.reason, extra={"console": self.number})
                    self.say(f"Error:{received.reason}")
                    self.say(f"Resend: {received.resend}")
                self._acknowledge(None)
                continue
            line, command, seen = received
            self._printed = line.number is not None and (
                prints(command.code) or unfit(command, self._control.skips) is not None
            )
            if self._printed:
                self._state.numbered_move_s = self._loop.time()
            try:
                if self._take(line, command, seen=seen, given_up=given_up):
                    return
            except Exception as error:
                self._not_done(error)
            self._acknowledge(line.number)
        if self._lines:
            self._soon = self._loop.call_soon(self._work)
        elif self._then is not None and not self.closed:
            self.close()
            self._then()

    def _take(self, line: Line, command: Command, *, seen: bool, given_up: bool) -> bool:
        """Executes a line. Returns True if a task must wait for it."""
        control, code = self._control, command.code
        if seen and code in ("M28", "M29"):
            self._emergency_parser.reached()
        answered = seen and answers(command) and self._emergency_parser.answered()
        outdated = seen and code in LIFTS and self._emergency_parser.outdated()
        refused = self._refused(code)
        stored = not refused and self._stored(line, code)
        text = stored and self._upload is not None and self._upload.takes_all
        # The line was received as text of a file and is a command now; M999 may come before M112.
        if not text and (not seen or halts(command)):
            self._emergency_parser.act(command)
        if refused or stored or answered or self._halted(code):
            return False
        if outdated:
            since = "the printer has failed since it was sent. Look at it, then send it again"
            self.fail(f"{code} is not carried out: {since}")
            return False
        if control.dispatch.act(command, self):
            revives = code in RESTARTS and bool(self._state.halted)
            if revives:
                self._task = self._loop.create_task(
                    self._await_restart(line, control.supervisor.answered())
                )
            return revives
        if self._halted(""):  # refuse even an immediate command
            return False
        if given_up and self._was_stopped(code):
            return False
        if not (control.dispatch.has_room() and control.motion_lock.try_acquire()):
            self._begin(line, command, None, queued=True)
            return True
        wait = None
        try:
            wait = self._read(line, command)
        finally:
            if wait is None:
                control.motion_lock.release()
        if wait is not None:
            self._begin(line, command, wait)
        return wait is not None

    def _read(self, line: Line, command: Command) -> Wait | None:
        """Reads a line, or carries out a command that was called with values."""
        if command.given is not None:
            return self._control.dispatch.take_call(command, self)
        return self._control.dispatch.take_line(line.text, self)

    def _begin(
        self, line: Line, command: Command, wait: Wait | None, *, queued: bool = False
    ) -> None:
        self._working = not queued
        self._task = self._loop.create_task(self._carry_out(line, command, wait, queued=queued))

    async def _carry_out(
        self, line: Line, command: Command, wait: Wait | None, *, queued: bool
    ) -> None:
        """Waits for the motion lock, for space in the move queue, or for the condition of a
        command, and executes the line."""
        control, code = self._control, command.code
        self.every("busy", self.busy_s, self._say_busy)
        has_turn, hurried = not queued, False
        try:
            if queued:
                await control.motion_lock.acquire()
                has_turn = True
                hurried = await control.dispatch.room()
                overtaken = self._overtaken and self._was_stopped(code)
                if not (overtaken or self._refused(code) or self._halted(code)):
                    wait = self._read(line, command)
            self._working = True
            await control.dispatch.finish(wait, self, first_ends=hurried, all_end=lambda: self.gone)
        except Exception as error:
            self._not_done(error)
        finally:
            self.every("busy", 0, None)
            if has_turn:
                control.motion_lock.release()
            self._task, self._working, self._overtaken = None, False, False
        if not self.closed:
            self._acknowledge(line.number)
            self._work()

    async def _await_restart(self, line: Line, answered: asyncio.Future[None]) -> None:
        """M999: waits until the printer is ready again, or halted as before."""
        self.every("busy", self.busy_s, self._say_busy)
        try:
            await answered
        finally:
            self.every("busy", 0, None)
            self._task, self._overtaken = None, False
        self._halted("")  # reports the halt
        self._acknowledge(line.number)
        self._work()

    def _user_wanted(self) -> None:
        """Called when a wait for a user begins. If it is a wait of this console, the answer may be
        queued already."""
        if self._working and self._emergency_parser.take_answer():
            self._control.waits.end()
        elif self._working and self._then is not None and self._control.prompts.for_ever:
            self._end_unanswered()

    def _end_unanswered(self) -> None:
        """Ends the wait as if the host had disconnected, because the next commands need the consent
        of the user."""
        left = len(self._lines)
        self._unanswered = True
        self._lines.clear()
        self._control.targets.cooled_c.clear()
        lines = f"; {left} lines after it are not carried out" if left else ""
        self.say(f"echo:The input has ended, so the wait for the user ends, too{lines}")
        self._control.waits.end()

    def _stopped(self, _: str) -> None:
        """Called after M410 or a triggered endstop: discards queued moves like the planned ones.
        Other queued lines are executed, because one may switch a heater off."""
        if not self._state.halted:
            self._given_up = len(self._lines)
            self._overtaken = self._task is not None and not self._working

    def _was_stopped(self, code: str) -> bool:
        if _MOVES.match(code):
            self.fail(f"{code} is not carried out: it was in hand when the machine was stopped")
            return True
        return False

    def _not_done(self, error: Exception) -> None:
        """Reports a failed line. After a fault of the program, whose state is then unknown, all
        outputs are switched off; the host still receives its `ok`."""
        if not isinstance(error, (Stopped, PassoError)):
            error = in_words(error)
            self._control.stops.halt(error)
        self.fail(str(error), error.problems if isinstance(error, PassoError) else ())

    def _stored(self, line: Line, code: str) -> bool:
        """Whether a line is text of the file that is being written. If the lines of the file are
        numbered, a line without a number is a query of the host."""
        upload = self.upload
        if upload is None or code in _NO_TEXT:
            return False
        if upload.writer is None:
            return code not in (*_EVEN_AFTER_FAILURE, "M28") and self._dropped(upload, code)
        if upload.log:
            try:
                upload.write(line.text)
            except CardError as error:
                self.say(f"echo:{error}")  # the command itself was executed
            return False
        self._printed = False
        upload.numbered = upload.numbered or line.number is not None
        if upload.numbered and line.number is None:
            if code in self._control.dispatch.immediate:
                return False
            self.fail(
                f"{printable(code)} is not carried out while a file is written; end it with M29"
            )
            return True
        upload.write(line.text)
        return True

    def _dropped(self, upload: Upload, code: str) -> bool:
        """Reports once that lines are discarded."""
        if not upload.reported:
            upload.reported = True
            where = f"the file {upload.name}" if upload.name else "a file without a name"
            self.say(
                f"echo:{printable(code)} is not carried out: it is for {where}. End it with M29"
            )
        return True

    def _refused(self, code: str) -> bool:
        if not (self.strict and self.failed) or code in _EVEN_AFTER_FAILURE:
            return False
        if self._upload is not None:
            self._upload.abort()  # the file would miss this line
        self.say("Error:PreviousCommandFailed")
        return True

    def _halted(self, code: str) -> bool:
        if self._state.halted and not self._control.dispatch.answers_halted(code):
            self.fail(f"Printer stopped: {self._state.why_halted}")
            return True
        return False

    def _acknowledge(self, number: int | None) -> None:
        text = "ok"
        if self.advanced_ok:
            free = max(0, MAX_QUEUED - self._control.rig.job.plan.queued)
            text += f" N{number}" if number is not None else ""
            text += f" P{free} B{self._lines.room}"
        self.say(f"{text} {self._ok}" if self._ok else text)
        self._timers.restart("wait")

    def _say_busy(self) -> None:
        what = "heating" if self._control.waits.heating else "processing"
        self.hear(f"echo:busy: {what}")

    def _say_wait(self) -> None:
        if self._task is None and not self._lines:
            self.hear("wait")
