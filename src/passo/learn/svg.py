"""Pictures of experiments as SVG: for documents, and planes for the page, too."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from itertools import chain
from math import ceil, floor, log10

from passo.learn.bilingual import Language, figure, said
from passo.learn.pictures import Graph, Line, Plane

_WIDTH, _HEIGHT = 720, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 20, 44, 46
_PLANE = 420  # the longer side of a plane
_LEGEND = 20  # height of a row
_ROWS = 5  # labels of an axis, at most
_STYLE = (
    "text{font:12px sans-serif;fill:#333}.title{font-size:14px;font-weight:bold}"
    ".grid{stroke:#ddd;fill:none}.line{fill:none;stroke:currentColor;stroke-width:1.8;"
    "stroke-linejoin:round}.dashed{stroke-dasharray:5 4}.dot{fill:currentColor}"
    ".c0{color:#1f77b4}.c1{color:#d1590b}.c2{color:#238b45}.c3{color:#9467bd}.c4{color:#b8292f}"
    ".c5{color:#0f8a8a}.c6{color:#777}"
)


_Scaled = Callable[[float], float]


def graph_svg(graph: Graph, language: Language) -> str:
    """A file with the curves of a graph."""
    across = [x for line in graph.lines for x in line.x]
    from_x, to_x, step_x = _scale(across, tight=True)
    up = [y for line in graph.lines for y in line.y]
    low, high, step_y = _scale([*graph.values, *up])
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM

    def x_of(value: float) -> float:
        return _LEFT + (right - _LEFT) * (value - from_x) / (to_x - from_x)

    def y_of(value: float) -> float:
        return bottom - (bottom - _TOP) * (value - low) / (high - low)

    parts: list[str] = []
    for value in _ticks(low, high, step_y):
        parts.append(f'<path class="grid" d="M{_LEFT} {y_of(value):.1f}H{right}"/>')
        parts.append(_text(_LEFT - 6, y_of(value) + 4, _label(value, step_y), "end"))
    for value in _ticks(from_x, to_x, step_x):
        parts.append(f'<path class="grid" d="M{x_of(value):.1f} {_TOP}V{bottom}"/>')
        parts.append(_text(x_of(value), bottom + 16, _label(value, step_x), "middle"))
    parts.append(_text((_LEFT + right) / 2, bottom + 34, said(graph.across, language), "middle"))
    parts.append(_text(_LEFT, _TOP - 8, said(graph.unit, language), "start"))
    for line in graph.lines:
        parts.append(_path(line, [(x_of(x), y_of(y)) for x, y in zip(line.x, line.y, strict=True)]))
    legend, height = _legend(graph.lines, language, _HEIGHT)
    return _file(said(graph.title, language), [*parts, *legend], _WIDTH, height)


def plane_svg(plane: Plane, language: Language, *, file: bool = False) -> str:
    """The lines and points of a plane, to scale: for a page that has the style, or as a file."""
    xs = [x for line in plane.lines for x in line.x] + [mark.x for mark in plane.marks]
    ys = [y for line in plane.lines for y in line.y] + [mark.y for mark in plane.marks]
    span = max(max(xs) - min(xs), max(ys) - min(ys)) or 1.0
    scale = _PLANE / span
    edge = 48 if plane.unit else 30
    width = scale * (max(xs) - min(xs)) + 2 * edge + (0 if plane.unit else 60)
    height = scale * (max(ys) - min(ys)) + 2 * edge

    def x_of(value: float) -> float:
        return edge + scale * (value - min(xs))

    def y_of(value: float) -> float:
        return edge + scale * (max(ys) - value)

    parts: list[str] = []
    if plane.unit:
        parts += _axes(plane, language, x_of, y_of, (xs, ys), (width, height, edge))
    for line in plane.lines:
        parts.append(_path(line, [(x_of(x), y_of(y)) for x, y in zip(line.x, line.y, strict=True)]))
    for mark in plane.marks:
        x, y = x_of(mark.x), y_of(mark.y)
        if mark.dot:
            parts.append(f'<circle class="dot c{mark.colour}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>')
        dx, dy, anchor = _BESIDE[mark.beside]
        if name := said(mark.name, language):
            parts.append(_text(x + dx, y + dy, name, anchor))
    legend, height = _legend([line for line in plane.lines if line.name], language, height)
    title = said(plane.title, language)
    return _file(title, [*parts, *legend], max(width, 320), height, styled=file)


_BESIDE = {
    "right": (9.0, 4.0, "start"),
    "left": (-9.0, 4.0, "end"),
    "above": (0.0, -9.0, "middle"),
    "below": (0.0, 17.0, "middle"),
    "on": (0.0, 4.0, "middle"),
}


def _axes(
    plane: Plane,
    language: Language,
    x_of: _Scaled,
    y_of: _Scaled,
    spans: tuple[Sequence[float], Sequence[float]],
    size: tuple[float, float, float],
) -> list[str]:
    (xs, ys), (width, height, edge) = spans, size
    step = _round_step(max(max(xs) - min(xs), max(ys) - min(ys)) or 1.0)
    parts: list[str] = []
    for value in _ticks(min(xs), max(xs), step):
        parts.append(f'<path class="grid" d="M{x_of(value):.1f} {edge}V{height - edge:.1f}"/>')
        parts.append(_text(x_of(value), height - edge + 16, _label(value, step), "middle"))
    for value in _ticks(min(ys), max(ys), step):
        parts.append(f'<path class="grid" d="M{edge} {y_of(value):.1f}H{width - edge:.1f}"/>')
        parts.append(_text(edge - 6, y_of(value) + 4, _label(value, step), "end"))
    parts.append(_text(width - edge, height - edge + 32, said(plane.unit, language), "end"))
    return parts


def _path(line: Line, points: Sequence[tuple[float, float]]) -> str:
    dashed = " dashed" if line.dashed else ""
    text = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    return f'<path class="line c{line.colour}{dashed}" d="M{text}"/>'


def _legend(lines: Sequence[Line], language: Language, top: float) -> tuple[list[str], float]:
    """A row for each line, and the height of the picture with them."""
    parts: list[str] = []
    for row, line in enumerate(lines):
        y = top + _LEGEND * row + 4
        dashed = " dashed" if line.dashed else ""
        parts.append(f'<path class="line c{line.colour}{dashed}" d="M{_LEFT} {y:.1f}h22"/>')
        parts.append(_text(_LEFT + 30, y + 4, said(line.name, language), "start"))
    return parts, top + _LEGEND * len(lines) + (8 if lines else 0)


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _file(
    title: str, parts: Sequence[str], width: float, height: float, *, styled: bool = True
) -> str:
    size = f"{width:.0f} {height:.0f}"
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" role="img"'
        f' aria-label="{escape(title, quote=True)}">'
    )
    style = [
        f"<style>{_STYLE}</style>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
        f'<text class="title" x="{width / 2:.1f}" y="18" text-anchor="middle">'
        f"{escape(title)}</text>",
    ]
    return "\n".join(chain([head], style if styled else [], parts, ["</svg>", ""]))


def _scale(values: Sequence[float], *, tight: bool = False) -> tuple[float, float, float]:
    """Bounds around values, and a round step; round bounds unless `tight`."""
    low, high = min(values), max(values)
    if low == high:
        high += 1
    step = _round_step(high - low)
    if tight:
        return low, high, step
    return step * floor(low / step + 1e-6), step * ceil(high / step - 1e-6), step


def _round_step(span: float) -> float:
    power = 10.0 ** floor(log10(span / _ROWS))
    return next(n * power for n in (1, 2, 5, 10, 20) if n * power * _ROWS >= span * 0.999999)


def _ticks(low: float, high: float, step: float) -> list[float]:
    return [i * step for i in range(ceil(low / step - 1e-6), floor(high / step + 1e-6) + 1)]


def _label(value: float, step: float) -> str:
    decimals = max(0, -floor(log10(step) + 1e-9))
    return figure(value, decimals)
