"""The prints of one printer: its files, the running print, the queue, the history, the journal."""

from __future__ import annotations

import logging
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from passo.job.live.button_actions import ButtonActions
from passo.job.live.fan_faults import FanFaultPause
from passo.job.live.filament_runout import FilamentRunout
from passo.job.live.files import AUTOSTART, Files
from passo.job.live.halt_reports import HaltReports
from passo.job.live.host_pause import HostPause
from passo.job.live.job_status import JobStatusReader
from passo.job.live.journal_keeper import JournalKeeper
from passo.job.live.objects import PrintObjects
from passo.job.live.print_pause import PrintPause
from passo.job.live.print_queue import PrintQueue
from passo.job.live.progress import Progress
from passo.job.live.runner import Runner
from passo.job.live.runs import Runs
from passo.job.live.statistics import Statistics
from passo.printer.background_gcode import BackgroundGcode

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts
    from passo.printer.wait_requests import Reply

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Jobs:
    """The prints of one printer. `files` are what it can print, and `runner` prints the selected
    one. `runs` are the starts with a run id. `host_pause` pauses prints of hosts, `background` runs
    G-code of the machine file. `journal` resumes an interrupted print; None if nothing is
    stored."""

    control: Control
    runner: Runner
    runs: Runs
    files: Files
    objects: PrintObjects
    statistics: Statistics
    progress: Progress
    queue: PrintQueue
    host_pause: HostPause
    background: BackgroundGcode
    journal: JournalKeeper | None

    def start(self, path: str, allow: Collection[str] = (), run: str = "") -> bool:
        """Selects a file and prints it. The print may also do what the fields `allow` of Skips
        name. A `run` starts at most one print: returns True if this run id is known, and then
        nothing has started. Raises CardError, InputError, CommandError."""

        def start(run: str) -> None:
            self.files.open(path)
            self.runner.start(skips=self.control.skips.allowing(allow), run=run)

        if run:
            return self.runs.start_once(run, path, start)
        start("")
        return False

    @property
    def printed_file(self) -> str:
        """The name of the file that is printed, paused, or about to resume; empty without one."""
        return self.runner.name if self.runner.engaged else ""

    def start_by_itself(self) -> None:
        """Starts the print of `auto0.g`, unless the printer is halted or a print was
        interrupted."""
        files, journal = self.files, self.journal
        offered = journal is not None and journal.offer()
        if not offered and self.control.state.start_failure is None:
            files.autostart()
        elif files.starts_itself and journal is not None and offered:
            journal.offer_instead(AUTOSTART)
        elif files.starts_itself:
            text = f"{AUTOSTART} was not started, for the printer is halted"
            self.control.state.announce(_log, logging.WARNING, text)


def build_jobs(
    control: Control,
    parts: MachineParts,
    reply: Reply,
    *,
    card: str | None,
    folder: Path | None,
    reports: str | None,
) -> Jobs:
    """Builds the prints of one printer. `reply` receives the answers to commands of files. `card`
    is the SD card; `folder` stores the history, the queue, the journal and a report of each halt;
    without it, `reports` is the prefix of the paths of the reports."""
    runner = Runner(control, parts, reply)
    files = Files(control, runner, card)
    runs = Runs(control.state, runner, folder)  # stores an end before the history does
    statistics = Statistics(control, parts, folder)
    progress = Progress(control, parts.suspension, runner, statistics, files.reader)
    host_pause, background = HostPause(control, parts), BackgroundGcode(control)
    by_event = PrintPause(control, runner, host_pause, background)
    FilamentRunout(control, parts.inputs.filament, runner, by_event, background)
    FanFaultPause(control.state, parts.tachometers, by_event, background)
    ButtonActions(control, parts.inputs.buttons, runner, by_event, background)
    objects = PrintObjects(control.rig, control.dispatch, runner)
    journal = None
    if folder is not None:
        journal = JournalKeeper(control, parts, runner, files, objects, folder)
    stem = folder / "halt" if folder is not None else Path(reports) if reports else None
    if stem is not None:
        HaltReports(control, parts.settings, runner, progress, stem)
    queue = PrintQueue(control.state, runner, files, folder)
    JobStatusReader(control, runner, progress, objects, files, statistics)
    return Jobs(
        *(
            control,
            runner,
            runs,
            files,
            objects,
            statistics,
            progress,
            queue,
            host_pause,
            background,
        ),
        journal,
    )
