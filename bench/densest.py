"""How dense commands can be: python bench/densest.py STEPS.npz [--steps N] [--tolerance TICKS]

Takes what `passo steps FILE --ideal --output STEPS.npz` wrote, draws runs of one direction at
random and finds, for each motor, the fewest commands that execute them within the bound of
docs/explanation/compression.md, whatever the way of choosing them. Beside it stands the exact
greedy choice: always the longest command, ended as near to the ideal as can be.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Ticks = NDArray[np.int64]
LEAST = 64  # ticks between steps: pulses of 2 µs at 16 MHz
TURN = 42  # where the motor turns


def windows(ideal: NDArray[np.float64], turns: Ticks, tolerance: float) -> tuple[Ticks, Ticks]:
    """First and last integer tick at which each step may come."""
    gap = np.diff(ideal, prepend=-1e15, append=1e18)
    near = np.minimum(gap[:-1], gap[1:])
    half = np.clip(np.minimum(0.25 * near, 0.5 * (near - LEAST)), 0, tolerance) + 0.5
    for k in turns:
        apart = max(0.0, 0.5 * (ideal[k] - ideal[k - 1] - TURN)) + 0.5
        half[k - 1 : k + 1] = np.minimum(half[k - 1 : k + 1], apart)
    return np.ceil(ideal - half - 1e-9).astype(np.int64), np.floor(ideal + half + 1e-9).astype(
        np.int64
    )


def reached(start: Ticks, low: Ticks, high: Ticks) -> list[Ticks]:
    """Ticks at which each of the coming steps can be, by one command from any tick of `start`."""
    first = np.arange(low[0], high[0] + 1)
    origin, at = (a.ravel() for a in np.meshgrid(start, first, indexing="ij"))
    interval = at - origin
    at, interval = at[interval > 0], interval[interval > 0]
    result = [np.unique(at)]
    if len(low) == 1:
        return result
    # Of two steps each can be anywhere in its window: that gives interval and add.
    second = np.arange(low[1], high[1] + 1)
    at, there = (a.ravel() for a in np.meshgrid(at, second, indexing="ij"))
    add = there - at - np.repeat(interval, len(second))
    interval, at = there - at, there
    for k in range(1, len(low)):
        if k > 1:
            interval = interval + add
            at = at + interval
        keep = (interval > 0) & (at >= low[k]) & (at <= high[k]) & (abs(add) < 32768)
        at, interval, add = at[keep], interval[keep], add[keep]
        if len(at) == 0:
            break
        result.append(np.unique(at))
    return result


def fewest(start: Ticks, low: Ticks, high: Ticks) -> int:
    """Commands of the best possible sequence.

    A part of a command is a command itself. So of all ways to execute the first k steps only those
    of fewest commands matter, but every tick at which they can end does.
    """
    done, commands = 0, 0
    ends: dict[int, Ticks] = {0: start}
    while done < len(low):
        found: dict[int, list[Ticks]] = {}
        for k, ticks in ends.items():
            for j, there in enumerate(reached(ticks, low[k:], high[k:]), k + 1):
                if j > done:
                    found.setdefault(j, []).append(there)
        ends = {j: np.unique(np.concatenate(parts)) for j, parts in found.items()}
        done, commands = max(ends), commands + 1
    return commands


def greedy(start: int, low: Ticks, high: Ticks, ideal: NDArray[np.float64]) -> int:
    """Commands when each is the longest from where the one before ended, nearest to the ideal."""
    done, commands, at = 0, 0, start
    while done < len(low):
        there = reached(np.array([at]), low[done:], high[done:])
        done, commands = done + len(there), commands + 1
        at = int(there[-1][np.argmin(np.abs(there[-1] - ideal[done - 1]))])
    return commands


def main() -> None:
    """Prints a line a motor."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--tolerance", type=float, default=32)
    arguments = parser.parse_args()
    random = np.random.default_rng(1)
    with np.load(arguments.file) as data:
        hz = float(data["clock_hz"].item())
        for name in [key.removesuffix("_ticks") for key in data if key.endswith("_ticks")]:
            ideal = data[f"{name}_ideal_s"] * hz
            turns = np.flatnonzero(np.diff(data[f"{name}_dir"])) + 1
            low, high = windows(ideal, turns, arguments.tolerance)
            runs = [(int(a), int(b)) for a, b in pairwise(turns)]
            steps, best, longest, count = 0, 0, 0, 0
            for i in random.permutation(len(runs)):
                if steps >= arguments.steps:
                    break
                a, b = runs[i]
                idle = ideal[a] - ideal[a - 1] > 1e7  # the clock is set anew
                before = (
                    np.array([int(ideal[a]) - 100000])
                    if idle
                    else np.arange(low[a - 1], high[a - 1] + 1)
                )
                steps, count = steps + b - a, count + 1
                best += fewest(before, low[a:b], high[a:b])
                longest += greedy(int(before[len(before) // 2]), low[a:b], high[a:b], ideal[a:b])
            if count:
                print(
                    f"{name}: {count} runs, {steps} steps; steps a command: "
                    f"greedy {steps / longest:.3f}, at most {steps / best:.3f}"
                )


if __name__ == "__main__":
    main()
