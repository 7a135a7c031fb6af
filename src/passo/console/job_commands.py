"""Progress and time of prints, pauses that a print asks for, and filament changes."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from passo.card import Reader as CardReader
from passo.console.session import Session
from passo.errors import CommandError, PassoError
from passo.job.forecast import Forecast, forecast
from passo.job.history import History
from passo.job.host_pause import HostPause
from passo.job.runner import Runner, State
from passo.printer.waits import Handler, Procedure, Reply, Wait
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.printer.printer import Printer


class Stopwatch:
    """Print time that counts only while it runs."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._sum_s = 0.0
        self._since_s: float | None = None

    @property
    def seconds(self) -> float:
        """Time counted so far."""
        running = 0.0 if self._since_s is None else self._printer.drive.now_s - self._since_s
        return self._sum_s + running

    @property
    def running(self) -> bool:
        """Whether it counts."""
        return self._since_s is not None

    def start(self) -> None:
        """Counts from now on, beside what it has counted before."""
        if self._since_s is None:
            self._since_s = self._printer.drive.now_s

    def pause(self) -> None:
        """Counts no more, until started."""
        self._sum_s, self._since_s = self.seconds, None

    def reset(self) -> None:
        """Back to 0, standing."""
        self._sum_s, self._since_s = 0.0, None


def spoken(seconds: float) -> str:
    """`1h 2m 3s`."""
    whole = int(seconds)
    return f"{whole // 3600}h {whole // 60 % 60}m {whole % 60}s"


