"""Prints one file under several settings of the motion on the simulated machine, and measures how
well each one follows the file."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from passo.config.motion import JUNCTIONS, Junction, Shaping
from passo.config.shapers import MAX_HZ, MIN_HZ, SHAPER_TYPES, ShaperType
from passo.config.simulated_motion import simulated_masses
from passo.job.batch.policy import Policy
from passo.job.batch.quality_watch import Quality, QualityWatch, ShownCorner
from passo.job.batch.recorded_stream import RecordedStream
from passo.job.batch.simulated_print import Print

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.result import PrintResult

Weight = Literal["balance", "ringing", "corners", "lines", "time"]
WEIGHTS: dict[Weight, str] = {
    "balance": "all four alike",
    "ringing": "walls without waves, before all else",
    "corners": "sharp corners, before all else",
    "lines": "lines of even width, before all else",
    "time": "a short print, before all else",
}
"""What a user may want most, in words."""

_HEAVY = 4.0  # the wanted criterion counts as much as this many others
_LONGER = 0.5  # a print that is longer by this fraction costs as much as the worst ringing of all
_SLOWER = 0.9
_LOST = 0.005  # a head that is lost for a smaller fraction of the time needs no warning
_ADVANCED: ShaperType = "mzv"  # is also printed with advance


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of the motion: the shaper of X and Y, pressure advance and the jerk limit on or
    off, and the law of junctions if it is not that of the machine file."""

    shaper: ShaperType | None = None
    advance: bool = False
    jerk_limit: bool = False
    junction: Junction | None = None

    @property
    def name(self) -> str:
        """Its name in tables."""
        parts = [self.shaper or "", "jerk limit" if self.jerk_limit else ""]
        parts.append("advance" if self.advance else "")
        if self.junction:
            parts.append(f"junction {self.junction.replace('_', ' ')}")
        return " + ".join(part for part in parts if part) or "none"

    def on(self, machine: MachineConfig) -> MachineConfig:
        """The machine with this setting and no other filter. Filters have the values of the machine
        file, else those that fit its simulated masses and nozzle: the jerk limit then averages over
        one cycle of the slower axis."""
        limits = machine.limits.model_copy(
            update={
                "jerk_mm_s3": _jerk_mm_s3(machine) if self.jerk_limit else None,
                "junction": self.junction or machine.limits.junction,
            }
        )
        return machine.model_copy(
            update={
                "shaping": _shaping(machine, self.shaper) if self.shaper else {},
                "extruders": {
                    name: extruder.model_copy(
                        update={
                            "advance_s": extruder.advance_s or machine.simulated.nozzle_pressure_s
                        }
                        if self.advance
                        else {"advance_s": None, "advance_smooth_s": None}
                    )
                    for name, extruder in machine.extruders.items()
                },
                "limits": limits,
            }
        )


def _jerk_mm_s3(machine: MachineConfig) -> float:
    x, y, _ = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    cycle_s = 1 / min(x.frequency_hz, y.frequency_hz)
    return machine.limits.jerk_mm_s3 or 2 * machine.largest_accel_mm_s2 / cycle_s


def _shaping(machine: MachineConfig, kind: ShaperType) -> dict[str, Shaping]:
    masses = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    shaping: dict[str, Shaping] = {}
    for name, mass in zip("xy", masses, strict=False):
        given = machine.shaping.get(name)
        hz = given.frequency_hz if given else min(max(mass.frequency_hz, MIN_HZ), MAX_HZ)
        damping = given.damping if given else min(mass.damping, 0.2)
        shaping[name] = Shaping(type=kind, frequency_hz=hz, damping=damping)
    return shaping


@dataclass(frozen=True, slots=True)
class Trial:
    """What came out of one setting. The time is that without heating. `off_tune_rms_um` is the
    ringing if everything vibrates 10 % slower than the shapers expect, as a heavier print does.
    `corner` is the same corner in all trials."""

    name: str
    print_time_s: float
    quality: Quality
    off_tune_rms_um: float
    steps: int
    commands: int
    corner: ShownCorner | None = None


@dataclass(slots=True)
class Laboratory:
    """The trials of one file on one machine, in their order, and which one is best."""

    file: str
    machine: str
    weight: Weight
    trials: list[Trial] = field(default_factory=list[Trial])
    warnings: list[str] = field(default_factory=list[str])

    def scores(self) -> list[float]:
        """The cost of each trial; the least is best. Ringing (the mean of that on tune and off
        tune), rounding of corners and width error count as fractions of the largest one of all
        trials, and time by how much longer a print is than the shortest one: half as long again
        counts 1, as does more. The wanted criterion counts four times."""
        shortest = min(trial.print_time_s for trial in self.trials) or 1.0
        ringing = [t.quality.ringing_rms_um + t.off_tune_rms_um for t in self.trials]
        columns: dict[Weight, list[float]] = {
            "ringing": _relative(ringing),
            "corners": _relative([t.quality.rounding_um for t in self.trials]),
            "lines": _relative([t.quality.width_error for t in self.trials]),
            "time": [min((t.print_time_s / shortest - 1) / _LONGER, 1.0) for t in self.trials],
        }
        factors = {name: _HEAVY if name == self.weight else 1.0 for name in columns}
        counted = ([factors[n] * value for value in column] for n, column in columns.items())
        return [sum(row) / sum(factors.values()) for row in zip(*counted, strict=True)]

    @property
    def best(self) -> int:
        """The index of the best trial, the first of equal ones."""
        scores = self.scores()
        return scores.index(min(scores))

    def reason(self) -> str:
        """One sentence: the best setting, and what it changes."""
        first, best = self.trials[0], self.trials[self.best]
        wanted = f"With the weight on {self.weight} ({WEIGHTS[self.weight]})"
        if best is first:
            return f"{wanted}, {best.name} is best: nothing that was tried is better."
        was, now = first.quality, best.quality
        longer = best.print_time_s / first.print_time_s - 1
        return (
            f"{wanted}, {best.name} is best: {now.ringing_rms_um:.1f} µm of ringing instead of"
            f" {was.ringing_rms_um:.1f} µm, corners rounded by {now.rounding_um:.0f} µm instead of"
            f" {was.rounding_um:.0f} µm, a width error of {now.width_error:.1%} instead of"
            f" {was.width_error:.1%}; the print takes {abs(longer):.1%}"
            f" {'longer' if longer >= 0 else 'less time'}."
        )

    def as_dict(self) -> dict[str, Any]:
        """All figures, for JSON."""
        scores = self.scores()
        return {
            "file": self.file,
            "machine": self.machine,
            "weight": self.weight,
            "best": self.trials[self.best].name,
            "trials": [
                {
                    "name": trial.name,
                    "print_time_s": trial.print_time_s,
                    **asdict(trial.quality),
                    "off_tune_rms_um": trial.off_tune_rms_um,
                    "steps": trial.steps,
                    "commands": trial.commands,
                    "score": score,
                }
                for trial, score in zip(self.trials, scores, strict=True)
            ],
            "warnings": self.warnings,
        }


