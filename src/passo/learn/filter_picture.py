"""What the motion filters do around the fastest corner of a print, as a section of a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from passo.learn.chart import Chart, Curve
from passo.learn.labels import label, round_step, ticks
from passo.learn.page import section
from passo.learn.series import Series

if TYPE_CHECKING:
    from passo import _core

_AXES = ("X", "Y")
_E = 3  # slot of the filament
_BENDS = 8  # straight lines for the speed of a part with jerk
_TIMES = 6  # maximum labels

# Start and duration in s; at the start position, speed, acceleration and jerk.
Part = tuple[float, float, float, float, float, float]


def filter_picture(job: _core.Job) -> str:
    """Speed and acceleration of X and Y, and the speed of the filament, as planned and as executed
    with filters, around the corner that the job has kept. Call it at the end of the job. Empty if
    no motion was filtered."""
    if job.results.corner is None:
        return ""
    line, x, y, corner_s = job.results.corner
    laws = {
        slot: (job.results.corner_law(slot, False), job.results.corner_law(slot, True))
        for slot in (0, 1, _E)
    }
    start_s = laws[0][0][0][0]
    last = [parts[-1] for both in laws.values() for parts in both]
    took_s = max(at_s - start_s + part_s for at_s, part_s, *_ in last)
    columns = _columns(start_s, took_s, corner_s)

    def drawn(title: str, unit: str, series: _Drawing, slots: Sequence[tuple[str, int]]) -> str:
        curves = list[Curve]()
        for colour, (name, slot) in enumerate(slots):
            for parts, how in zip(laws[slot], ("planned", "executed"), strict=True):
                one = series(parts, start_s)
                shown = f"{name}{how}, peak {_peak(one)}"
                curves.append(Curve(shown, one, colour, dashed=how == "planned"))
        plot = Chart("", title, unit, curves).plot(took_s, columns, "ms after the corner")
        return f"<h3>{title}</h3>\n{plot}"

    axes = [(f"{name} ", slot) for slot, name in enumerate(_AXES)]
    plots = [
        drawn("Speed of X and Y", "mm/s", _speed, axes),
        drawn("Acceleration of X and Y", "mm/s\N{SUPERSCRIPT TWO}", _acceleration, axes),
    ]
    if any(any(_speed(parts, start_s).range()) for parts in laws[_E]):
        plots.append(drawn("Speed of the filament", "mm/s", _speed, [("", _E)]))
    text = (
        "<p>Dashed: the plan. Solid: what the motors execute, with shapers, limit of jerk, pressure"
        " advance and backlash. The plan is drawn later by the time by which all motors follow it."
        f' <a href="#t={start_s:.4f},{start_s + took_s:.4f}">Show this time in the charts above'
        "</a>.</p>\n"
    )
    title = f"What the filters do: the fastest corner, line {line}, X{x:.1f} Y{y:.1f}"
    return section("filters", title, text + "".join(plots))


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
    return label(value, 10.0 if value >= 1000 else 1.0 if value >= 100 else 0.1)


def _columns(start_s: float, took_s: float, corner_s: float) -> list[tuple[float, str]]:
    """Labels of times: the s since the start, and the ms since the corner."""
    first, last = 1e3 * (start_s - corner_s), 1e3 * (start_s + took_s - corner_s)
    step = round_step(last - first, _TIMES)
    return [((ms - first) / 1e3, label(ms, step)) for ms in ticks(first, last, step)]
