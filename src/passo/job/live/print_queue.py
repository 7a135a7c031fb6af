"""The queue of the files that will be printed next; it survives a restart."""

from __future__ import annotations

import asyncio
import logging
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import CardError, CommandError, PassoError
from passo.job.durable_files import load_json, store_json
from passo.printer.status import Queue, QueuedPrint

if TYPE_CHECKING:
    from passo.job.live.files import Files
    from passo.job.live.job_state import JobState
    from passo.job.live.runner import Runner
    from passo.printer.state import State

_log = logging.getLogger(__name__)
MAX_QUEUED = 200


class PrintQueue:
    """The queue of one printer. The next print starts when `start_next` is called: the user has
    confirmed that the bed is clear. With `automatic`, it also starts after a successful print. The
    queue is stored in `directory`; None keeps it only in memory. Methods that change it return when
    the change is durable. If it cannot be stored, they raise CommandError and leave the queue
    unchanged."""

    def __init__(self, state: State, runner: Runner, files: Files, directory: Path | None) -> None:
        self._state, self._runner, self._files = state, runner, files
        self._path = None if directory is None else directory / "queue.json"
        self._entries: tuple[QueuedPrint, ...] = ()
        self._automatic = False
        self._load()
        runner.watchers.append(self._job_changed)
        state.status_parts.append(lambda status: replace(status, queue=self.status()))

    def status(self) -> Queue:
        """`Status.queue`."""
        return Queue(self._entries, self._automatic)

    def set_automatic(self, on: bool) -> None:
        """Sets whether the next print starts without confirmation after a successful print: for
        printers that clear their bed."""
        self._keep(self._entries, on)

    def add(self, path: str) -> QueuedPrint:
        """Adds a file of the card at the end. Raises CardError."""
        if self._files.card.find(path).is_directory:
            raise CardError.of("card.directory", path)
        if len(self._entries) >= MAX_QUEUED:
            raise CommandError.of("queue.full", limit=MAX_QUEUED)
        number = max((entry.number for entry in self._entries), default=0) + 1
        added = QueuedPrint(number, path)
        self._keep((*self._entries, added), self._automatic)
        return added

    def remove(self, number: int) -> None:
        """Removes a print from the queue."""
        found = self._found(number)
        entries = tuple(entry for entry in self._entries if entry is not found)
        self._keep(entries, self._automatic)

    def move(self, number: int, place: int) -> None:
        """Moves a print to a position: 0 or less is the next one; beyond the end is the last
        one."""
        found = self._found(number)
        others = [entry for entry in self._entries if entry is not found]
        others.insert(min(max(place, 0), len(others)), found)
        self._keep(tuple(others), self._automatic)

    def start_next(self) -> None:
        """Starts the next print, and removes it from the queue. Raises CommandError if there is
        none or if the printer is printing, and CardError or InputError if its file cannot be
        opened; then it stays in the queue."""
        before = self._entries
        if not before:
            raise CommandError.of("queue.empty")
        self._files.open(before[0].path)
        self._keep(before[1:], self._automatic)
        try:
            self._runner.start()
        except PassoError:
            self._keep(before, self._automatic)
            raise

    def _found(self, number: int) -> QueuedPrint:
        for entry in self._entries:
            if entry.number == number:
                return entry
        raise CommandError.of("queue.unknown", value=number)

    def _job_changed(self, was: JobState, now: JobState) -> None:
        if was.active and not now.active and self._automatic:
            asyncio.get_running_loop().call_soon(self._start_by_itself)

    def _start_by_itself(self) -> None:
        if self._runner.ended != "done" or not self._runner.over or not self._entries:
            return
        try:
            self.start_next()
        except PassoError as error:
            text = f"The next print of the queue was not started: {error}"
            self._state.announce(_log, logging.WARNING, text)

    def _keep(self, entries: tuple[QueuedPrint, ...], automatic: bool) -> None:
        if self._path is not None:
            rows = [asdict(entry) for entry in entries]
            try:
                store_json(self._path, {"automatic": automatic, "prints": rows})
            except OSError as error:
                why = error.strerror or str(error)
                raise CommandError.of("queue.unwritable", str(self._path), value=why) from None
        self._entries, self._automatic = entries, automatic

    def _load(self) -> None:
        if self._path is None:
            return
        try:
            kept = load_json(self._path)
            if kept is None:
                return
            rows = [QueuedPrint(int(row["number"]), str(row["path"])) for row in kept["prints"]]
            self._entries, self._automatic = tuple(rows), bool(kept["automatic"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            text = f"{self._path} is damaged, so the queue of prints is empty: {error}"
            self._state.announce(_log, logging.WARNING, text)
