"""The report of a command whose part the machine lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.printer.wait_requests import without_effect

if TYPE_CHECKING:
    from passo import _core
    from passo.gcode.command import Command
    from passo.printer.wait_requests import Reply


def report_lack(job: _core.Job, command: Command, reply: Reply, lacks: str) -> None:
    """Reports that the machine lacks a part. Macros, which are written for other printers,
    continue."""
    if job.program.macro_depth:
        reply.note(command.code, without_effect(command.code, lacks))
    else:
        reply.no_part(command.code, lacks)
