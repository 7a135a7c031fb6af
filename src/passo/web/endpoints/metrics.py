"""The status in Prometheus' text format 0.0.4."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from starlette.responses import Response

from passo.printer.status import PrinterState
from passo.version import __version__
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.prometheus import CONTENT, Metric, answer
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.printer.status import Status


@operation("metrics.get", "GET", "/metrics", Role.VIEWER, produces=CONTENT, root="")
async def metrics(call: Call) -> Response:
    """The status for Prometheus."""
    status, machine = call.bridge.latest().status, call.bridge.machine.name
    info = {machine: 1.0}
    version = f'version="{__version__}"'
    about = Metric("passo_info", "gauge", "What serves which machine.", "machine", info, version)
    return answer(about, *_metrics(status))


def _metrics(status: Status) -> Iterator[Metric]:
    states = {state.name.lower(): float(status.state is state) for state in PrinterState}
    yield Metric("passo_state", "gauge", "1 for what the printer does.", "state", states)
    seconds = {"": status.time_s}
    yield Metric("passo_print_time_seconds", "gauge", "Print time since the start.", "", seconds)
    heaters = status.heaters.items()
    for name, text, values in (
        ("temperature_celsius", "Temperature.", {n: h.current_c for n, h in heaters}),
        ("target_celsius", "Target, 0 if it is off.", {n: h.target_c for n, h in heaters}),
        ("heater_power_ratio", "Fraction of full power.", {n: h.power for n, h in heaters}),
        ("heater_fault", "1 after a protection.", {n: float(bool(h.fault)) for n, h in heaters}),
    ):
        yield Metric(f"passo_{name}", "gauge", text, "heater", values)
    text = "Fraction of full speed."
    yield Metric("passo_fan_speed_ratio", "gauge", text, "fan", status.fans)
    axes = status.axes.items()
    places = {name: axis.machine_mm for name, axis in axes}
    text = "Position in machine coordinates."
    yield Metric("passo_axis_position_millimeters", "gauge", text, "axis", places)
    homed = {name: float(axis.homed) for name, axis in axes}
    yield Metric("passo_axis_homed", "gauge", "1 if the position is certain.", "axis", homed)
    queued = {"": status.motion.queued_s}
    yield Metric("passo_queued_motion_seconds", "gauge", "Motion that is planned.", "", queued)
    if status.job is not None:
        done = {"": status.job.fraction}
        yield Metric("passo_job_progress_ratio", "gauge", "Done of the print.", "", done)
        printed = {"": status.job.printed_s}
        yield Metric("passo_job_printed_seconds", "gauge", "Without pauses.", "", printed)
        filament = {"": status.job.filament_mm}
        yield Metric("passo_job_filament_millimeters", "gauge", "Pushed so far.", "", filament)
    boards = status.boards.items()
    sent = {name: float(board.bytes_sent) for name, board in boards}
    resent = {name: float(board.bytes_resent) for name, board in boards}
    yield Metric("passo_board_sent_bytes_total", "counter", "Over the link.", "board", sent)
    yield Metric("passo_board_resent_bytes_total", "counter", "Sent again.", "board", resent)
