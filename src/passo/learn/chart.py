"""A chart over time as HTML and SVG. It is complete without scripts; with `page.js` it zooms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from passo.learn.labels import clock_label, clock_unit, label, round_step, ticks, time_step
from passo.learn.series import Series

_STATIC = 480  # columns of the picture without scripts
_SIDE = 1000.0  # side of the square that SVG scales to the plot
_TIMES, _VALUES = 6, 5  # maximum labels


@dataclass(frozen=True, slots=True)
class Curve:
    """A series with its name in the legend. `colour` is an index of the page's palette; a `dashed`
    curve is the target of the other curve of the same colour."""

    name: str
    series: Series
    colour: int
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves of one unit over the time of a job. `key` identifies the chart within the page."""

    key: str
    title: str
    unit: str
    curves: Sequence[Curve]

    def data(self) -> dict[str, object]:
        """The data that the script draws."""
        return {"key": self.key, "curves": [curve.series.encoded() for curve in self.curves]}

    def html(self, end_s: float) -> str:
        """The section of the page, with all data from 0 to `end_s` seconds."""
        step = time_step(end_s, _TIMES)
        columns = [(t, clock_label(t, step, end_s)) for t in ticks(0.0, end_s, step)]
        under = f'print time, <span class="time">{clock_unit(step, end_s)}</span>'
        return f"""<section class="chart" data-key="{escape(self.key)}">
<h2>{escape(self.title)}</h2>
{self.plot(end_s, columns, under)}</section>
"""

    def plot(self, end_s: float, columns: Sequence[tuple[float, str]], under: str) -> str:
        """Legend and plot alone. `columns` are the labels of times in seconds, and `under` is what
        they mean, as HTML."""
        low, high, step = self._scale()
        rows = ticks(low, high, step)
        grid = "".join(f"M0 {_y(v, low, high):.1f}H{_SIDE:.0f}" for v in rows)
        grid += "".join(f"M{_SIDE * t / end_s:.1f} 0V{_SIDE:.0f}" for t, _ in columns)
        y = "".join(
            f'<span style="top:{_y(v, low, high) / 10:.2f}%">{label(v, step)}</span>' for v in rows
        )
        x = "".join(
            f'<span style="left:{100 * t / end_s:.2f}%">{escape(text)}</span>'
            for t, text in columns
        )
        curves = "".join(_paths(curve, end_s, low, high) for curve in self.curves)
        title, unit = escape(self.title), escape(self.unit)
        return f"""<p class="legend">{"".join(map(_key, self.curves))}</p>
<div class="axis"><span>{unit}</span></div>
<div class="plot" role="img" aria-label="{title}, {unit}, over the print time">
<svg viewBox="0 0 1000 1000" preserveAspectRatio="none" aria-hidden="true">\
<path class="grid" d="{grid}"/>{curves}</svg>
<div class="y">{y}</div><div class="x">{x}</div>
</div>
<div class="under">{under}</div>
"""

    def _scale(self) -> tuple[float, float, float]:
        """Round bounds of the values, including 0, and the step between labels."""
        ranges = [curve.series.range() for curve in self.curves if curve.series]
        low = min([0.0, *(a for a, _ in ranges)])
        high = max([0.0, *(b for _, b in ranges)])
        if low == high:
            high = 1.0
        step = round_step(high - low, _VALUES)
        low, high = step * math.floor(low / step + 1e-6), step * math.ceil(high / step - 1e-6)
        return low, high, step


def _y(value: float, low: float, high: float) -> float:
    return _SIDE * (high - value) / (high - low)


def _key(curve: Curve) -> str:
    line = " dashed" if curve.dashed else ""
    name = f'<i class="line{line}"></i>{escape(curve.name)} <b></b>'
    return f'<span class="k c{curve.colour}">{name}</span>'


def _paths(curve: Curve, end_s: float, low: float, high: float) -> str:
    """The line of a curve. If a column has more values than a line can show, the line is their
    mean, with a band from the minimum to the maximum."""
    series = curve.series
    dashed = ' stroke-dasharray="5 4"' if curve.dashed else ""
    if not series:
        points: list[tuple[float, float]] = []
        band = ""
    elif series.columns is None and len(series.times_s) <= 2 * _STATIC:
        points = [(t, v) for t, v in zip(series.times_s, series.values, strict=True) if t <= end_s]
        band = ""
    else:
        bands = series.bands(end_s, _STATIC)
        points = [((a + b) / 2, mean) for a, b, _, _, mean in bands]
        edge = [((a + b) / 2, v) for a, b, _, v, _ in bands]
        edge += [((a + b) / 2, v) for a, b, v, _, _ in reversed(bands)]
        band = f"M{_line(edge, end_s, low, high)}z" if edge else ""
    line = f"M{_line(points, end_s, low, high)}" if points else ""
    return (
        f'<path class="band c{curve.colour}" d="{band}"/>'
        f'<path class="line c{curve.colour}"{dashed} d="{line}"/>'
    )


def _line(points: Sequence[tuple[float, float]], end_s: float, low: float, high: float) -> str:
    return "L".join(f"{_SIDE * t / end_s:.2f} {_y(v, low, high):.1f}" for t, v in points)
