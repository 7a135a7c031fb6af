"""Adds the print to the status of a printer."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from passo.job.live.job_state import JobState
from passo.printer.fault_status import faults_of
from passo.printer.status import EndedJob, FilesStatus, JobStatus, PrinterState, Status

if TYPE_CHECKING:
    from passo.job.live.files import Files
    from passo.job.live.objects import PrintObjects
    from passo.job.live.progress import Progress
    from passo.job.live.runner import Runner
    from passo.job.live.statistics import Statistics
    from passo.printer.control import Control


class JobStatusReader:
    """Adds the current and the last print from a file, and the card."""

    def __init__(
        self,
        control: Control,
        runner: Runner,
        progress: Progress,
        objects: PrintObjects,
        files: Files,
        statistics: Statistics,
    ) -> None:
        self._rig, self._runner, self._progress = control.rig, runner, progress
        self._objects, self._files, self._statistics = objects, files, statistics
        self._ended: EndedJob | None = None
        runner.watchers.append(self._job_changed)
        control.state.status_parts.append(self._add)

    def _add(self, status: Status) -> Status:
        runner, files = self._runner, self._files
        state = status.state
        if state is not PrinterState.HALTED and runner.active:
            paused = runner.state is JobState.PAUSED
            state = PrinterState.PAUSED if paused else PrinterState.PRINTING
        return replace(
            status,
            state=state,
            files=FilesStatus(files.mounted, runner.path, str(files.folder or "")),
            progress=self._progress.share_done(),
            job=self._job_status() if runner.active else None,
            ended=self._ended if runner.ended else None,
            last_print=self._statistics.last_print,
        )

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if was.active and not state.active:
            runner = self._runner
            problems = faults_of(runner.problems)
            self._ended = EndedJob(runner.ended, runner.failed, self._job_status(), problems)

    def _job_status(self) -> JobStatus:
        runner, progress = self._runner, self._progress
        job, now = self._rig.job, self._rig.queue.passed
        line = job.history.line_at(now)  # drops past lines
        return JobStatus(
            file=runner.name,
            fraction=progress.share_done() or 0.0,
            line=line,
            layer=job.history.layer_near(now) if line else 0,
            layers=progress.layers,
            printed_s=progress.printed_s,
            left_s=progress.left_s,
            objects=self._objects.all,
            current_object=self._objects.current,
            path=runner.path,
            size=runner.size,
            offset=runner.offset,
            elapsed_s=progress.elapsed_s,
            filament_mm=progress.filament_mm,
            extruding_s=progress.extruding_s,
            slicer_layer=progress.slicer_layers.current,
            slicer_layers=progress.slicer_layers.total,
            run=runner.run,
        )
