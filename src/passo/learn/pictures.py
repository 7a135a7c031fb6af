"""What an experiment draws: curves over an axis, a plane to scale, and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from passo.learn.bilingual import Words


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points; `colour` is an index of the palette, 0 to 5."""

    name: Words
    x: Sequence[float]
    y: Sequence[float]
    colour: int = 0
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class Graph:
    """Lines of one unit over one axis. The points of a line are in the order of the axis; two
    points at one place are an edge. `across` is the axis with its unit. The vertical axis reaches
    `values` in any case."""

    title: Words
    across: Words
    unit: Words
    lines: Sequence[Line]
    values: Sequence[float] = (0.0,)


@dataclass(frozen=True, slots=True)
class Mark:
    """A point with a name; without a `dot` only the name. `beside` is the side of the text."""

    x: float
    y: float
    name: Words = ""
    colour: int = 0
    dot: bool = True
    beside: str = "right"


@dataclass(frozen=True, slots=True)
class Plane:
    """Lines and points to scale, y upward: a path, or a diagram. `unit` is that of both axes;
    empty: a diagram without axes."""

    title: Words
    lines: Sequence[Line]
    marks: Sequence[Mark] = ()
    unit: Words = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of words or finished figures, with a heading for each column."""

    title: Words
    columns: Sequence[Words]
    rows: Sequence[Sequence[Words]]


def edges(x: Sequence[float], y: Sequence[float]) -> tuple[list[float], list[float]]:
    """The points of a staircase: each value holds until the next place."""
    across, up = [x[0]], [y[0]]
    for i in range(1, len(x)):
        across += [x[i], x[i]]
        up += [y[i - 1], y[i]]
    return across, up
