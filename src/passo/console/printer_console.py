"""A printer with all its commands."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import TYPE_CHECKING

from passo.console.card_commands import CardCommands
from passo.console.commands import ConsoleCommands
from passo.console.job_commands import JobCommands
from passo.console.json_status import JsonStatus
from passo.console.options import OptionCommands
from passo.console.recovery_commands import RecoveryCommands
from passo.console.settings_commands import SettingsCommands
from passo.errors import CommandError
from passo.job.history import History
from passo.job.runner import Runner
from passo.job.settings import Store
from passo.printer.printer import Printer
from passo.printer.reports import Reports

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class Listeners:
    """What a file's commands answer goes to all who listen."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer

    def say(self, text: str) -> None:
        """A line to all."""
        self._printer.tell(text)

    def with_ok(self, text: str) -> None:
        """The same: a file hears no `ok`."""
        self._printer.tell(text)

    def fail(self, text: str) -> None:
        """A command that was not carried out."""
        raise CommandError.of("job.failed", value=text)


def _history(printer: Printer, directory: Path) -> History | None:
    try:
        history = History(directory)
    except (sqlite3.Error, OSError) as error:
        printer.tell(f"echo:No history of prints: {error}")
        return None
    printer.closers.append(history.close)
    return history


def furnished(
    machine: MachineConfig, *, free: bool = False, card: str | None = None, state: str | None = None
) -> Printer:
    """A printer that understands every command of a console. Within a running event loop. Raises
    MachineError, and CardError if `card` cannot be used."""
    printer = Printer(machine, free=free)
    reports = Reports(printer, card=card is not None, settings=state is not None)
    printer.immediate.update(reports.handlers)
    printer.immediate.update(ConsoleCommands(printer, reports).handlers)
    runner = Runner(printer, Listeners(printer))
    options = OptionCommands(printer)
    printer.immediate.update(options.immediate)
    printer.planned.update(options.planned)
    printer.immediate.update(JsonStatus(printer, runner, options).handlers)
    files = CardCommands(printer, runner, card)
    printer.immediate.update(files.handlers)
    history = None if state is None else _history(printer, Path(state))
    jobs = JobCommands(printer, runner, history, lambda path: files.card.open(path))
    printer.immediate.update(jobs.immediate)
    printer.planned.update(jobs.planned)
    if state is not None:
        recovery = RecoveryCommands(printer, runner, files, Path(state))
        printer.planned.update(recovery.planned)
        printer.greeting = recovery.offer
    store = None if state is None else Store(Path(state) / "settings.json", machine.uuid)
    settings = SettingsCommands(printer, store, options)
    printer.planned.update(settings.planned)
    printer.settings = settings.lines
    if store is not None:
        printer.store_settings = settings.store
    settings.load_at_start()
    if card is not None:
        files.mount()
        files.autostart()
    return printer
