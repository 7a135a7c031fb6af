"""Metrics in Prometheus' text format 0.0.4."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import NamedTuple

from starlette.responses import Response

CONTENT = "text/plain; version=0.0.4; charset=utf-8"


class Metric(NamedTuple):
    """A metric: its values by label; an empty `label` has one value. `more` are further labels, as
    Prometheus reads them, of all values."""

    name: str
    kind: str
    text: str
    label: str
    values: Mapping[str, float | None]
    more: str = ""


def answer(*metrics: Metric) -> Response:
    """The metrics; those without a value are left out."""
    lines: list[str] = []
    for metric in metrics:
        values = {name: value for name, value in metric.values.items() if value is not None}
        if not values:
            continue
        lines.append(f"# HELP {metric.name} {metric.text}")
        lines.append(f"# TYPE {metric.name} {metric.kind}")
        for name, value in values.items():
            own = f'{metric.label}="{_escaped(name)}"' if metric.label else ""
            labels = ",".join(part for part in (own, metric.more) if part)
            shown = f"{{{labels}}}" if labels else ""
            lines.append(f"{metric.name}{shown} {_number(value)}")
    return Response("\n".join([*lines, ""]), media_type=CONTENT)


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")


def _number(value: float) -> str:
    if isfinite(value):
        return repr(float(value)).removesuffix(".0")
    return "NaN" if value != value else "+Inf" if value > 0 else "-Inf"
