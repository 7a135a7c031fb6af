"""Progress and time of prints, pauses that a print asks for, and filament changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.job.runner import Runner, State
from passo.printer.waits import Handler, Person, Reply, Wait
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
        """Counts from now on; a watch that was stopped begins anew."""
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
    """M31, M73, M75 to M77, M600 to M602 of one printer."""

    def __init__(self, printer: Printer, runner: Runner) -> None:
        self._printer, self._runner = printer, runner
        self._watch = Stopwatch(printer)
        self._percent: float | None = None  # M73
        self._minutes_left: float | None = None
        self.immediate: dict[str, Handler] = {
            "M31": self._time,
            "M73": self._progress,
            "M75": lambda c, r: self._timer(start=True),
            "M76": lambda c, r: self._timer(pause=True),
            "M77": lambda c, r: self._timer(),
            "M602": self._resume,
        }
        self.planned: dict[str, Handler] = {
            "M600": self._change_filament,
            "M601": self._pause,
        }
        runner.watchers.append(self._job_changed)

    def _job_changed(self, state: State) -> None:
        if state is State.PRINTING:
            if not self._watch.running and self._runner.offset == 0:
                self._watch.reset()
            self._watch.start()
        else:
            self._watch.pause()

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

    def _progress(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        self._percent = words.get("P", self._percent)
        self._minutes_left = words.get("R", self._minutes_left)
        if words:
            return None
        parts: list[str] = []
        done = self._runner.progress
        if done is not None:
            parts.append(f"{100 * done:.1f}%")
        elif self._percent is not None:
            parts.append(f"{self._percent:g}%")
        if self._minutes_left is not None:
            parts.append(f"{self._minutes_left:g} min left")
        reply.say(f"echo:Progress: {', '.join(parts) or 'nothing is printed'}")
        return None

    def _change_filament(self, _: Command, reply: Reply) -> Wait | None:
        return self._stand_by("Change the filament, then go on with M108", reply)

    def _pause(self, _: Command, reply: Reply) -> Wait | None:
        return self._stand_by("Paused; go on with M108", reply)

    def _stand_by(self, text: str, reply: Reply) -> Wait | None:
        """A file pauses and parks; a host that prints is asked to pause, and waits."""
        if self._runner.printing_from(reply):
            self._printer.tell(f"echo:{text.replace('M108', 'M24')}")
            self._runner.pause()
            return None
        self._printer.tell("//action:pause")
        return Person(text)

    def _resume(self, _: Command, __: Reply) -> Wait | None:
        if self._runner.state is State.PAUSED:
            self._runner.start()
        self._printer.go_on()
        return None
