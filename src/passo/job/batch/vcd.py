"""Step and direction signals as a VCD file (IEEE 1364), for GTKWave and PulseView."""

from __future__ import annotations

import os
from array import array
from collections.abc import Iterator, Mapping
from heapq import merge
from pathlib import Path

from passo.job.durable_files import replaced


def timescale(clock_hz: int) -> tuple[int, str, int]:
    """The coarsest timescale in which a tick is a whole number, as (number, unit, such units per
    second). For a clock that does not fit a picosecond grid, picoseconds, to which times are
    rounded.
    """
    for unit, by_second in (("ns", 10**9), ("ps", 10**12)):
        for number in (100, 10, 1):
            if by_second // number % clock_hz == 0:
                return number, unit, by_second // number
    return 1, "ps", 10**12


def _edges(
    index: int, ticks: array[int], directions: array[int], pulse: int
) -> Iterator[tuple[int, int, str]]:
    """The (tick, order, change) of one motor: direction first, then the pulse."""
    direction = 0
    for i, tick in enumerate(ticks):
        if directions[i] != direction:
            direction = directions[i]
            yield tick - 1, 2 * index, f"{int(direction > 0)}{_code(2 * index)}"
        width = pulse
        if i + 1 < len(ticks):
            width = min(width, max((ticks[i + 1] - tick) // 2, 1))
        yield tick, 2 * index + 1, f"1{_code(2 * index + 1)}"
        yield tick + width, 2 * index + 1, f"0{_code(2 * index + 1)}"


def _code(index: int) -> str:
    return chr(33 + index) if index < 94 else chr(33 + index % 94) + _code(index // 94 - 1)


def write_vcd(
    path: str | os.PathLike[str],
    clock_hz: int,
    steppers: Mapping[str, tuple[array[int], array[int], int]],
) -> None:
    """Writes `steppers`: name → (ticks, directions ±1, pulse ticks). The file appears completely or
    not at all. A direction changes one tick before its first step. Raises OSError.
    """
    number, unit, by_second = timescale(clock_hz)
    with replaced(Path(path)) as temporary, temporary.open("w", encoding="ascii") as out:
        out.write(f"$timescale {number} {unit} $end\n$scope module passo $end\n")
        for i, name in enumerate(steppers):
            out.write(f"$var wire 1 {_code(2 * i)} {name}_dir $end\n")
            out.write(f"$var wire 1 {_code(2 * i + 1)} {name}_step $end\n")
        out.write("$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n")
        out.writelines(f"0{_code(i)}\n" for i in range(2 * len(steppers)))
        out.write("$end\n")
        now = 0
        for tick, _, change in merge(
            *(_edges(i, *motor) for i, motor in enumerate(steppers.values()))
        ):
            if tick > now:
                now = tick
                out.write(f"#{(tick * by_second + clock_hz // 2) // clock_hz}\n")
            out.write(change + "\n")
