"""Progress and time of prints, pauses that a print asks for, and filament changes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from passo.card import Reader as CardReader
from passo.console.session import Session
from passo.errors import CommandError, PassoError
from passo.gcode.command import Command
from passo.job.batch.forecast import Forecast, forecast
from passo.job.live.host_pause import HostPause
from passo.job.live.job_state import JobState
from passo.job.live.park import check_words
from passo.job.live.runner import Runner
from passo.job.live.statistics import Print, Statistics, spoken
from passo.printer.wait_requests import Handler, Procedure, Reply, Wait

if TYPE_CHECKING:
    from passo.printer.printer import Printer


_HOST = "(a host's)"  # name of a print that has no other


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


class JobCommands:
    """M31, M73, M75 to M77, M530 to M532, M600 to M602 of one printer."""

    def __init__(
        self,
        printer: Printer,
        runner: Runner,
        statistics: Statistics,
        open_again: Callable[[str], CardReader],
    ) -> None:
        self._printer, self._runner, self._statistics = printer, runner, statistics
        self._open_again = open_again
        self._host_pause = HostPause(printer)
        self._forecast: asyncio.Task[Forecast | None] | None = None
        self._planned_s = 0.0  # before this print
        self._watch = Stopwatch(printer)
        self._from_card: Print | None = None
        self._failed: Print | None = None  # the last one from the card, if so it ended
        self._from_host: Print | None = None  # that says by itself when it begins and ends
        self._percent: float | None = None  # M73
        self._minutes_left: float | None = None
        self.immediate: dict[str, Handler] = {
            "M31": self._time,
            "M73": self._progress,
            "M75": lambda c, r: self._timer(start=True),
            "M76": lambda c, r: self._timer(pause=True),
            "M77": lambda c, r: self._timer(),
            "M530": self._host_print,
            "M531": self._host_name,
            "M532": self._host_progress,
            "M602": self._resume,
            "M876": self._answer,
        }
        self.planned: dict[str, Handler] = {
            "M600": self._change_filament,
            "M601": self._pause,
        }
        printer.state.end_asking = self._end_asking
        runner.watchers.append(self._job_changed)
        printer.state.stop_listeners.append(self._stopped)
        printer.closers.append(self._close)

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state is JobState.PAUSED:
            self._printer.tell("// action:paused")
        elif was is JobState.PAUSED:
            self._printer.prompts.answered()
            if state.prints:
                self._printer.tell("// action:resumed")
        if state.prints:
            if was.prints:
                return
            if self._from_card is None:
                self._from_card = self._begun()
                self._planned_s = self._printer.planned_s()
                self._reckon()
            self._watch.start()
            return
        if self._from_card is not None:
            self._watch.pause()
            if state is not JobState.PAUSED:
                job, self._from_card = self._from_card, None
                self._statistics.ended(job, self._runner.ended)
                self._failed = job if self._runner.ended == "failed" else None
                if self._failed is None:
                    self._percent = self._minutes_left = None

    def _begun(self) -> Print:
        """The print from the card that begins, or goes on behind what has failed."""
        name, failed = self._runner.name, self._failed
        if failed is not None and failed.name == name and self._runner.offset > 0:
            return self._statistics.goes_on(failed)
        self._percent = self._minutes_left = None
        meant, self._from_host = self._from_host, None  # a host has announced this one
        self._watch.reset()
        return self._statistics.begun(name, lambda: self._watch.seconds, self._runner.size, meant)

    def _close(self) -> None:
        if self._forecast is not None:
            self._forecast.cancel()
        self._host_ends("cancelled")
        self._statistics.close()

    def _host_begins(self) -> None:
        """One that was announced, and has not begun yet, is the same; else it was broken off."""
        before = self._from_host
        if before is not None and self._printer.filament_mm() > before.filament_mm:
            self._host_ends("interrupted")
        self._watch.reset()
        self._from_host = self._statistics.begun(
            _HOST, lambda: self._watch.seconds, instead=self._from_host
        )

    def _host_ends(self, how: str) -> None:
        """The watch stands, and is read until the next print."""
        job, self._from_host = self._from_host, None
        if job is not None:
            self._watch.pause()
            self._statistics.ended(job, how)

    def _stopped(self, _: str) -> None:
        """M410 may be a host's own; after a halt nothing goes on."""
        if self._printer.halted:
            self._host_ends("failed")

    def _reckon(self) -> None:
        if self._forecast is not None:
            self._forecast.cancel()
        try:
            reader = self._open_again(self._runner.path)
        except PassoError:
            self._forecast = None
            return
        loop = asyncio.get_running_loop()
        self._forecast = loop.create_task(
            forecast(self._printer.machine, reader, self._runner.offset)
        )
        self._forecast.add_done_callback(self._foretell)

    def _foretell(self, task: asyncio.Task[Forecast | None]) -> None:
        """What the file will ask of the board, when that is known."""
        found = None if task.cancelled() else task.result()
        for sentence in found.budget.told(self._runner.name) if found else ():
            self._printer.tell(f"echo:{sentence}")

    @property
    def printed_s(self) -> float:
        """Print time of the print that is under way, or was the last, without pauses."""
        return self._watch.seconds

    @property
    def layers(self) -> int | None:
        """Layers of the file that is printed; None while that is not known."""
        found = self._found()
        return found.layers if found else None

    @property
    def left_s(self) -> float | None:
        """Print time that the rest of the file's moves takes; None while that is not known."""
        times = self._times()
        return None if times is None else times[1] - times[0]

    def _found(self) -> Forecast | None:
        task = self._forecast
        if not self._runner.active or task is None or not task.done() or task.cancelled():
            return None
        return task.result()

    def _times(self) -> tuple[float, float] | None:
        """Seconds of motion done and in all; None if not known."""
        found = self._found()
        if not found or not found.seconds:
            return None
        total = found.seconds
        ahead = max(0.0, self._printer.drive.ahead_s)
        done = found.before_s + self._printer.planned_s() - self._planned_s - ahead
        return min(max(done, 0.0), total), total

    def share_done(self) -> float | None:
        """Of the print, 0 to 1, by the best that is known: its time, what the file or the host says
        of it (M73, M532), its bytes. None if nothing is known of one."""
        times = self._times()
        if times is not None:
            return times[0] / times[1]
        return self._runner.progress if self._percent is None else self._percent / 100

    def _time(self, _: Command, reply: Reply) -> Wait | None:
        reply.say(f"echo:Print time {spoken(self._watch.seconds)}")
        return None

    def _timer(self, *, start: bool = False, pause: bool = False) -> Wait | None:
        """A print from the card is timed by itself, whatever its file says."""
        if self._from_card is None:
            if start and self._from_host is None:
                self._host_begins()
            if start:
                self._watch.start()
            else:
                self._watch.pause()
        if not (start or pause):
            self._printer.tell(f"echo:Print time {spoken(self._watch.seconds)}")
            if self._from_card is None:
                self._host_ends("done")
                self._watch.reset()
        return None

    def _host_print(self, command: Command, reply: Reply) -> Wait | None:
        """A host says that its print begins or ends."""
        begins = command.words().get("S", 0) > 0
        self._percent = self._minutes_left = None
        if self._from_card is None and begins:
            self._host_begins()
            self._watch.start()
        elif self._from_card is None:
            self._host_ends("done")
        reply.say("echo:Start Printing" if begins else "echo:Stop Printing")
        return None

    def _host_name(self, command: Command, _: Reply) -> Wait | None:
        if self._from_host is not None:
            self._from_host.name = command.text.strip() or _HOST
        return None

    def _host_progress(self, command: Command, _: Reply) -> Wait | None:
        words = command.words()
        if "X" in words:
            self._percent = _percent(words["X"])
        return None

    def _progress(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if "P" in words:
            self._percent = _percent(words["P"])
        if "R" in words:
            self._minutes_left = max(words["R"], 0.0)
        if words:
            return None
        parts: list[str] = []
        times, share = self._times(), self.share_done()
        if share is not None:
            parts.append(f"{round(100 * share, 1):g}%")
        if times is not None:
            parts.append(f"{(times[1] - times[0]) / 60:.1f} min left")
        elif share is not None and self._percent is None:
            parts[0] += " of the file"
        if self._minutes_left is not None and times is None:
            parts.append(f"{self._minutes_left:g} min left")
        reply.say(f"echo:Progress: {', '.join(parts) or 'nothing is printed'}")
        return None

    def _change_filament(self, command: Command, reply: Reply) -> Wait | None:
        """Raises CommandError for a tool that is not in use, what its hotend cannot reach, and
        where the nozzle cannot go."""
        words = command.words()
        check_words(words, self._printer.machine)
        tool = self._printer.job.tool
        if words.get("T", tool) != tool:
            raise CommandError.bad_value("T", words["T"], f"{tool}, the tool in use")
        if "S" in words:
            hotend = self._printer.machine.heaters[self._printer.commands.heater("hotend")]
            if not hotend.min_c < words["S"] <= hotend.max_c:
                limit = f"{hotend.min_c:g} to {hotend.max_c:g} C"
                raise CommandError.bad_value("S", words["S"], limit)
        if "B" in words and self._printer.machine.beeper is None:
            reply.note("M600 B", "M600 beeps not: there is no beeper")
        return self._stand_by("Change the filament, then go on with M108", words, reply)

    def _pause(self, _: Command, reply: Reply) -> Wait | None:
        return self._stand_by("Paused; go on with M108", {}, reply)

    def _stand_by(self, text: str, words: Mapping[str, float], reply: Reply) -> Wait | None:
        """A file pauses and parks, whoever says so; in its pause the nozzle only leaves the place
        where it stands. A host that prints is asked to pause, and waits."""

        def gone() -> bool:
            return isinstance(reply, Session) and reply.gone

        async def stand_by() -> None:
            if self._runner.stands_aside():
                await self._host_pause.step_aside(self._runner.park, text, words, gone)
            elif self._runner.active:
                self._pause_file(text.replace("M108", "M24"), words)
            else:
                await self._host_pause.stand_by(text, words, gone)

        return Procedure(stand_by)

    def _pause_file(self, text: str, words: Mapping[str, float]) -> None:
        self._printer.tell(f"echo:{text}")
        self._runner.pause(words)
        self._printer.prompts.ask(text, awaited=False)

    def _answer(self, command: Command, reply: Reply) -> Wait | None:
        """M876: of a wait it acted when the line came in. Raises CommandError."""
        words = command.words()
        if "S" in words and self._asks:
            self._runner.start()
        elif not words.keys() & {"S", "P"}:
            reply.say("M876 P1")
        return None

    @property
    def _asks(self) -> bool:
        """The file's pause has asked somebody to go on."""
        person = self._printer.prompts
        return self._runner.state is JobState.PAUSED and person.asking and not person.awaited

    def _end_asking(self) -> None:
        if self._asks:
            try:
                self._runner.start()
            except PassoError as error:
                self._printer.tell(f"echo:{error}")

    def _resume(self, _: Command, __: Reply) -> Wait | None:
        """M602: of a wait for a person it acted when the line came in. Raises CommandError."""
        if self._runner.state is JobState.PAUSED:
            self._runner.start()
        return None


def _percent(given: float) -> float:
    return min(max(given, 0.0), 100.0)
