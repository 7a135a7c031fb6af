"""Prints one file under several settings of the motion on the simulated machine, and measures how
well each print follows the file."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.shapers import SHAPER_TYPES
from passo.config.simulated_motion import simulated_masses
from passo.errors import InputError
from passo.job.batch.comparison import Comparison, Trial, Weight
from passo.job.batch.motion_setting import ADVANCED, Setting, settings_for
from passo.job.batch.policy import Policy
from passo.job.batch.quality_watch import Measurement, QualityWatch
from passo.job.batch.recorded_stream import RecordedStream
from passo.job.batch.simulated_print import Print
from passo.job.batch.source import open_source

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.result import PrintResult

    _Printed = tuple[Measurement, list[str]]  # with the warnings of the print
    _Print = Callable[[MachineConfig], _Printed]
    _Map = Callable[[_Print, Iterable[MachineConfig]], Iterator[_Printed]]

_SLOWER = 0.9  # frequencies off tune, of those on tune
_LONG_PRINT_S = 0.2  # shorter prints take less processor time than the start of a process


def run_laboratory(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    weight: Weight = "balance",
    policy: Policy | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
    compared: RecordedStream | None = None,
    workers: int = 1,
) -> Comparison:
    """Prints the file under each setting. If the best shaper is not the one that was printed with
    advance, prints the file once more with the best shaper and advance. Then plays the stream that
    is compared. Each setting takes two prints. Up to `workers` of them run side by side, in
    processes of their own, unless they are short; the result does not depend on it. `progress` is
    called with the number of prints that are done, and of all that may be needed. Raises InputError
    and MachineError."""
    with open_source(path) as source:
        if not source.seekable():
            raise InputError.of("input.pipe", str(path))
    policy = replace(policy or Policy(), motion_only=True)
    settings = settings_for(machine)
    plain = settings[0].on(machine)
    result, watch = _watched(plain, path, policy, None, keep_path=compared is not None)
    first = watch.measurement(result)
    if not (first.quality.corners or first.quality.printed_mm):
        raise InputError.of("input.no-lines", str(path))
    found = Comparison(str(path), machine.name, weight)
    corner = first.corner.number if first.corner else None
    printed = partial(_printed, path=path, policy=policy, corner=corner)
    numbers, of = count(1), 2 * (len(settings) + 1)
    progress(next(numbers), of)
    with _processes(workers if result.cpu_s["total"] > _LONG_PRINT_S else 1) as run:

        def measured(machines: Iterable[MachineConfig]) -> Iterator[_Printed]:
            for each in run(printed, machines):
                progress(next(numbers), of)
                yield each

        machines = [m for setting in settings for m in _pair(setting.on(machine))]
        _add(found, settings, [(first, result.warnings), *measured(machines[1:])])
        scores = found.scores()
        best = settings[min(range(1, 1 + len(SHAPER_TYPES)), key=lambda i: scores[i])]
        if best.shaper != ADVANCED:
            last = replace(best, advance=True)
            _add(found, [last], [*measured(_pair(last.on(machine)))])
    if compared is not None:
        trial = [compared.play(m, watch.measured, result.steps, corner) for m in _pair(plain)]
        found.trials.append(Trial.of(Path(compared.name).name, *trial))
    _warn(found)
    return found


def measure(
    machine: MachineConfig, path: str | os.PathLike[str], policy: Policy
) -> tuple[Trial, list[str]]:
    """The trial of one machine as it is, with its own filters, in two prints: on tune and off tune.
    Also returns the warnings of the print. Raises InputError and MachineError."""
    policy = replace(policy, motion_only=True)
    (on_tune, warnings), (off_tune, _) = (
        _printed(each, path, policy, None) for each in _pair(machine)
    )
    return Trial.of(machine.name, on_tune, off_tune), warnings


def _pair(machine: MachineConfig) -> tuple[MachineConfig, MachineConfig]:
    """The machine, and the same one with masses that vibrate slower."""
    masses = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    slower = {
        name: mass.model_copy(update={"frequency_hz": _SLOWER * mass.frequency_hz})
        for name, mass in zip("xyz", masses, strict=True)
    }
    simulated = machine.simulated.model_copy(update={"masses": slower})
    return machine, machine.model_copy(update={"simulated": simulated})


def _add(found: Comparison, settings: list[Setting], prints: list[_Printed]) -> None:
    """Adds the trials of two prints each, on tune and off tune."""
    for setting, on, off in zip(settings, prints[::2], prints[1::2], strict=True):
        (on_tune, warnings), (off_tune, _) = on, off
        found.trials.append(Trial.of(setting.name, on_tune, off_tune))
        found.warnings += [line for line in warnings if line not in found.warnings]


def _warn(found: Comparison) -> None:
    """Adds warnings of what was not measured."""
    if found.trials[0].quality.corners == 0:
        found.warnings.append(
            "no sharp corner between printed lines: the rounding of corners is unknown"
        )
    found.warnings += [
        f"{trial.name}: the motors did not follow the file for {trial.lost:.1%} of the time;"
        " the setting is not compared"
        for trial in found.trials
        if not trial.followed
    ]


@contextmanager
def _processes(workers: int) -> Generator[_Map]:
    """A function as `map`, which works in this process, or in several."""
    if workers <= 1:
        yield map
        return
    # New processes, because a caller may have threads; the interrupt of a terminal ends them too.
    how = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, how, signal.signal, (signal.SIGINT, signal.SIG_DFL)) as pool:
        yield pool.map


def _printed(
    machine: MachineConfig, path: str | os.PathLike[str], policy: Policy, corner: int | None
) -> _Printed:
    result, watch = _watched(machine, path, policy, corner)
    return watch.measurement(result), result.warnings


def _watched(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    policy: Policy,
    corner: int | None,
    *,
    keep_path: bool = False,
) -> tuple[PrintResult, QualityWatch]:
    job = Print(machine, policy)
    watch = QualityWatch(machine, job, corner, keep_path=keep_path)
    job.watch_steps(watch)
    return job.run(path), watch
