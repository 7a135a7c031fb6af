"""The result of a print."""

from __future__ import annotations

import resource
import time
from dataclasses import asdict, dataclass, field
from math import sqrt
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.job.batch.board_load import BudgetUse, budget_use
from passo.job.batch.first_layer import FirstLayer

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


@dataclass(slots=True)
class PrintResult:
    """The figures of one print; `--json` prints these fields. print_time = move + heat + dwell.
    `cpu_s` is the processor time of this job by stage, and its sum in `total`, without the start of
    the program. `process_peak_rss_mb` is the peak of the whole process, which includes earlier and
    parallel jobs.
    """

    file: str
    machine: str
    lines: int = 0
    moves: int = 0
    arcs: int = 0
    print_time_s: float = 0.0
    move_time_s: float = 0.0
    heat_time_s: float = 0.0
    dwell_time_s: float = 0.0
    filament_mm: dict[str, float] = field(default_factory=dict[str, float])
    travel_mm: float = 0.0
    layers: int = 0
    first_layer: FirstLayer | None = None
    final_position_mm: dict[str, float] = field(default_factory=dict[str, float])
    steps: dict[str, int] = field(default_factory=dict[str, int])
    final_steps: dict[str, int] = field(default_factory=dict[str, int])
    net_steps_expected: dict[str, int] = field(default_factory=dict[str, int])
    reversal_pairs_dropped: dict[str, int] = field(default_factory=dict[str, int])
    queue_step_commands: int = 0
    wire_bytes: int = 0
    step_error_us: dict[str, float] = field(default_factory=dict[str, float])
    limits: dict[str, float] = field(default_factory=dict[str, float])
    budget: BudgetUse = field(default_factory=BudgetUse)
    stream_hash: str = ""
    warnings: list[str] = field(default_factory=list[str])
    errors: list[str] = field(default_factory=list[str])
    cpu_s: dict[str, float] = field(default_factory=dict[str, float])
    process_peak_rss_mb: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """All fields, for JSON."""
        return asdict(self)

    def take_plan(
        self, job: _core.Job, axes: list[str], extruders: list[str], machine: MachineConfig
    ) -> None:
        """Copies the figures of the plan."""
        plan = job.results.statistics()
        self.lines, self.moves, self.arcs = plan["lines"], plan["moves"], plan["arcs"]
        self.move_time_s, self.dwell_time_s = plan["move_s"], plan["dwell_s"]
        self.travel_mm, self.layers = plan["travel_mm"], plan["layers"]
        self.filament_mm = dict(zip(extruders, plan["filament_mm"], strict=True))
        self.final_position_mm = dict(zip([*axes, *extruders], plan["position_mm"], strict=True))
        self.limits = plan["limit_s"]
        self.budget = budget_use(plan, machine)
        self.print_time_s = self.move_time_s + self.heat_time_s + self.dwell_time_s

    def take_steps(self, job: _core.Job, clock_hz: int) -> None:
        """Copies the figures of the step solver and the compressor."""
        rows = job.motors.statistics()
        self.reversal_pairs_dropped = {row["name"]: row["dropped_pairs"] for row in rows}
        self.net_steps_expected = {row["name"]: row["expected_net"] for row in rows}
        total = sum(row["steps"] for row in rows)
        square = sum(row["error_square_ticks2"] for row in rows)
        worst = max((row["error_max_ticks"] for row in rows), default=0.0)
        us = 1e6 / clock_hz
        self.step_error_us = {"max": worst * us, "rms": sqrt(square / total) * us if total else 0.0}


def process_peak_rss_mb() -> float:
    """The peak memory of this process since its start, in MB; systems do not measure it for each
    job."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def thread_cpu_s() -> float:
    """The processor seconds of this thread, by the same clock as the stages of the core. A job runs
    in one thread, so a difference belongs to this job even if others run."""
    return time.thread_time()
