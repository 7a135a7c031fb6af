"""Estimates the duration of a file while its print is running."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import PassoError
from passo.job.batch.board_load import BudgetUse, budget_use
from passo.job.batch.program import at_rest, read_program
from passo.job.preflight import prepare, survey_in_pieces
from passo.printer.commands.program import Commands
from passo.printer.unfit_commands import ALL

if TYPE_CHECKING:
    from passo.card import Reader
    from passo.config.machine import MachineConfig

_PIECE = 1 << 14  # bytes planned at once, in some milliseconds
_REST_S = 0.02  # host time between two pieces


@dataclass(frozen=True, slots=True)
class Forecast:
    """The figures of a file: seconds of motion and dwell, in total and before the byte at which its
    print begins, without heating; its layers; its load on the board."""

    seconds: float
    before_s: float
    layers: int
    budget: BudgetUse


async def forecast(machine: MachineConfig, reader: Reader, begin: int) -> Forecast | None:
    """The forecast of a file whose print starts at byte `begin`; None if the file cannot be planned
    to its end. It plans in pieces, so that other tasks can run. Closes the reader."""
    job = _core.Job(machine.core_spec(), False, True, True)
    commands = Commands.of_plan(machine, job)
    before_s = 0.0

    def pieces() -> Iterator[bytes]:
        nonlocal before_s
        while data := reader.read(min(_PIECE, begin - reader.tell())):
            yield data
        before_s = _planned_s(job) + job.plan.queued_ticks / machine.board.clock_hz
        while data := reader.read(_PIECE):
            yield data

    try:
        found = await survey_in_pieces(machine, reader, rest_s=_REST_S)
        reader.seek(0)
        prepare(job, found, "", ALL)
        for _ in read_program(job, commands, pieces(), "", at_rest(job)):
            await asyncio.sleep(_REST_S)
    except PassoError:
        return None
    finally:
        reader.close()
    plan = job.results.statistics()
    return Forecast(_planned_s(job), before_s, plan["layers"], budget_use(plan, machine))


def _planned_s(job: _core.Job) -> float:
    plan = job.results.statistics()
    return plan["move_s"] + plan["dwell_s"]
