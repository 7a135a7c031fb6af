"""Assembles one printer with the parts of `passo serve`: files, prints, commands."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from passo.console.aprinter_options import OptionCommands
from passo.console.card_commands import CardCommands
from passo.console.commands import ConsoleCommands
from passo.console.job_commands import JobCommands
from passo.console.json_status import JsonStatus
from passo.console.object_commands import ObjectCommands
from passo.console.printer_console import FileReply
from passo.console.recovery_commands import RecoveryCommands
from passo.console.settings_commands import SettingsCommands
from passo.job.mesh_folder import MeshFolder
from passo.job.settings_store import Store
from passo.job.state_lock import StateLock
from passo.job.variable_file import VariableFile
from passo.levelling.mesh_files import MeshStore
from passo.printer.commands.reports import Reports
from passo.printer.delayed_gcode import DelayedGcode
from passo.printer.idle_gcode import IdleGcode
from passo.printer.printer import Printer
from passo.printer.program_restart import ProgramRestart
from passo.printer.unfit_commands import NOTHING, Skips
from passo.services.jobs import Jobs, build_jobs
from passo.services.services import Services

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Assembly:
    """A printer with every command of a console, and its services. `lock` is that of its state
    folder, None without one. `restart` restarts the program; None if it cannot restart."""

    printer: Printer
    services: Services
    settings: SettingsCommands
    restart: ProgramRestart | None
    lock: StateLock | None = None


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
    lock = None
    listen = printer.state.unreported.append
    printer.state.listeners.append(listen)
    try:
        if folder is not None:
            lock = StateLock(folder, machine.name)
            printer.lifetime.at_end(lock.release)
        restarts = None if restart is None else (source, restart)
        consoles = FileReply(printer.state)
        jobs = build_jobs(
            printer.control, printer.parts, consoles, card=card, folder=folder, reports=reports
        )
        assembly = _furnish(printer, jobs, card is not None, folder, restarts)
        for error in variables.refused + meshes.refused:
            printer.state.announce(_log, logging.WARNING, str(error), error.problems[0])
        if card is not None:
            jobs.files.mount()
            jobs.start_by_itself()
        printer.report_start()
    except BaseException:
        printer.close()
        raise
    printer.state.listeners.remove(listen)
    return replace(assembly, lock=lock)


def _furnish(
    printer: Printer,
    jobs: Jobs,
    has_card: bool,
    folder: Path | None,
    restarts: tuple[str, Callable[[], None]] | None,
) -> Assembly:
    """Adds the commands of consoles."""
    control, parts = printer.control, printer.parts
    answers = Reports(
        control, parts, printer.driver_commands, card=has_card, settings=folder is not None
    )
    options = OptionCommands(printer.dispatch, printer.settings)
    if any(one.when_idle for one in printer.machine.delayed_gcode.values()):
        IdleGcode(control, parts.outputs.motors, jobs.background)
    restart = None
    if restarts is not None:
        source, end = restarts
        restart = ProgramRestart(source, lambda: jobs.printed_file, end)
    store = None if folder is None else Store(folder / "settings.json", printer.machine.uuid)
    settings = SettingsCommands(control, parts, store, options)
    printer.dispatch.add(
        *(answers, options, settings, jobs.statistics, ObjectCommands(jobs.objects)),
        *(JobCommands(control, parts.inputs.buttons, jobs), CardCommands(control, jobs)),
        DelayedGcode(control, jobs.background),
        ConsoleCommands(control, answers, parts.heat.report, restart),
        JsonStatus(printer.rig, printer.outputs.power, printer.status, options),
    )
    if jobs.journal is not None:
        printer.dispatch.add(RecoveryCommands(control, jobs.runner, jobs.journal))
    settings.load_at_start()
    services = Services(control, parts, printer.status, jobs)
    return Assembly(printer, services, settings, restart)
