"""The farm for Prometheus: its own metrics, and the list of its printers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, get_args
from urllib.parse import urlsplit

from starlette.responses import Response

from passo.hub.call import HubCall
from passo.hub.views import Condition
from passo.web.answers import JSON, json
from passo.web.operation import operation
from passo.web.prometheus import CONTENT, Metric, answer
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.hub.views import Farm
    from passo.hub.wishes import Statistics


@operation("discovery.prometheus", "GET", "/sd/prometheus", Role.VIEWER, produces=JSON, root="")
async def targets(call: HubCall) -> Response:
    """The Passo printers, for Prometheus' discovery over HTTP."""
    found = [
        {
            "targets": [urlsplit(printer.url).netloc],
            "labels": {
                "__scheme__": urlsplit(printer.url).scheme,
                "__metrics_path__": f"{urlsplit(printer.url).path.rstrip('/')}/metrics",
                "printer": printer.name,
                "tags": ",".join(printer.tags),
            },
        }
        for printer in call.view().printers
        if printer.kind == "passo"
    ]
    return json(found)


@operation("metrics.get", "GET", "/metrics", Role.VIEWER, produces=CONTENT, root="")
async def metrics(call: HubCall) -> Response:
    """The farm for Prometheus."""
    return answer(*_metrics(call.view(), await call.farm.statistics(), call.site.wall_s()))


def _metrics(farm: Farm, totals: Statistics, now_s: float) -> Iterator[Metric]:
    conditions = Counter(printer.condition for printer in farm.printers)
    counts = {condition: float(conditions[condition]) for condition in get_args(Condition)}
    yield Metric("passo_hub_printers", "gauge", "Printers by what they do.", "condition", counts)
    reached = {
        printer.name: float(printer.condition not in ("connecting", "unreachable"))
        for printer in farm.printers
    }
    yield Metric("passo_hub_printer_reached", "gauge", "1 if it answers.", "printer", reached)
    attention = {"": float(sum(bool(printer.attention) for printer in farm.printers))}
    yield Metric("passo_hub_attention", "gauge", "Printers that need a user.", "", attention)
    due = {"": float(sum(bool(printer.service_due) for printer in farm.printers))}
    yield Metric("passo_hub_service_due", "gauge", "Printers whose service is due.", "", due)
    waiting = {"": float(sum(job.waiting for job in farm.jobs))}
    yield Metric("passo_hub_queue_length", "gauge", "Prints that wait.", "", waiting)
    paused = {"": float(farm.queue_paused)}
    yield Metric("passo_hub_queue_paused", "gauge", "1 if nothing starts.", "", paused)
    waits = [now_s - job.added_s for job in farm.jobs if job.waiting]
    text = "Age of the oldest job that waits."
    yield Metric("passo_hub_queue_oldest_seconds", "gauge", text, "", {"": max(waits, default=0.0)})
    results = {
        "done": float(totals.done),
        "failed": float(totals.failed),
        "cancelled": float(totals.cancelled),
    }
    yield Metric("passo_hub_runs_total", "counter", "Prints that are over.", "result", results)
    printed = {"": totals.printed_s}
    yield Metric("passo_hub_printed_seconds_total", "counter", "Without pauses.", "", printed)
    filament = {"": totals.filament_mm}
    name = "passo_hub_filament_millimeters_total"
    yield Metric(name, "counter", "Pushed in all prints.", "", filament)
    used = {group.name: group.used_w for group in farm.groups}
    yield Metric("passo_hub_power_watts", "gauge", "Of heating printers.", "group", used)
    limits = {group.name: group.limit_w for group in farm.groups}
    yield Metric("passo_hub_power_limit_watts", "gauge", "Limit of a group.", "group", limits)
