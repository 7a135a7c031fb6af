"""A printer with all its commands."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from passo.console.aprinter_options import OptionCommands
from passo.console.card_commands import AUTOSTART, CardCommands
from passo.console.commands import ConsoleCommands
from passo.console.job_commands import JobCommands
from passo.console.json_status import JsonStatus
from passo.console.object_commands import ObjectCommands
from passo.console.recovery_commands import RecoveryCommands
from passo.console.session import Session
from passo.console.settings_commands import SettingsCommands
from passo.console.status import StatusReader
from passo.errors import InputError, Problem
from passo.job.durable_files import directory_held
from passo.job.live.objects import PrintObjects
from passo.job.live.runner import Runner
from passo.job.live.statistics import Statistics
from passo.job.settings_store import Store
from passo.printer.commands.reports import Reports
from passo.printer.printer import Printer
from passo.printer.unfit_commands import NOTHING, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class Listeners:
    """What a file's commands answer goes to all who listen."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._noted: set[str] = set()

    def say(self, text: str) -> None:
        """A line to all."""
        self._printer.tell(text)

    def note(self, about: str, text: str) -> None:
        """A line to all, once."""
        if about not in self._noted:
            self._noted.add(about)
            self._printer.tell(f"echo:{text}")

    def with_ok(self, text: str) -> None:
        """The same: a file hears no `ok`."""
        self._printer.tell(text)

    def warming(self, text: str) -> None:
        """Nothing: consoles beside a print ask when they want to know."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """A command that was not carried out."""
        # Not as CommandError: whoever takes that in says it again, here.
        raise InputError.of("job.failed", value=text.rstrip("."))


@dataclass(frozen=True, slots=True)
class Assembly:
    """A printer that understands every command of a console, and the parts that a program uses."""

    printer: Printer
    runner: Runner
    jobs: JobCommands
    files: CardCommands
    status: StatusReader
    objects: PrintObjects


def assembled(
    machine: MachineConfig,
    *,
    free: bool = False,
    card: str | None = None,
    state: str | None = None,
    skips: Skips = NOTHING,
) -> Assembly:
    """A printer with all that `passo serve` has but the consoles; `skips` are commands that its
    prints may leave out. Within a running event loop. Raises MachineError, CardError if `card`
    cannot be used, and InputError if another one has `state`; the board is let go then."""
    printer = Printer(machine, free=free, skips=skips)
    listen = printer.state.unheard.append
    printer.state.listeners.append(listen)
    try:
        assembly = _furnish(printer, card, state)
        printer.report_start()
    except BaseException:
        printer.close()
        raise
    printer.state.listeners.remove(listen)
    return assembly


def _hold(printer: Printer, state: Path) -> None:
    """The folder is this printer's alone, as long as it lives. Where that cannot be, whoever needs
    it says so."""
    try:
        held = directory_held(state)
    except BlockingIOError:
        raise InputError.of("state.busy", str(state)) from None
    if held is not None:
        printer.closers.append(lambda: os.close(held))


def _furnish(printer: Printer, card: str | None, state: str | None) -> Assembly:
    if state is not None:
        _hold(printer, Path(state))
    reports = Reports(printer, card=card is not None, settings=state is not None)
    printer.waits.temperatures = reports.temperatures
    printer.dispatch.immediate.update(reports.handlers)
    printer.dispatch.immediate.update(ConsoleCommands(printer, reports).handlers)
    runner = Runner(printer, Listeners(printer))
    options = OptionCommands(printer)
    printer.dispatch.immediate.update(options.immediate)
    printer.dispatch.planned.update(options.planned)
    files = CardCommands(printer, runner, card)
    printer.dispatch.immediate.update(files.handlers)
    statistics = Statistics(printer, None if state is None else Path(state))
    printer.dispatch.immediate.update(statistics.immediate)
    jobs = JobCommands(printer, runner, statistics, files.reader)
    printer.dispatch.immediate.update(jobs.immediate)
    printer.dispatch.planned.update(jobs.planned)
    objects = PrintObjects(printer, runner)
    printer.dispatch.immediate.update(ObjectCommands(objects).immediate)
    status = StatusReader(printer, runner, jobs, objects)
    printer.dispatch.immediate.update(JsonStatus(printer, status, options).handlers)
    recovery = None
    if state is not None:
        recovery = RecoveryCommands(printer, runner, files, objects, Path(state))
        printer.dispatch.planned.update(recovery.planned)
        printer.state.greeting = recovery.offer
    store = None if state is None else Store(Path(state) / "settings.json", printer.machine.uuid)
    settings = SettingsCommands(printer, store, options)
    printer.dispatch.planned.update(settings.planned)
    printer.state.settings = settings.lines
    if store is not None:
        printer.state.store_settings = settings.store
    settings.load_at_start()
    if card is not None:
        files.mount()
        offered = recovery is not None and recovery.offer()
        if not offered and printer.state.start_failure is None:
            files.autostart()
        elif files.starts_itself and recovery is not None and offered:
            recovery.instead = f". {AUTOSTART} was not started"
        elif files.starts_itself:
            printer.tell(f"echo:{AUTOSTART} was not started, for the printer is halted")
    return Assembly(printer, runner, jobs, files, status, objects)


def welcome(printer: Printer, session: Session) -> None:
    """What a console hears when it opens; the first also why something is amiss since the start."""
    session.say("start")
    session.say(f"echo:Passo, {printer.machine.name}")
    unheard, printer.state.unheard = printer.state.unheard, []
    for text in unheard:
        session.say(text)
    if printer.halted:
        session.say(f"echo:Printer halted: {printer.state.why_halted}")
    if greeting := printer.state.greeting():
        session.say(greeting)