def _relative(values: Sequence[float]) -> list[float]:
    most = max(values)
    return [value / most if most > 0 else 0.0 for value in values]


def settings_for(machine: MachineConfig) -> list[Setting]:
    """Each filter and each law of junctions by itself, and a shaper with advance. A machine without
    an extruder has no advance."""
    settings = [Setting(), *(Setting(shaper) for shaper in SHAPER_TYPES), Setting(jerk_limit=True)]
    if machine.extruders:
        settings += [Setting(advance=True), Setting(_ADVANCED, advance=True)]
    laws = [Setting(junction=law) for law in JUNCTIONS]
    return settings + [setting for setting in laws if setting.junction != machine.limits.junction]


def run_laboratory(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    weight: Weight = "balance",
    policy: Policy | None = None,
    begun: Callable[[str, int, int], None] = lambda name, number, of: None,
    compared: RecordedStream | None = None,
) -> Laboratory:
    """Prints the file under each setting, and, if the best shaper is another than that, once more
    with the best shaper and advance; then plays the stream that is compared. `begun` is called
    before each print. Raises InputError and MachineError."""
    found = Laboratory(str(path), machine.name, weight)
    policy = replace(policy or Policy(), own_filters=True)
    settings = settings_for(machine)
    for number, setting in enumerate(settings):
        begun(setting.name, number + 1, len(settings))
        found.trials.append(_trial(found, machine, path, policy, setting))
    shaped = range(1, 1 + len(SHAPER_TYPES))
    scores = found.scores()
    best = settings[min(shaped, key=lambda i: scores[i])]
    if machine.extruders and best.shaper != _ADVANCED:
        last = replace(best, advance=True)
        begun(last.name, len(settings) + 1, len(settings) + 1)
        found.trials.append(_trial(found, machine, path, policy, last))
    if compared is not None:
        plain = found.trials[0].corner
        found.trials.append(_played(machine, path, policy, compared, plain))
    found.warnings += [
        f"{trial.name}: the head did not follow the file for {trial.quality.lost:.0%} of the time;"
        " nothing is measured there"
        for trial in found.trials
        if trial.quality.lost > _LOST
    ]
    return found


def _played(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    policy: Policy,
    stream: RecordedStream,
    corner: ShownCorner | None,
) -> Trial:
    """Plays the stream by the path and the steps of the file without filters."""
    plain = Setting().on(machine)
    result, watch = _printed(plain, path, policy, corner, keep_path=True)
    played = stream.play(plain, watch.measured, result.steps, corner)
    off_tune = stream.play(_slower(plain), watch.measured, result.steps, corner)
    return Trial(
        Path(stream.name).name,
        played.print_time_s,
        played.quality,
        off_tune.quality.ringing_rms_um,
        played.steps,
        played.commands,
        played.corner,
    )


def _trial(
    found: Laboratory,
    machine: MachineConfig,
    path: str | os.PathLike[str],
    policy: Policy,
    setting: Setting,
) -> Trial:
    set_up = setting.on(machine)
    shown = found.trials[0].corner if found.trials else None
    result, watch = _printed(set_up, path, policy, shown)
    _, off_tune = _printed(_slower(set_up), path, policy, shown)
    found.warnings += [line for line in result.warnings if line not in found.warnings]
    return Trial(
        setting.name,
        result.print_time_s - result.heat_time_s,
        watch.quality,
        off_tune.quality.ringing_rms_um,
        sum(result.steps.values()),
        result.queue_step_commands,
        watch.corner,
    )


def _printed(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    policy: Policy,
    shown: ShownCorner | None,
    *,
    keep_path: bool = False,
) -> tuple[PrintResult, QualityWatch]:
    job = Print(machine, policy)
    corner = shown.number if shown else None
    watch = QualityWatch(machine, job, corner, keep_path=keep_path)
    job.watch_steps(watch)
    return job.run(path), watch


def _slower(machine: MachineConfig) -> MachineConfig:
    """The machine with masses that vibrate slower."""
    masses = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    slower = {
        name: mass.model_copy(update={"frequency_hz": _SLOWER * mass.frequency_hz})
        for name, mass in zip("xyz", masses, strict=True)
    }
    simulated = machine.simulated.model_copy(update={"masses": slower})
    return machine.model_copy(update={"simulated": simulated})
