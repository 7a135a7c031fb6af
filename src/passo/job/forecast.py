"""How long a file will take, reckoned beside the print that is under way."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import PassoError
from passo.job.estimate import NoHeat
from passo.job.program import at_rest, read_program
from passo.printer.commands import Commands
from passo.printer.wiring import output_count

if TYPE_CHECKING:
    from passo.card import Reader
    from passo.config.machine import MachineConfig

_PIECE = 1 << 14  # bytes planned at once: some milliseconds
_REST_S = 0.02  # of host time between two pieces


async def forecast(machine: MachineConfig, reader: Reader) -> float | None:
    """Seconds of motion and dwell in a file, without heating; None if it cannot be planned to its
    end. Takes its time: the event loop has others to serve. Closes the reader."""
    job = _core.Job(machine.core_spec(), False, True, True)
    commands = Commands(machine, job, NoHeat(), [1] * output_count(machine))
    try:
        for _ in read_program(job, commands, _pieces(reader), "", at_rest(job)):
            await asyncio.sleep(_REST_S)
    except PassoError:
        return None
    finally:
        reader.close()
    plan = job.statistics()
    return plan["move_s"] + plan["dwell_s"]


def _pieces(reader: Reader) -> Iterator[bytes]:
    while data := reader.read(_PIECE):
        yield data
