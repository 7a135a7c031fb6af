"""How long a file will take, reckoned beside the print that is under way."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import PassoError
from passo.job.estimate import NoHeat
from passo.printer.commands import Commands
from passo.printer.wiring import output_count
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.card import Reader
    from passo.config.machine import MachineConfig

_PIECE = 1 << 14  # bytes planned at once: some milliseconds
_REST_S = 0.02  # of host time between two pieces


async def forecast(machine: MachineConfig, reader: Reader) -> float | None:
    """Seconds of motion and dwell in a file, without heating; None if it cannot be planned to its
    end. Takes its time: the event loop has others to serve. Closes the reader."""
    job = _core.Job(machine.core_spec(), False, True, True)
    commands = Commands(machine, job, NoHeat(job), [1] * output_count(machine))
    status = _core.JobStatus
    try:
        while not commands.ended:
            found = job.advance(most=_PIECE)
            if found == status.EVENT:
                wait = commands.run(Command(*job.event))
                if wait is not None:
                    commands.settle(wait)
            elif found == status.NEED_INPUT:
                data = reader.read(_PIECE)
                if data:
                    job.feed(data)
                else:
                    job.finish()
                await asyncio.sleep(_REST_S)
            elif found == status.ERROR:
                job.abandon()
            elif found == status.END:
                break
    except PassoError:
        return None
    finally:
        reader.close()
    job.flush()
    plan = job.statistics()
    return plan["move_s"] + plan["dwell_s"]
