"""Reads the typed status of a printer with its job, once for all who show it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.job.live.job_state import JobState
from passo.printer.status import (
    JobStatus,
    PrinterState,
    Status,
    heater_status,
    homed_axes,
)

if TYPE_CHECKING:
    from passo.job.live.objects import PrintObjects
    from passo.job.live.progress import Progress
    from passo.job.live.runner import Runner
    from passo.printer.printer import Printer


class StatusReader:
    """The status of one printer; reading it asks no board and lets no time pass."""

    def __init__(
        self, printer: Printer, runner: Runner, jobs: Progress, objects: PrintObjects
    ) -> None:
        self._printer, self._runner, self._progress = printer, runner, jobs
        self._objects = objects

    def read(self) -> Status:
        """The printer now."""
        printer, job = self._printer, self._printer.job
        return Status(
            state=self._state(),
            halted=printer.halted,
            time_s=max(printer.drive.now_s, 0.0),
            position_mm={k.lower(): mm for k, mm in printer.positions.shown().items()},
            homed=homed_axes(printer),
            tool=job.tool,
            heaters={name: heater_status(printer, name) for name in printer.machine.heaters},
            fans={n: printer.commands.fans.get(n, 0.0) for n in printer.machine.fans},
            speed_factor=job.speed_factor,
            flow_factors=list(job.flows),
            progress=self._progress.share_done(),
            job=self._job(),
        )

    def _state(self) -> PrinterState:
        printer = self._printer
        if printer.halted:
            return PrinterState.HALTED
        if self._runner.state is JobState.PAUSED:
            return PrinterState.PAUSED
        if self._runner.active:
            return PrinterState.PRINTING
        busy = printer.turn.taken or not printer.drive.idle
        return PrinterState.BUSY if busy else PrinterState.IDLE

    def _job(self) -> JobStatus | None:
        if not self._runner.active:
            return None
        job, now = self._printer.job, self._printer.drive.passed
        line = job.line_at(now)  # what lies behind it is forgotten
        return JobStatus(
            file=self._runner.name,
            fraction=self._progress.share_done() or 0.0,
            line=line,
            layer=job.layer_near(now) if line else 0,
            layers=self._progress.layers,
            printed_s=self._progress.printed_s,
            left_s=self._progress.left_s,
            objects=self._objects.all,
            current_object=self._objects.current,
        )
