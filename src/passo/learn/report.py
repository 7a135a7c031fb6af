"""`passo report`: one page with the pictures of a print."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.errors import PassoError
from passo.job.batch.policy import Policy
from passo.job.batch.result import PrintResult
from passo.job.batch.simulated_print import Print, Progress
from passo.job.durable_files import replaced
from passo.learn.bed_picture import bed_picture
from passo.learn.chart import Chart, Curve
from passo.learn.collector import Collector, HeaterSeries, Rates, of_actuator, of_axis
from passo.learn.filter_picture import filter_picture
from passo.learn.labels import duration
from passo.learn.page import page
from passo.learn.toolpath import Toolpath
from passo.motion.axis_slots import slot_of_axis

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.machine import MachineConfig
    from passo.job.batch.first_layer import FirstLayerWatch

_COLOURS = 6  # number of colours of the page's palette
_NO_PROGRAM = ("input.unreadable", "input.empty", "input.no-known-command")
_MIN_SHARE = 0.0005  # smallest fraction that gets a bar


def write_report(
    machine: MachineConfig, path: str | os.PathLike[str], output: Path, policy: Policy
) -> PrintResult:
    """Prints the file on the simulated board and writes the page, completely or not at all. If the
    print fails, the page shows the error and the plan so far, and the error is raised afterwards. A
    file that cannot be read or has no command gets no page. Raises InputError, MachineError,
    OSError.
    """
    x, y, _ = (machine.axes[name] for name in "xyz")
    collector = Collector(
        machine.board.clock_hz, _motors(machine), Toolpath((x.min_mm, y.min_mm, x.max_mm, y.max_mm))
    )

    def look(at: Progress) -> None:
        collector.look(at)
        job.every_s = collector.look_s

    job = Print(machine, policy, look, collector.look_s)
    job.job.results.keep_moves(True)
    job.job.results.keep_corner()
    job.watch(lambda: collector.take(job.job.results.take_moves()))
    result, failed = PrintResult(file=str(path), machine=machine.name), None
    try:
        job.run(path, result=result)
    except PassoError as error:
        if any(problem.code in _NO_PROGRAM for problem in error.problems):
            raise
        failed = error
        job.job.flush()  # plans the moves before the failed line
    collector.take(job.job.results.take_moves())
    filters = filter_picture(job.job)
    data = _data(collector, job.job.results.statistics(), result, failed, job.first_layer, filters)
    name = os.fsencode(Path(result.file).name).decode("utf-8", "backslashreplace")
    text = page(f"{name} on {result.machine}", "report", data)
    with replaced(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    try:
        if failed is not None:
            raise failed
    finally:
        # the traceback refers to this frame: this cycle would keep the whole print in memory
        failed = None
    return result


def _motors(machine: MachineConfig) -> dict[str, Rates]:
    spec = machine.core_spec()
    geometry = _core.Geometry(spec["geometry"])
    motors: dict[str, Rates] = {}
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
    plan: Mapping[str, Any],
    result: PrintResult,
    failed: PassoError | None,
    first_layer: FirstLayerWatch | None,
    filters: dict[str, object] | None,
) -> dict[str, object]:
    """What `draw/report.js` draws."""
    end_s = max(collector.planned_s, result.print_time_s) or collector.looked_s
    collector.finish(end_s)
    return {
        "problems": [str(problem) for problem in failed.problems] if failed else [],
        "result": [] if failed else _summary(result),
        "first_layer": bed_picture(first_layer),
        "limits": _shares(plan["limit_s"]),
        "features": _shares(plan["feature_s"]),
        "end_s": end_s,
        "finest_s": collector.speed.width_s,
        "charts": [chart.data() for chart in _charts(collector)] if end_s > 0 else [],
        "line": collector.line.encoded() if collector.line else None,
        "path": collector.path.data() if collector.path.lines else None,
        "filters": filters,
    }


def _charts(collector: Collector) -> list[Chart]:
    """The charts, without empty ones."""
    charts = list[Chart]()
    if any(collector.speed.range()):
        charts += [
            Chart("Speed along the path", "mm/s", [Curve("speed", collector.speed, 1)]),
            Chart(
                "Acceleration along the path; braking is negative",
                "mm/s\N{SUPERSCRIPT TWO}",
                [Curve("acceleration", collector.acceleration, 0)],
            ),
        ]
    heaters = {name: heater for name, heater in collector.heaters.items() if heater.celsius}
    if heaters:
        charts += _heat_charts(heaters)
    if any(any(rate.range()) for rate in collector.rates.values()):
        rates = [Curve(n, r, i % _COLOURS) for i, (n, r) in enumerate(collector.rates.items())]
        charts.append(Chart("Step rate of each motor", "steps/s", rates))
    return charts


def _heat_charts(heaters: Mapping[str, HeaterSeries]) -> list[Chart]:
    celsius, power = list[Curve](), list[Curve]()
    for i, (name, heater) in enumerate(heaters.items()):
        colour = i % _COLOURS
        celsius.append(Curve(name, heater.celsius, colour))
        if any(heater.target.range()):
            celsius.append(Curve(f"{name} target", heater.target, colour, dashed=True))
        power.append(Curve(name, heater.power, colour))
    unit = "\N{DEGREE SIGN}C"
    charts = [Chart("Temperature and target of each heater", unit, celsius)]
    if any(any(curve.series.range()) for curve in power):
        charts.append(Chart("Power of each heater", "% of full power", power))
    return charts


def _shares(parts: Mapping[str, float]) -> list[dict[str, object]]:
    total = sum(parts.values())
    return [
        {"name": name, "text": duration(seconds), "share": seconds / total}
        for name, seconds in sorted(parts.items(), key=lambda part: -part[1])
        if total > 0 and seconds / total >= _MIN_SHARE
    ]


def _summary(result: PrintResult) -> list[tuple[str, str]]:
    filament = ", ".join(f"{name} {mm:,.1f} mm" for name, mm in result.filament_mm.items())
    return [
        ("Print time", duration(result.print_time_s)),
        ("Moving", duration(result.move_time_s)),
        ("Heating", duration(result.heat_time_s)),
        ("Waiting", duration(result.dwell_time_s)),
        ("Layers", f"{result.layers:,}"),
        ("Moves", f"{result.moves:,}"),
        ("Filament", filament or "none"),
        ("Motor steps", f"{sum(result.steps.values()):,}"),
        ("Board commands", f"{result.queue_step_commands:,}"),
        (
            "Step time error",
            "{max:.2f} µs at most, {rms:.2f} µs rms".format(**result.step_error_us),
        ),
        ("Stream hash", result.stream_hash),
    ]
