"""A graph in characters, for a terminal."""

from __future__ import annotations

from passo.learn.bilingual import Language, figure, said
from passo.learn.pictures import Graph

_COLUMNS, _ROWS = 60, 12
_SIGNS = "*o+x#%"


def text_graph(graph: Graph, language: Language) -> str:
    """The curves of a graph as signs, with the bounds of both axes and a legend."""
    xs = [x for line in graph.lines for x in line.x]
    ys = [y for line in graph.lines for y in line.y] + list(graph.values)
    (left, right), (low, high) = (min(xs), max(xs)), (min(ys), max(ys))
    across, up = right - left or 1.0, high - low or 1.0
    cells = [[" "] * _COLUMNS for _ in range(_ROWS)]
    for number, line in enumerate(graph.lines):
        sign = _SIGNS[number % len(_SIGNS)]
        points = list(zip(line.x, line.y, strict=True))
        for i, (x, y) in enumerate(points):
            x1, y1 = points[min(i + 1, len(points) - 1)]
            parts = 1 + round(max(_COLUMNS * abs(x1 - x) / across, _ROWS * abs(y1 - y) / up))
            for k in range(parts):
                column = round((_COLUMNS - 1) * (x + (x1 - x) * k / parts - left) / across)
                row = round((_ROWS - 1) * (y + (y1 - y) * k / parts - low) / up)
                cells[_ROWS - 1 - row][column] = sign
    decimals = 0 if up >= 20 else 2
    names = [figure(high, decimals), *[""] * (_ROWS - 2), figure(low, decimals)]
    width = max(map(len, names))
    lines = [f"{said(graph.title, language)}, {said(graph.unit, language)}"]
    rows = zip(names, cells, strict=True)
    lines += [f"{name:>{width}} |{''.join(row)}".rstrip() for name, row in rows]
    lines.append(f"{'':>{width}} +{'-' * _COLUMNS}")
    decimals = 0 if across >= 20 else 2
    ends = figure(left, decimals), figure(right, decimals)
    axis = said(graph.across, language).center(_COLUMNS - len(ends[0]) - len(ends[1]))
    lines.append(f"{'':>{width}}  {ends[0]}{axis}{ends[1]}")
    for number, line in enumerate(graph.lines):
        lines.append(f"  {_SIGNS[number % len(_SIGNS)]} {said(line.name, language)}")
    return "\n".join(lines)
