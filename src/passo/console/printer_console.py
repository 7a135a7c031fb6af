"""A printer with all its commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.console.commands import ConsoleCommands
from passo.printer.printer import Printer
from passo.printer.reports import Reports

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def furnished(machine: MachineConfig, *, free: bool = False) -> Printer:
    """A printer that understands every command of a console. Within a running event loop."""
    printer = Printer(machine, free=free)
    reports = Reports(printer)
    printer.immediate.update(reports.handlers)
    printer.immediate.update(ConsoleCommands(printer, reports).handlers)
    return printer
