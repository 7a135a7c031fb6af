"""Assembles one printer with the parts of `passo serve`: files, prints, commands."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
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
from passo.errors import InputError
from passo.job.durable_files import directory_held
from passo.job.live.button_actions import ButtonActions
from passo.job.live.filament_runout import FilamentRunout
from passo.job.live.halt_reports import HaltReports
from passo.job.live.host_pause import HostPause
from passo.job.live.job_status import JobStatusReader
from passo.job.live.journal_keeper import JournalKeeper
from passo.job.live.library import AUTOSTART, Library
from passo.job.live.objects import PrintObjects
from passo.job.live.print_pause import PrintPause
from passo.job.live.print_queue import PrintQueue
from passo.job.live.progress import Progress
from passo.job.live.runner import Runner
from passo.job.live.statistics import Statistics
from passo.job.mesh_folder import MeshFolder
from passo.job.settings_store import Store
from passo.job.variable_file import VariableFile
from passo.levelling.mesh_files import MeshStore
from passo.printer.background_gcode import BackgroundGcode
from passo.printer.commands.reports import Reports
from passo.printer.delayed_gcode import DelayedGcode
from passo.printer.idle_gcode import IdleGcode
from passo.printer.printer import Printer
from passo.printer.program_restart import ProgramRestart
from passo.printer.unfit_commands import NOTHING, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Assembly:
    """A printer with every command of a console, and its parts for use by programs. `restart`
    restarts the program; None if it cannot restart."""

    printer: Printer
    runner: Runner
    progress: Progress
    library: Library
    objects: PrintObjects
    statistics: Statistics
    settings: SettingsCommands
    queue: PrintQueue
    keeper: JournalKeeper | None
    restart: ProgramRestart | None


def assembled(
    machine: MachineConfig,
    *,
    free: bool = False,
    card: str | None = None,
    state: str | None = None,
    reports: str | None = None,
    skips: Skips = NOTHING,
    source: str = "",
    restart: Callable[[], None] | None = None,
) -> Assembly:
    """Assembles a printer with all parts of `passo serve` except the consoles. `reports` is the
    prefix of the paths of halt reports; without it they are written to `state`. `skips` are
    commands that its prints may skip. `restart` ends the program, which then starts again with the
    machine file `source`. Call it within a running event loop. Raises MachineError, CardError if
    `card` cannot be used, and InputError if another process uses `state`; after an error the board
    is released."""
    folder = None if state is None else Path(state)
    variables = VariableFile(None if folder is None else folder / "variables.json")
    meshes = MeshStore() if folder is None else MeshFolder(folder / "meshes")
    printer = Printer(machine, free=free, skips=skips, variables=variables, meshes=meshes)
    listen = printer.state.unheard.append
    printer.state.listeners.append(listen)
    try:
        if folder is not None:
            _hold(printer, folder)
        restarts = None if restart is None else (source, restart)
        assembly = _furnish(printer, card, folder, reports, restarts)
        for error in variables.refused + meshes.refused:
            printer.state.announce(_log, logging.WARNING, str(error), error.problems[0])
        if card is not None:
            assembly.library.mount()
            _start_by_itself(printer, assembly.library, assembly.keeper)
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
    printer: Printer,
    card: str | None,
    folder: Path | None,
    reports: str | None,
    restarts: tuple[str, Callable[[], None]] | None,
) -> Assembly:
    live = printer.rig, printer.state, printer.lifetime
    answers = Reports(
        *(printer.control, printer.motion, printer.driver_commands, printer.lateness),
        printer.inputs.filament,
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
    pause = HostPause(printer.control, printer.suspension, printer.heat)
    jobs = JobCommands(printer.control, pause, runner, progress, printer.inputs.buttons)
    background = BackgroundGcode(printer.control, printer.lifetime)
    filament, buttons = printer.inputs.filament, printer.inputs.buttons
    by_event = PrintPause(printer.control, runner, pause, background)
    FilamentRunout(*(printer.control, filament, runner, by_event, background), printer.lifetime)
    ButtonActions(printer.control, buttons, runner, by_event, background)
    if any(one.when_idle for one in printer.machine.delayed_gcode.values()):
        IdleGcode(printer.control, printer.outputs.motors, background, printer.lifetime)
    objects = PrintObjects(printer.rig, printer.dispatch, runner)
    restart = None
    if restarts is not None:
        source, end = restarts
        restart = ProgramRestart(source, lambda: runner.name if runner.engaged else "", end)
    printer.dispatch.add(
        *(answers, options, statistics, jobs, ObjectCommands(objects)),
        ConsoleCommands(
            *(printer.rig, printer.state, printer.stops), answers, printer.heat.report, restart
        ),
        CardCommands(printer.rig, printer.state, runner, library),
        DelayedGcode(printer.machine, background, printer.lifetime),
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
    stem = folder / "halt" if folder is not None else Path(reports) if reports else None
    if stem is not None:
        HaltReports(*live, printer.settings, runner, progress, stem)
    store = None if folder is None else Store(folder / "settings.json", printer.machine.uuid)
    settings = SettingsCommands(printer.control, printer.motion, printer.settings, store, options)
    printer.dispatch.add(settings)
    settings.load_at_start()
    queue = PrintQueue(printer.state, runner, library, folder)
    JobStatusReader(printer.rig, printer.state, runner, progress, objects, library)
    printer.dispatch.add(JsonStatus(printer.rig, printer.outputs.power, printer.status, options))
    return Assembly(
        *(printer, runner, progress, library, objects, statistics, settings, queue, keeper),
        restart,
    )


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
