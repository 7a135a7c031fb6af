"""One page with the pictures of a print: self-contained HTML, no network."""

from __future__ import annotations

import html
import json
import os
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.job.durable_files import replaced
from passo.learn.collector import Collector, Density, of_actuator, of_axis
from passo.motion.axis_slots import slot_of_axis

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.result import PrintResult

_LOOK_S = 0.5  # from one reading of temperatures to the next, while they are few


def write_report(
    machine: MachineConfig, path: str | os.PathLike[str], output: Path, policy: Policy
) -> PrintResult:
    """Prints the file on the simulated board and writes the page; it appears whole or not at all.

    Raises InputError, MachineError, OSError.
    """
    motors = _motors(machine)
    collector = Collector(machine.board.clock_hz, motors)
    job = Print(machine, policy, collector.look, _LOOK_S)
    job.job.keep_moves(True)
    job.watch(lambda: collector.take(job.job.take_moves()))
    result = job.run(path)
    page = files("passo.learn").joinpath("report.html").read_text(encoding="utf-8")
    data = _data(collector, job, result, machine, list(motors))
    name = os.fsencode(Path(path).name).decode("utf-8", "backslashreplace")
    title = html.escape(f"{name} on {machine.name}")
    page = page.replace("@TITLE@", title)
    page = page.replace("@DATA@", json.dumps(data, separators=(",", ":")).replace("</", "<\\/"))
    with replaced(output) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return result


def _motors(machine: MachineConfig) -> dict[str, Density]:
    spec = machine.core_spec()
    geometry = _core.Geometry(spec["geometry"])
    motors: dict[str, Density] = {}
    for row in spec["steppers"]:
        index, steps = row["index"], row["steps_per_unit"]
        if row["drive"] == "extruder":
            motors[row["name"]] = of_axis(3, steps, index)
        elif row["drive"] == "axis":
            motors[row["name"]] = of_axis(slot_of_axis(index), steps)
        else:
            motors[row["name"]] = of_actuator(geometry, index, steps)
    return motors


def _data(
    collector: Collector,
    job: Print,
    result: PrintResult,
    machine: MachineConfig,
    motors: list[str],
) -> dict[str, Any]:
    x, y, _ = (machine.axes[name] for name in "xyz")
    paths = [
        (layer, round(a, 2), round(b, 2), round(c, 2), round(d, 2), round(v, 1), int(prints))
        for layer, a, b, c, d, v, prints in collector.paths
    ]
    return {
        "bed": [x.min_mm, y.min_mm, x.max_mm, y.max_mm],
        "paths": paths,
        "bucket_s": collector.bucket_s,
        "speed": [round(b.speed, 1) for b in collector.buckets],
        "accel": [round(b.accel) for b in collector.buckets],
        "rates": {
            name: [round(b.rates.get(name, 0.0)) for b in collector.buckets] for name in motors
        },
        "celsius": {
            name: [(round(s, 1), round(c, 1)) for s, c in rows]
            for name, rows in collector.celsius.items()
        },
        "limits": result.limits,
        "features": job.job.statistics()["feature_s"],
        "summary": _summary(result),
    }


def _summary(result: PrintResult) -> list[tuple[str, str]]:
    minutes, seconds = divmod(round(result.print_time_s), 60)
    return [
        ("Print time", f"{minutes // 60} h {minutes % 60:02} min {seconds:02} s"),
        ("Moving", f"{result.move_time_s:.0f} s"),
        ("Heating", f"{result.heat_time_s:.0f} s"),
        ("Waiting", f"{result.dwell_time_s:.0f} s"),
        ("Layers", f"{result.layers}"),
        ("Moves", f"{result.moves:,}"),
        ("Filament", ", ".join(f"{n} {mm:.1f} mm" for n, mm in result.filament_mm.items())),
        ("Motor steps", f"{sum(result.steps.values()):,}"),
        ("Board commands", f"{result.queue_step_commands:,}"),
        (
            "Step time error",
            "{max:.2f} µs at most, {rms:.2f} µs rms".format(**result.step_error_us),
        ),
        ("Stream", result.stream_hash),
    ]
