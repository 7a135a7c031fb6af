"""Assembles one printer with the parts of `passo serve`: files, prints, commands."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from passo.console.aprinter_options import OptionCommands
from passo.console.card_commands import CardCommands
from passo.console.commands import ConsoleCommands
from passo.console.job_commands import JobCommands
from passo.console.json_status import JsonStatus
from passo.console.object_commands import ObjectCommands
from passo.console.printer_console import AllConsoles
from passo.console.recovery_commands import RecoveryCommands
from passo.console.settings_commands import SettingsCommands
from passo.errors import CommandError, InputError
from passo.job.durable_files import directory_held
from passo.job.live.halt_reports import HaltReports
from passo.job.live.journal_keeper import JournalKeeper
from passo.job.live.library import AUTOSTART, Library
from passo.job.live.objects import PrintObjects, covered
from passo.job.live.print_queue import PrintQueue
from passo.job.live.progress import Progress
from passo.job.live.runner import Runner
from passo.job.live.statistics import Statistics
from passo.job.live.status_reader import StatusReader
from passo.job.mesh_folder import MeshFolder
from passo.job.saved_variables import SavedVariables
from passo.job.settings_store import Store
from passo.printer.commands.reports import Reports
from passo.printer.delayed_gcode import DelayedGcode
from passo.printer.printer import Printer
from passo.printer.unfit_commands import NOTHING, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Assembly:
    """A printer with every command of a console, and its parts for use by programs."""

    printer: Printer
    runner: Runner
    progress: Progress
    library: Library
    status: StatusReader
    objects: PrintObjects
    statistics: Statistics
    settings: SettingsCommands
    queue: PrintQueue


def assembled(
    machine: MachineConfig,
    *,
    free: bool = False,
    card: str | None = None,
    state: str | None = None,
    reports: str | None = None,
    skips: Skips = NOTHING,
) -> Assembly:
    """Assembles a printer with all parts of `passo serve` except the consoles. `reports` is the
    prefix of the paths of halt reports; without it they are written to `state`. `skips` are
    commands that its prints may skip. Call it within a running event loop. Raises MachineError,
    CardError if `card` cannot be used, and InputError if another process uses `state`; after an
    error the board is released."""
    printer = Printer(machine, free=free, skips=skips)
    listen = printer.state.unheard.append
    printer.state.listeners.append(listen)
    try:
        assembly = _furnish(printer, card, state, reports)
        printer.report_start()
    except BaseException:
        printer.close()
        raise
    printer.state.listeners.remove(listen)
    return assembly


def _hold(printer: Printer, state: Path) -> None:
    """Locks the folder for this printer until it is closed. A folder that cannot be locked is
    reported when it is used."""
    try:
        held = directory_held(state)
    except BlockingIOError:
        raise InputError.of("state.busy", str(state)) from None
    if held is not None:
        printer.lifetime.at_end(lambda: os.close(held))


def _furnish(
    printer: Printer, card: str | None, state: str | None, reports: str | None
) -> Assembly:
    folder = None if state is None else Path(state)
    if folder is not None:
        _hold(printer, folder)
    live = printer.rig, printer.state, printer.lifetime
    answers = Reports(
        *(printer.control, printer.motion, printer.driver_commands, printer.lateness),
        card=card is not None,
        settings=folder is not None,
    )
    runner = Runner(
        *(printer.control, printer.outputs, printer.motion, printer.heat, printer.suspension),
        AllConsoles(printer.state),
    )
    options = OptionCommands(printer.dispatch, printer.settings)
    library = Library(printer.state, printer.lifetime, runner, card)
    statistics = Statistics(*live, printer.suspension, printer.lateness, folder)
    progress = Progress(*live, printer.suspension, runner, statistics, library.reader)
    jobs = JobCommands(printer.control, printer.suspension, printer.heat, runner, progress)
    objects = PrintObjects(printer.rig, printer.dispatch, runner)
    printer.dispatch.add(
        *(answers, options, statistics, jobs, ObjectCommands(objects)),
        ConsoleCommands(*(printer.rig, printer.state, printer.stops), answers, printer.heat.report),
        CardCommands(printer.rig, printer.state, runner, library),
        DelayedGcode(printer.control, printer.lifetime),
    )
    keeper = None
    if folder is not None:
        keeper = JournalKeeper(
            *(printer.control, printer.lifetime, printer.outputs, printer.motion, printer.heat),
            printer.settings,
            runner,
            library,
            objects,
            folder,
        )
        printer.dispatch.add(RecoveryCommands(printer.machine.uuid, printer.skips, runner, keeper))
        printer.state.greetings.append(keeper.offer)
    stem = folder / "halt" if folder is not None else Path(reports) if reports else None
    if stem is not None:
        HaltReports(*live, printer.settings, runner, progress, stem)
    store = None if folder is None else Store(folder / "settings.json", printer.machine.uuid)
    settings = SettingsCommands(printer.control, printer.motion, printer.settings, store, options)
    printer.dispatch.add(settings)
    if store is not None:
        printer.state.stores.append(settings.store)
    settings.load_at_start()
    _keep_variables(printer, folder)
    _keep_meshes(printer, folder, objects)
    queue = PrintQueue(printer.state, runner, library, folder)
    status = StatusReader(
        *(
            printer.control,
            printer.outputs,
            printer.motion,
            printer.heat,
            printer.levelling,
        ),
        *(runner, progress, objects, library),
        interrupted=(lambda: None) if keeper is None else keeper.status,
        unsaved=settings.unsaved,
        queue=queue.status,
    )
    printer.rig.macros.status = status.read
    printer.dispatch.add(JsonStatus(printer.rig, printer.outputs.power, status, options))
    if card is not None:
        library.mount()
        _start_by_itself(printer, library, keeper)
    return Assembly(
        printer, runner, progress, library, status, objects, statistics, settings, queue
    )


def _keep_variables(printer: Printer, folder: Path | None) -> None:
    """Gives macros the variables of SAVE_VARIABLE that are stored in the folder."""
    macros = printer.rig.macros
    file = SavedVariables(None if folder is None else folder / "variables.json")
    macros.keep = file.save
    try:
        macros.saved = file.load()
    except CommandError as error:
        printer.state.announce(_log, logging.WARNING, str(error), error.problems[0])


def _keep_meshes(printer: Printer, folder: Path | None, objects: PrintObjects) -> None:
    """Gives the printer the stored meshes, and the area of the bed that the print covers."""
    printer.levelling.bed.job_area = lambda: covered(objects.all)
    if folder is None:
        return
    printer.levelling.correction.meshes = meshes = MeshFolder(folder / "meshes")
    for error in meshes.refused:
        printer.state.announce(_log, logging.WARNING, str(error), error.problems[0])


def _start_by_itself(printer: Printer, library: Library, keeper: JournalKeeper | None) -> None:
    """Starts the print of `auto0.g`, unless the printer is halted or a print was interrupted."""
    offered = keeper is not None and keeper.offer()
    if not offered and printer.state.start_failure is None:
        library.autostart()
    elif library.starts_itself and keeper is not None and offered:
        keeper.offer_instead(AUTOSTART)
    elif library.starts_itself:
        text = f"{AUTOSTART} was not started, for the printer is halted"
        printer.state.announce(_log, logging.WARNING, text)
