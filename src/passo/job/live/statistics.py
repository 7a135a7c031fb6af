"""M78: totals of prints from the card and by hosts, and the time for which the printer was on."""

from __future__ import annotations

import logging
import sqlite3
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import number
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.live.history import History, PrintRow
from passo.printer.status import LastPrint
from passo.printer.wait_requests import Reply, Wait

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)

STORE_EVERY_S = 600.0  # interval at which the on-time is stored
# interval at which the progress of a print is stored, in case of an interruption
_PRINT_EVERY_S = 60.0
_SHOWN = 5


def spoken(seconds: float) -> str:
    """A duration as `1h 2m 3s`."""
    whole = int(seconds)
    return f"{whole // 3600}h {whole // 60 % 60}m {whole % 60}s"


@dataclass(slots=True)
class Print:
    """A print in progress. `filament_mm` is the filament total before it; `seconds` returns its
    duration so far."""

    name: str
    size: int
    filament_mm: float
    seconds: Callable[[], float]
    row: int | None = None  # its row in the history
    run: str = ""  # the run id of its start


class Statistics:
    """Keeps the history of one printer in `directory`; None keeps nothing."""

    def __init__(self, control: Control, parts: MachineParts, directory: Path | None) -> None:
        self._rig, self._state = control.rig, control.state
        self._suspension, self._lateness = parts.suspension, parts.lateness
        self._history: History | None = None
        self._missing = CommandError.of("settings.nowhere")
        self._on_s = self._stored_s = 0.0
        self._seen_s = self._noted_s = control.rig.queue.now_s
        self._job: Print | None = None  # the current print
        self.last_print: LastPrint | None = None  # the newest finished print
        if directory is None:
            return
        try:
            self._history = History(directory)
            for row in self._history.last(1):
                self.last_print = _shown(row)
        except (sqlite3.Error, OSError) as error:
            self._missing = _unusable(directory, error)
            text = f"No history of prints: {error}"
            self._state.announce(_log, logging.WARNING, text)
            return
        control.lifetime.as_time_passes(self._time_passed)

    def begun(
        self,
        name: str,
        seconds: Callable[[], float],
        size: int = 0,
        instead: Print | None = None,
        run: str = "",
    ) -> Print:
        """Records that a print has begun. If a host has announced the print earlier, `instead` is
        that record, which is continued. `run` is the run id of the start. If the program is killed,
        the history shows the print as interrupted."""
        self._lateness.reset()
        row = instead.row if instead is not None else None
        _log.info("Print of %s started", name, extra={"file": name})
        self._job = Print(name, size, self._suspension.filament_mm(), seconds, row, run)
        self._note(self._job, "interrupted")
        return self._job

    def goes_on(self, job: Print) -> Print:
        """Records that a failed print has resumed; it stays the same print."""
        self._job = job
        _log.info("Print of %s resumed", job.name, extra={"file": job.name})
        self._note(job, "interrupted")
        return job

    def ended(self, job: Print, how: str, reason: str = "") -> None:
        """Records the end of a print: done, cancelled or failed, and the reason of a failure."""
        self._job = None
        filament_mm = self._suspension.filament_mm() - job.filament_mm
        _log.info(
            "Print of %s %s after %s, %.0f mm of filament",
            *(job.name, how, spoken(job.seconds()), filament_mm),
            extra={"file": job.name, "outcome": how, "seconds": round(job.seconds(), 3)},
        )
        self._note(job, how, reason)
        number = job.row or (self.last_print.number if self.last_print else 0) + 1
        self.last_print = _last_print(number, job.name, job.run, how, reason)

    def _note(self, job: Print, how: str, reason: str = "") -> None:
        self._noted_s = self._rig.queue.now_s
        if self._history is None:
            return
        used = self._suspension.filament_mm() - job.filament_mm
        note = ". ".join(filter(None, (reason, self._lateness.worst)))
        try:
            job.row = self._history.add(
                *(job.name, job.size, how, job.seconds(), used, note, job.row, job.run)
            )
        except sqlite3.Error as error:
            text = f"This print is not in the history: {error}"
            self._state.announce(_log, logging.WARNING, text)

    def _time_passed(self) -> None:
        before, self._seen_s = self._seen_s, self._rig.queue.now_s
        self._on_s += max(self._seen_s - before, 0.0)  # the board's clock may restart
        if self._job is not None and abs(self._seen_s - self._noted_s) > _PRINT_EVERY_S:
            self._note(self._job, "interrupted")
        if self._on_s < self._stored_s + STORE_EVERY_S:
            return
        try:
            self._store()
        except sqlite3.Error as error:
            text = f"How long the printer was on is not stored: {error}"
            self._state.announce(_log, logging.WARNING, text)

    def _store(self) -> None:
        assert self._history is not None
        self._stored_s = self._on_s
        self._history.was_on(self._on_s)

    def close(self) -> None:
        """Stops recording."""
        if self._history is not None:
            if self._job is not None:
                self._note(self._job, "interrupted")
            # no console can show the error; the last minutes are lost
            with suppress(sqlite3.Error):
                self._store()
            self._history.close()

    def last(self, most: int) -> list[PrintRow]:
        """The last finished prints, newest first. Raises CommandError."""
        if self._history is None:
            raise self._missing
        try:
            return self._history.last(most, self._job.row if self._job is not None else None)
        except sqlite3.Error as error:
            raise _unusable(None, error) from None

    @command(
        "M78",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Reports the print statistics; S78 clears them.",
        number("S", "78: clears them"),
        kind=Kind.QUIET,
    )
    def _statistics(self, command: Command, reply: Reply) -> Wait | None:
        """M78: reports the totals, or deletes the history."""
        if self._history is None:
            reply.say(f"echo:{self._missing}")
            return None
        try:
            for line in self._lines(self._history, command.words().get("S") == 78):
                reply.say(line)
        except sqlite3.Error as error:
            reply.say(f"echo:{_unusable(None, error)}")
        return None

    def _lines(self, history: History, forget: bool) -> list[str]:
        if forget:
            history.forget()
            self.last_print = None
            self._on_s = self._stored_s = 0.0
            return []
        self._store()
        but = self._job.row if self._job is not None else None
        totals, last = history.totals(but), history.last(_SHOWN, but)
        lines = [
            f"echo:Prints: {totals.prints}, finished: {totals.done},"
            f" failed or cancelled: {totals.prints - totals.done}",
            f"echo:Print time: {spoken(totals.print_s)}, longest: {spoken(totals.longest_s)},"
            f" filament: {totals.filament_mm / 1000:.2f}m",
        ]
        for row in last:
            lines.append(f"echo:  {row.file}: {row.ended}, {spoken(row.print_s)}")
            if row.note:
                lines.append(f"echo:    {row.note}")
        return [*lines, f"echo:Power on: {spoken(totals.on_s)}"]


def _unusable(directory: Path | None, error: Exception) -> CommandError:
    return CommandError.of("history.unusable", str(directory or ""), value=error)


def _shown(row: PrintRow) -> LastPrint:
    """A row of the history; one that is not complete was interrupted."""
    reason = "Passo ended during the print" if row.ended == "interrupted" else row.note
    return _last_print(row.number, row.file, row.run, row.ended, reason)


def _last_print(number: int, file: str, run: str, ended: str, reason: str) -> LastPrint:
    if ended == "done" or ended == "cancelled":
        return LastPrint(number, file, run, ended, "")
    return LastPrint(number, file, run, "failed", reason)
