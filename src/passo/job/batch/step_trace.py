"""The steps of a print as the board executed them."""

from __future__ import annotations

import os
import sys
from array import array
from bisect import bisect_left
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.job.batch.npz import FLOAT64, INT8, INT64, write_npz
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.job.batch.vcd import write_vcd

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


@dataclass(frozen=True, slots=True)
class StepTrace:
    """The steps of each motor: ticks since the start of the job, directions ±1, and ideal ticks if
    requested; and the warnings of the print."""

    clock_hz: int
    ticks: dict[str, array[int]]
    directions: dict[str, array[int]]
    ideal: dict[str, array[float]]
    pulses: dict[str, int]
    warnings: list[str]


def trace_steps(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    policy: Policy,
    *,
    from_s: float = 0.0,
    to_s: float | None = None,
    ideal: bool = False,
) -> StepTrace:
    """Prints the file, and returns the steps that the board executed from `from_s` to `to_s` of
    print time. Raises InputError or MachineError.
    """
    job = Print(machine, policy)
    hz = machine.board.clock_hz
    end_s = 1e9 if to_s is None else to_s
    job.trace_until(end_s)
    job.job.results.keep_ideal(ideal)
    result = job.run(path)
    ticks: dict[str, array[int]] = {}
    directions: dict[str, array[int]] = {}
    ideals: dict[str, array[float]] = {}
    end = job.base + round(end_s * hz)
    for i, stepper in enumerate(job.connection.board.steppers):
        clocks, turns = job.board.take_steps(stepper.name, job.base, end)
        executed = array("q", clocks)
        first = bisect_left(executed, job.base + round(from_s * hz))
        ticks[stepper.name] = array("q", (clock - job.base for clock in executed[first:]))
        directions[stepper.name] = array("b", turns)[first:]
        if ideal:
            ideals[stepper.name] = array("d", job.job.results.take_ideal(i))[first : len(executed)]
    pulses = {s.name: s.pulse_ticks for s in job.connection.board.steppers}
    return StepTrace(hz, ticks, directions, ideals, pulses, result.warnings)


def write_steps(path: str | os.PathLike[str], trace: StepTrace) -> None:
    """Writes the trace as .npz or .vcd, by the path's ending. Raises OSError, ValueError."""
    ending = os.fspath(path).rpartition(".")[2].lower()
    if ending == "vcd":
        motors = {
            name: (trace.ticks[name], trace.directions[name], trace.pulses[name])
            for name in trace.ticks
        }
        write_vcd(path, trace.clock_hz, motors)
        return
    if ending != "npz":
        raise ValueError(f"{os.fspath(path)}: the ending must be .npz or .vcd")
    arrays: dict[str, tuple[str, bytes]] = {}
    for name, ticks in trace.ticks.items():
        arrays[f"{name}_ticks"] = (INT64, _little(ticks))
        arrays[f"{name}_dir"] = (INT8, trace.directions[name].tobytes())
        if name in trace.ideal:
            seconds = array("d", (tick / trace.clock_hz for tick in trace.ideal[name]))
            arrays[f"{name}_ideal_s"] = (FLOAT64, _little(seconds))
    arrays["clock_hz"] = (INT64, _little(array("q", [trace.clock_hz])))
    write_npz(path, arrays, alone="clock_hz")


def _little(values: array[int] | array[float]) -> bytes:
    if sys.byteorder == "big":
        values = values[:]
        values.byteswap()
    return values.tobytes()