class JobCommands:
    """M31, M73, M75 to M78, M600 to M602 of one printer."""

    def __init__(
        self,
        printer: Printer,
        runner: Runner,
        history: History | None,
        open_again: Callable[[str], CardReader],
    ) -> None:
        self._printer, self._runner, self._history = printer, runner, history
        self._open_again = open_again
        self._host_pause = HostPause(printer)
        self._forecast: asyncio.Task[Forecast | None] | None = None
        self._planned_s = 0.0  # before this print
        self._watch = Stopwatch(printer)
        self._paused = False
        self._filament_mm = 0.0  # pushed before this print
        self._percent: float | None = None  # M73
        self._minutes_left: float | None = None
        self.immediate: dict[str, Handler] = {
            "M31": self._time,
            "M73": self._progress,
            "M75": lambda c, r: self._timer(start=True),
            "M76": lambda c, r: self._timer(pause=True),
            "M77": lambda c, r: self._timer(),
            "M78": self._statistics,
            "M530": self._host_print,
            "M531": lambda c, r: None,  # a name, which is no words
            "M532": self._host_progress,
            "M602": self._resume,
        }
        self.planned: dict[str, Handler] = {
            "M600": self._change_filament,
            "M601": self._pause,
        }
        runner.watchers.append(self._job_changed)

    def _job_changed(self, state: State) -> None:
        if state is State.PRINTING:
            if not self._watch.running and not self._paused:
                self._watch.reset()
                self._filament_mm = self._printer.filament_mm()
                self._planned_s = self._printer.planned_s()
                self._printer.lateness.begin()
                self._reckon()
            self._watch.start()
        else:
            under_way = self._watch.running or self._paused
            self._watch.pause()
            if under_way and state is not State.PAUSED:
                self._remember()
        self._paused = state is State.PAUSED

    def _reckon(self) -> None:
        if self._forecast is not None:
            self._forecast.cancel()
        try:
            reader = self._open_again(self._runner.path)
        except PassoError:
            self._forecast = None
            return
        loop = asyncio.get_running_loop()
        self._forecast = loop.create_task(forecast(self._printer.machine, reader))
        self._forecast.add_done_callback(self._foretell)

    def _foretell(self, task: asyncio.Task[Forecast | None]) -> None:
        """What the file will ask of the board, when that is known."""
        found = None if task.cancelled() else task.result()
        for sentence in found.budget.told(self._runner.name) if found else ():
            self._printer.tell(f"echo:{sentence}")

    def _times(self) -> tuple[float, float] | None:
        """Seconds of motion done and in all, of a print from its beginning; None if not known."""
        task = self._forecast
        if not self._runner.active or self._runner.first_line > 1 or task is None:
            return None
        found = task.result() if task.done() and not task.cancelled() else None
        if not found or not found.seconds:
            return None
        total = found.seconds
        ahead = max(0.0, self._printer.drive.ahead_s)
        done = self._printer.planned_s() - self._planned_s - ahead
        return min(max(done, 0.0), total), total

    def _remember(self) -> None:
        """A print has ended."""
        runner, watch = self._runner, self._watch
        used = self._printer.filament_mm() - self._filament_mm
        if self._history is None:
            return
        try:
            note = self._printer.lateness.worst
            self._history.add(runner.name, runner.size, runner.ended, watch.seconds, used, note)
        except sqlite3.Error as error:
            self._printer.tell(f"echo:This print is not in the history: {error}")

    def _statistics(self, command: Command, reply: Reply) -> Wait | None:
        if self._history is None:
            raise CommandError.of("settings.nowhere")
        if command.words().get("S") == 78:
            self._history.forget()
            return None
        totals = self._history.totals()
        reply.say(
            f"echo:Prints: {totals.prints}, finished: {totals.done},"
            f" failed or cancelled: {totals.prints - totals.done}"
        )
        reply.say(
            f"echo:Print time: {spoken(totals.print_s)}, longest: {spoken(totals.longest_s)},"
            f" filament: {totals.filament_mm / 1000:.2f}m"
        )
        for file, ended, seconds, note in self._history.last(5):
            reply.say(f"echo:  {file}: {ended}, {spoken(seconds)}")
            if note:
                reply.say(f"echo:    {note}")
        return None

    def _time(self, _: Command, reply: Reply) -> Wait | None:
        reply.say(f"echo:Print time {spoken(self._watch.seconds)}")
        return None

    def _timer(self, *, start: bool = False, pause: bool = False) -> Wait | None:
        if start:
            if not self._watch.running:
                self._watch.start()
        elif pause:
            self._watch.pause()
        else:
            self._watch.pause()
            self._printer.tell(f"echo:Print time {spoken(self._watch.seconds)}")
            self._watch.reset()
        return None

    def _host_print(self, command: Command, reply: Reply) -> Wait | None:
        """A host says that its print begins or ends."""
        begins = command.words().get("S", 0) > 0
        self._watch.pause()
        self._percent = self._minutes_left = None
        if begins:
            self._watch.reset()
            self._watch.start()
        reply.say("echo:Start Printing" if begins else "echo:Stop Printing")
        return None

    def _host_progress(self, command: Command, _: Reply) -> Wait | None:
        self._percent = command.words().get("X", self._percent)
        return None

    def _progress(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        self._percent = words.get("P", self._percent)
        self._minutes_left = words.get("R", self._minutes_left)
        if words:
            return None
        parts: list[str] = []
        times = self._times()
        done = self._runner.progress
        if times is not None:
            parts.append(f"{100 * times[0] / times[1]:.1f}%")
            parts.append(f"{(times[1] - times[0]) / 60:.1f} min left")
        elif done is not None:
            parts.append(f"{100 * done:.1f}% of the file")
        elif self._percent is not None:
            parts.append(f"{self._percent:g}%")
        if self._minutes_left is not None and times is None:
            parts.append(f"{self._minutes_left:g} min left")
        reply.say(f"echo:Progress: {', '.join(parts) or 'nothing is printed'}")
        return None

    def _change_filament(self, command: Command, reply: Reply) -> Wait | None:
        return self._stand_by("Change the filament, then go on with M108", command.words(), reply)

    def _pause(self, _: Command, reply: Reply) -> Wait | None:
        return self._stand_by("Paused; go on with M108", {}, reply)

    def _stand_by(self, text: str, words: Mapping[str, float], reply: Reply) -> Wait | None:
        """A file pauses and parks; a host that prints is asked to pause, and waits."""
        if self._runner.printing_from(reply):
            return Procedure(lambda: self._pause_file(text.replace("M108", "M24"), words))

        def gone() -> bool:
            return isinstance(reply, Session) and reply.closed

        return Procedure(lambda: self._host_pause.stand_by(text, words, gone))

    async def _pause_file(self, text: str, words: Mapping[str, float]) -> None:
        self._printer.tell(f"echo:{text}")
        self._runner.pause(words)

    def _resume(self, _: Command, __: Reply) -> Wait | None:
        if self._runner.state is State.PAUSED:
            self._runner.start()
        self._printer.go_on()
        return None
