"""What the motion filters do around the fastest corner of a print, as data of a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from passo.learn.chart import Chart, Curve
from passo.learn.series import Series

if TYPE_CHECKING:
    from passo import _core

_AXES = ("X", "Y")
_E = 3  # slot of the filament
_BENDS = 8  # straight lines for the speed of a part with jerk

# Start and duration in s; at the start position, speed, acceleration and jerk.
Part = tuple[float, float, float, float, float, float]


def filter_picture(job: _core.Job) -> dict[str, object] | None:
    """Speed and acceleration of X and Y, and the speed of the filament, as planned and as executed
    with filters, around the corner that the job has kept. Call it at the end of the job. None if no
    motion was filtered."""
    if job.results.corner is None:
        return None
    line, x, y, corner_s = job.results.corner
    laws = {
        slot: (job.results.corner_law(slot, False), job.results.corner_law(slot, True))
        for slot in (0, 1, _E)
    }
    start_s = laws[0][0][0][0]
    last = [parts[-1] for both in laws.values() for parts in both]
    took_s = max(at_s - start_s + part_s for at_s, part_s, *_ in last)

    def drawn(title: str, unit: str, series: _Drawing, slots: Sequence[tuple[str, int]]) -> Chart:
        curves = list[Curve]()
        for colour, (name, slot) in enumerate(slots):
            for parts, how in zip(laws[slot], ("planned", "executed"), strict=True):
                one = series(parts, start_s)
                shown = f"{name}{how}, peak {_peak(one)}"
                curves.append(Curve(shown, one, colour, dashed=how == "planned"))
        return Chart(title, unit, curves)

    axes = [(f"{name} ", slot) for slot, name in enumerate(_AXES)]
    charts = [
        drawn("Speed of X and Y", "mm/s", _speed, axes),
        drawn("Acceleration of X and Y", "mm/s\N{SUPERSCRIPT TWO}", _acceleration, axes),
    ]
    if any(any(_speed(parts, start_s).range()) for parts in laws[_E]):
        charts.append(drawn("Speed of the filament", "mm/s", _speed, [("", _E)]))
    before_s = start_s - corner_s
    return {
        "title": f"What the filters do: the fastest corner, line {line}, X{x:.1f} Y{y:.1f}",
        "start_s": start_s,
        "took_s": took_s,
        "columns_ms": [1e3 * before_s, 1e3 * (before_s + took_s)],
        "charts": [chart.data() for chart in charts],
    }


_Drawing = Callable[[Sequence[Part], float], Series]


def _speed(parts: Sequence[Part], start_s: float) -> Series:
    series = Series()
    for at_s, took_s, _, speed, acceleration, jerk in parts:
        bends = _BENDS if jerk else 1
        points = [
            (u, speed + u * (acceleration + u * jerk / 2))
            for u in (took_s * i / bends for i in range(bends + 1))
        ]
        for (u, v), (u_end, v_end) in pairwise(points):
            series.add(at_s - start_s + u, v, at_s - start_s + u_end, v_end)
    return series


def _acceleration(parts: Sequence[Part], start_s: float) -> Series:
    series = Series()
    for at_s, took_s, _, _, acceleration, jerk in parts:
        at = at_s - start_s
        series.add(at, acceleration, at + took_s, acceleration + jerk * took_s)
    return series


def _peak(series: Series) -> str:
    value = max(map(abs, series.range()))
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}"
