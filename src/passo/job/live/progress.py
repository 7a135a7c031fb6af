"""The progress of a print from the card or from a host: time, layers, filament."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.card import Reader as CardReader
from passo.errors import PassoError
from passo.job.batch.forecast import Forecast, forecast
from passo.job.live.job_state import JobState
from passo.job.live.runner import Runner
from passo.job.live.slicer_layers import SlicerLayers
from passo.job.live.statistics import Print, Statistics

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.live_rig import LiveRig
    from passo.printer.suspension import Suspension

_log = logging.getLogger(__name__)

_HOST = "(a host's)"  # name of a host's print without a name


class Stopwatch:
    """Print time that counts only while it runs."""

    def __init__(self, rig: LiveRig) -> None:
        self._rig = rig
        self._sum_s = 0.0
        self._since_s: float | None = None

    @property
    def seconds(self) -> float:
        """The counted time so far, in seconds."""
        running = 0.0 if self._since_s is None else self._rig.queue.now_s - self._since_s
        return self._sum_s + running

    def start(self) -> None:
        """Starts or continues to count."""
        if self._since_s is None:
            self._since_s = self._rig.queue.now_s

    def pause(self) -> None:
        """Stops counting until `start`."""
        self._sum_s, self._since_s = self.seconds, None

    def reset(self) -> None:
        """Stops counting, and resets the time to 0."""
        self._sum_s, self._since_s = 0.0, None


class Progress:
    """The progress of the current or the last print, from a file or from a host that reports it.

    `percent` and `minutes_left` are the values from the file or the host (M73, M532), or None.
    """

    def __init__(
        self,
        control: Control,
        suspension: Suspension,
        runner: Runner,
        statistics: Statistics,
        open_again: Callable[[str], CardReader],
    ) -> None:
        self._rig, self._state, self._suspension = control.rig, control.state, suspension
        self._runner, self._statistics = runner, statistics
        self._open_again = open_again
        self._forecast: asyncio.Task[Forecast | None] | None = None
        self._planned_s = 0.0  # planned time before this print
        self._watch = Stopwatch(control.rig)
        self._extrusion = Stopwatch(control.rig)  # since the first extrusion of the print
        self._has_extruded = False
        self._from_card: Print | None = None
        self._loop = asyncio.get_running_loop()
        self._begun_s: float | None = None  # host time at the start of the print
        self._last = 0.0, 0.0  # elapsed s and filament mm of the last print
        self._failed: Print | None = None  # the last print from the card, if it has failed
        self._from_host: Print | None = None  # the print of a host that reports its start and end
        self.percent: float | None = None
        self.minutes_left: float | None = None
        self.slicer_layers = SlicerLayers()
        runner.watchers.append(self._job_changed)
        control.state.stop_listeners.append(self._stopped)
        control.lifetime.at_end(self._close)
        control.lifetime.as_time_passes(self._time_passed)

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state.prints:
            if was.prints:
                return
            if self._from_card is None:
                self._from_card = self._begun()
                self._begun_s = self._loop.time()
                self._planned_s = self._rig.planned_s()
                self._start_forecast()
            self._watch.start()
            if self._has_extruded:
                self._extrusion.start()
            return
        if self._from_card is not None:
            self._watch.pause()
            self._extrusion.pause()
            if state is not JobState.PAUSED:
                self._last = self.elapsed_s, self.filament_mm
                job, self._from_card, self._begun_s = self._from_card, None, None
                self._statistics.ended(job, self._runner.ended, self._runner.failed)
                if self._runner.ended != "done" and self._forecast is not None:
                    self._forecast.cancel()  # closes the file
                self._failed = job if self._runner.ended == "failed" else None
                if self._failed is None:
                    self.percent = self.minutes_left = None

    def _begun(self) -> Print:
        """The print from the card that starts now, or continues after a failure."""
        name, failed = self._runner.name, self._failed
        if failed is not None and failed.name == name and self._runner.offset > 0:
            return self._statistics.goes_on(failed)
        self.percent = self.minutes_left = None
        self.slicer_layers = SlicerLayers()
        meant, self._from_host = self._from_host, None  # a host has announced this print
        self._watch.reset()
        self._extrusion.reset()
        self._has_extruded = not self._rig.machine.extruders
        size, run = self._runner.size, self._runner.run
        return self._statistics.begun(name, lambda: self._watch.seconds, size, meant, run)

    def _time_passed(self) -> None:
        job = self._from_card
        if job is None or self._has_extruded or not self._runner.state.prints:
            return
        if self._suspension.filament_mm() > job.filament_mm:
            self._has_extruded = True
            self._extrusion.start()

    def _close(self) -> None:
        if self._forecast is not None:
            self._forecast.cancel()
        self._host_ends("cancelled")
        self._statistics.close()

    def _host_begins(self) -> None:
        """Called when a host's print begins. If a print was announced and has not begun, it is this
        one; otherwise an earlier print was interrupted."""
        before = self._from_host
        if before is not None and self._suspension.filament_mm() > before.filament_mm:
            self._host_ends("interrupted")
        self._watch.reset()
        self._from_host = self._statistics.begun(
            _HOST, lambda: self._watch.seconds, instead=self._from_host
        )

    def _host_ends(self, how: str, reason: str = "") -> None:
        """Called when a host's print ends. The stopwatch stops, and keeps its time until the next
        print."""
        job, self._from_host = self._from_host, None
        if job is not None:
            self._watch.pause()
            self._statistics.ended(job, how, reason)

    def _stopped(self, reason: str) -> None:
        """Called when the machine is stopped. After M410, a print of a host may continue; after a
        halt, none does."""
        if self._state.halted:
            self._host_ends("failed", reason)

    def _start_forecast(self) -> None:
        if self._forecast is not None:
            self._forecast.cancel()
        try:
            reader = self._open_again(self._runner.path)
        except PassoError:
            self._forecast = None
            return
        loop = asyncio.get_running_loop()
        self._forecast = loop.create_task(forecast(self._rig.machine, reader, self._runner.offset))
        self._forecast.add_done_callback(self._report_load)

    def _report_load(self, task: asyncio.Task[Forecast | None]) -> None:
        """Reports the load of the file on the board, when the forecast is ready."""
        found = None if task.cancelled() else task.result()
        for sentence in found.budget.report_lines(self._runner.name) if found else ():
            self._state.announce(_log, logging.INFO, sentence)

    @property
    def printed_s(self) -> float:
        """The print time of the current or the last print, in seconds, without pauses."""
        return self._watch.seconds

    @property
    def extruding_s(self) -> float:
        """The part of `printed_s` since the first extrusion of the print; equal to `printed_s` on a
        machine without filament."""
        return self._extrusion.seconds

    @property
    def elapsed_s(self) -> float:
        """The host time of the current or the last print, in seconds, including pauses."""
        return self._last[0] if self._begun_s is None else self._loop.time() - self._begun_s

    @property
    def filament_mm(self) -> float:
        """The filament of all extruders for the current or the last print, mm."""
        job = self._from_card
        return self._last[1] if job is None else self._suspension.filament_mm() - job.filament_mm

    @property
    def layers(self) -> int | None:
        """The number of layers of the file that is being printed; None while unknown."""
        found = self._found()
        return found.layers if found else None

    @property
    def left_s(self) -> float | None:
        """The print time of the remaining moves of the file, in seconds; None while unknown."""
        times = self.times()
        return None if times is None else times[1] - times[0]

    def _found(self) -> Forecast | None:
        task = self._forecast
        if not self._runner.active or task is None or not task.done() or task.cancelled():
            return None
        return task.result()

    def times(self) -> tuple[float, float] | None:
        """The seconds of motion, done and in total; None if unknown."""
        found = self._found()
        if not found or not found.seconds:
            return None
        total = found.seconds
        ahead = max(0.0, self._rig.queue.ahead_s)
        done = found.before_s + self._rig.planned_s() - self._planned_s - ahead
        return min(max(done, 0.0), total), total

    def share_done(self) -> float | None:
        """The fraction of the print that is done, 0 to 1, from the best available source: print
        time, values of the file or the host (M73, M532), or bytes. None without a source."""
        times = self.times()
        if times is not None:
            return times[0] / times[1]
        return self._runner.progress if self.percent is None else self.percent / 100

    # -- prints of a host, and the stopwatch ------------------------------------------------------

    def host_print(self, *, begins: bool) -> None:
        """Handles the report of a host that its print begins or ends."""
        self.percent = self.minutes_left = None
        if self._from_card is None and begins:
            self._host_begins()
            self._watch.start()
        elif self._from_card is None:
            self._host_ends("done")

    def name_host_print(self, name: str) -> None:
        """Handles the report of a host with the name of its print."""
        if self._from_host is not None:
            self._from_host.name = name or _HOST

    def timer(self, *, runs: bool) -> None:
        """Starts or pauses the stopwatch of a host's print. A print from a file has its own
        stopwatch."""
        if self._from_card is not None:
            return
        if runs:
            if self._from_host is None:
                self._host_begins()
            self._watch.start()
        else:
            self._watch.pause()

    def stop_timer(self) -> None:
        """Ends a host's print, and stops its stopwatch."""
        if self._from_card is None:
            self._host_ends("done")
            self._watch.reset()
