"""Writes a report at each halt of a printer, for a user who asks for help."""

from __future__ import annotations

import asyncio
import logging
import re
import traceback
from collections.abc import Generator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.machine_text import machine_text
from passo.errors import PassoError
from passo.job.durable_files import replaced
from passo.job.live.halt_report_text import HaltReport, JobMoment
from passo.printer.watch.heater_history import HeaterHistory

if TYPE_CHECKING:
    from passo.job.live.progress import Progress
    from passo.job.live.runner import Runner
    from passo.printer.control import Control
    from passo.printer.live_rig import LiveRig
    from passo.printer.settings import Settings
    from passo.printer.state import State

_log = logging.getLogger(__name__)

KEPT_FILES = 10
# delay before the frames are read: time for the stop command and the answers of the boards
AFTER_S = 0.5


class _Halt:
    """The data that must be copied at the moment of a halt."""

    def __init__(
        self,
        rig: LiveRig,
        state: State,
        host_s: float,
        job: JobMoment,
        history: HeaterHistory,
        cause: PassoError,
    ) -> None:
        self.when = datetime.now().astimezone()
        self.host_s = host_s
        self.print_s = rig.queue.now_s
        self.why = state.why_halted
        self.cause = cause
        self.job = job
        self.heaters = [*history.samples(), (self.print_s, history.now())]
        # A restart replaces the connections, so keep these, which have the recorded frames.
        self.connections = [(c, c.host_ticks) for c in rig.connection.connections]


class HaltReports:
    """Writes `STEM-0001-DATE-TIME.txt` at a halt, then 0002 and so on, and keeps the last ten.

    A thread writes it half a second after the halt, so that the printer does not wait for the disk.
    A report is written even if the printer restarts or the program ends. All consoles and the log
    receive its path. A report that cannot be written causes only a warning.
    """

    def __init__(
        self,
        control: Control,
        settings: Settings,
        runner: Runner,
        progress: Progress,
        stem: Path,
    ) -> None:
        self._rig, self._state, self._settings = control.rig, control.state, settings
        self._runner, self._progress = runner, progress
        self._stem = stem
        self._history = HeaterHistory(control.rig)
        self._loop = asyncio.get_running_loop()
        self._writing = asyncio.Lock()
        self._pending: dict[_Halt, asyncio.Task[None]] = {}
        control.lifetime.as_time_passes(self._history.time_passed)
        control.state.halt_listeners.append(self._halted)
        control.lifetime.at_end(self._close)

    def _halted(self, cause: PassoError) -> None:
        if cause.problems[0].code == "machine.restart":
            return  # the cause is not a failure
        try:
            halt = _Halt(
                self._rig, self._state, self._loop.time(), self._job(), self._history, cause
            )
        except Exception:  # a failed report must not disturb the halt
            self._failed(exc_info=True)
        else:
            self._pending[halt] = self._loop.create_task(self._write_later(halt))

    def _job(self) -> JobMoment:
        runner, rig = self._runner, self._rig
        return JobMoment(
            runner.state.name.lower(),
            runner.name,
            rig.job.history.line_at(rig.queue.passed) if runner.active else 0,
            runner.offset if runner.file.reader else 0,
            runner.size,
            self._progress.printed_s,
        )

    async def _write_later(self, halt: _Halt) -> None:
        await asyncio.sleep(AFTER_S)
        async with self._writing:
            with self._failures():
                del self._pending[halt]
                report = self._gathered(halt)
                self._written(await asyncio.to_thread(_write, report, self._stem))

    def _close(self) -> None:
        """Call this at the end of the event loop: writes the reports that are still pending."""
        for halt, task in self._pending.items():
            task.cancel()
            with self._failures():
                self._written(_write(self._gathered(halt), self._stem))

    @contextmanager
    def _failures(self) -> Generator[None]:
        """Turns an error within the block into a warning."""
        try:
            yield
        except OSError as error:
            self._failed(error.strerror or str(error))
        except Exception:
            self._failed(exc_info=True)

    def _gathered(self, halt: _Halt) -> HaltReport:
        machine, state = self._rig.machine, self._state
        return HaltReport(
            when=halt.when.isoformat(timespec="milliseconds"),
            host_s=halt.host_s,
            print_s=halt.print_s,
            why=halt.why,
            problems=halt.cause.problems,
            trace=_trace(halt.cause),
            printer=machine.name,
            job=halt.job,
            console_lines=[
                line for line in state.console_lines.last() if line.host_s <= halt.host_s
            ],
            heaters=halt.heaters,
            frames=[c.recorded_frames(ticks) for c, ticks in halt.connections],
            settings=list(self._settings.lines()),
            machine=machine_text(machine),
        )

    def _written(self, path: Path) -> None:
        text = f"The report of this halt is in {path}. Attach it when you ask for help"
        self._state.announce(_log, logging.INFO, text)

    def _failed(self, reason: str = "an error of the program", *, exc_info: bool = False) -> None:
        text = f"The report of this halt could not be written: {reason}"
        _log.warning("%s", text, exc_info=exc_info)
        self._state.tell(f"echo:{text}")


def _trace(cause: PassoError) -> str:
    """The traceback of a fault of the program; empty for any other cause."""
    fault = cause.__cause__
    return "" if fault is None else "".join(traceback.format_exception(fault))


def _write(report: HaltReport, stem: Path) -> Path:
    """Writes the next file, and removes all but the last ten. Raises OSError."""
    before = _reports(stem)
    number = 1 + max(before, default=0)
    stamp = re.sub(r"[-:]|\..*", "", report.when).replace("T", "-")
    path = stem.with_name(f"{stem.name}-{number:04d}-{stamp}.txt")
    with replaced(path) as temporary:
        text = report.text().replace(f"{Path.home()}/", "~/")  # the path contains the user's name
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace")
    for old in sorted(before)[: max(0, len(before) + 1 - KEPT_FILES)]:
        for file in before[old]:
            with suppress(OSError):
                file.unlink()
    return path


def _reports(stem: Path) -> dict[int, list[Path]]:
    """The existing reports, by number."""
    name = re.compile(rf"{re.escape(stem.name)}-(\d{{4,}})-\d{{8}}-\d{{6}}\.txt")
    found: dict[int, list[Path]] = {}
    for path in stem.parent.iterdir():
        if match := name.fullmatch(path.name):
            found.setdefault(int(match[1]), []).append(path)
    return found
