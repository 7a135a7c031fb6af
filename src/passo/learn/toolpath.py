"""The path of a print, layer by layer, with a colour for its speed, as data for `draw/path.js`."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field

from passo.learn.series import packed

MAX_LINES = 120_000
COLOURS = 12  # number of colours for speeds
_ASPECT = 4 / 3  # width by height of the picture
_GRID = 65_535  # coordinates are in units of the longest side divided by this number
_FINEST_MM, _COARSEST_MM = 0.005, 1.0  # maximum error of joined lines
_FEWER = 0.9  # joining is repeated while it reduces the lines to this fraction

Box = tuple[float, float, float, float]  # x and y from, x and y to, mm


@dataclass(slots=True)
class Line:
    """A straight part of the path: its layer, its ends in mm, its maximum speed in mm/s."""

    layer: int
    x0: float
    y0: float
    x1: float
    y1: float
    speed: float
    prints: bool

    def joined(self, after: Line, miss_mm: float) -> Line | None:
        """One line for both, if the path deviates from it by at most `miss_mm`; else None."""
        if (after.layer, after.prints) != (self.layer, self.prints):
            return None
        if (after.x0, after.y0) != (self.x1, self.y1):
            return None
        dx, dy = after.x1 - self.x0, after.y1 - self.y0
        long = math.hypot(dx, dy)
        px, py = self.x1 - self.x0, self.y1 - self.y0
        if not long or not 0 <= px * dx + py * dy <= long * long:
            return None
        if abs(px * dy - py * dx) > miss_mm * long:
            return None
        speed = max(self.speed, after.speed)
        return Line(self.layer, self.x0, self.y0, after.x1, after.y1, speed, self.prints)


@dataclass(slots=True)
class Layer:
    """The height of a layer, mm, and the start and end times of its moves, s."""

    z_mm: float
    start_s: float
    end_s: float


@dataclass(slots=True)
class Toolpath:
    """Collects moves in order; `bed` is the area that the machine reaches. If there are too many
    lines, adjacent lines that are almost straight are joined; if there are still too many, some are
    dropped. So the memory is bounded for any file."""

    bed: Box
    lines: list[Line] = field(default_factory=list[Line])
    layers: dict[int, Layer] = field(default_factory=dict[int, Layer])
    _miss_mm: float = _FINEST_MM
    _every: int = 1  # one of this many lines is kept
    _count: int = 0

    def add(self, line: Line, z_mm: float, start_s: float, end_s: float) -> None:
        """Adds the next move."""
        layer = self.layers.get(line.layer)
        if layer is None:
            layer = self.layers[line.layer] = Layer(z_mm, start_s, end_s)
        layer.end_s = end_s
        if line.prints:
            layer.z_mm = z_mm
        if line.x0 == line.x1 and line.y0 == line.y1:
            return
        self._count += 1
        if self._count % self._every:
            return
        self.lines.append(line)
        if len(self.lines) > MAX_LINES:
            most = MAX_LINES * 3 // 4
            self.lines, self._miss_mm, times = reduced(self.lines, most, self._miss_mm)
            self._every <<= times

    @property
    def top(self) -> int:
        """The last layer."""
        return max(self.layers, default=0)

    @property
    def shown(self) -> int:
        """The layer that is shown first: the middle one."""
        return min(self.top, max(1, round(self.top / 2)))

    def data(self) -> dict[str, object]:
        """The data for the script of the page. Each line has four coordinates relative to `origin`,
        in units of `unit` mm, and a colour: 1 or more, or 0 for a move without extrusion."""
        x0, y0, x1, y1 = _box(self.lines, self.bed)
        unit = max(x1 - x0, y1 - y0) / _GRID
        ends, colours = array("H"), array("B")
        fastest, by_print = self._fastest(), self._prints()
        order = sorted(range(len(self.lines)), key=lambda i: self.lines[i].layer)
        firsts = dict[int, int]()
        for at, i in enumerate(order):
            line = self.lines[i]
            firsts.setdefault(line.layer, at)
            for value, least in ((line.x0, x0), (line.y0, y0), (line.x1, x0), (line.y1, y0)):
                ends.append(round((value - least) / unit))
            colours.append(_colour(line, fastest, by_print))
        layers, first = list[object](), len(order)
        for number in range(self.top, -1, -1):
            first = firsts.get(number, first)
            layer = self.layers.get(number)
            known = (layer.z_mm, layer.start_s, layer.end_s) if layer else ()
            layers.append([first, *(round(value, 3) for value in known)])
        return {
            "origin": [x0, y0],
            "unit": unit,
            "ends": packed(ends),
            "colours": packed(colours),
            "layers": layers[::-1],
            "layer": self.shown,
            "fastest": fastest,
            "prints": by_print,
            "view": self._view(),
            "bed": self.bed,
        }

    def _prints(self) -> bool:
        return any(line.prints for line in self.lines)

    def _fastest(self) -> float:
        by_print = self._prints()
        return max((line.speed for line in self.lines if line.prints or not by_print), default=1.0)

    def _view(self) -> Box:
        """The view box around all layers, in the aspect ratio of the picture. Moves without
        extrusion, and moves before the first layer, count only if there are no others."""
        printed = [line for line in self.lines if line.prints]
        x0, y0, x1, y1 = _box(
            [line for line in printed if line.layer] or printed or self.lines, self.bed
        )
        pad = 0.04 * max(x1 - x0, y1 - y0) + 1.0
        wide, high = x1 - x0 + 2 * pad, y1 - y0 + 2 * pad
        wide, high = max(wide, high * _ASPECT), max(high, wide / _ASPECT)
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        return (x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)


def reduced(lines: list[Line], most: int, miss_mm: float) -> tuple[list[Line], float, int]:
    """Reduces `lines` to at most `most`. Lines are joined with an error of `miss_mm` or, if
    necessary, more, up to `_COARSEST_MM`; then every second line is dropped. Returns the lines, the
    final error, and how often lines were dropped."""
    halved = 0
    while len(lines) > most:
        fewer = thinned(lines, miss_mm)
        if len(fewer) > _FEWER * len(lines):
            if miss_mm < _COARSEST_MM:
                miss_mm *= 2
            else:
                fewer, halved = fewer[::2], halved + 1
        lines = fewer
    return lines, miss_mm, halved


def thinned(lines: Iterable[Line], miss_mm: float) -> list[Line]:
    """Joins adjacent pairs of lines if the error is at most `miss_mm`."""
    out, single = list[Line](), False  # whether the last one is unchanged
    for line in lines:
        joined = out[-1].joined(line, miss_mm) if single else None
        if joined is None:
            out.append(line)
        else:
            out[-1] = joined
        single = joined is None
    return out


def _box(lines: Iterable[Line], otherwise: Box) -> Box:
    """The rectangle around all ends."""
    ends = [(x, y) for a in lines for x, y in ((a.x0, a.y0), (a.x1, a.y1))]
    if not ends:
        return otherwise
    xs, ys = zip(*ends, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _colour(line: Line, fastest: float, by_print: bool) -> int:
    if by_print and not line.prints:
        return 0
    return 1 + min(COLOURS - 1, int(line.speed / fastest * COLOURS)) if fastest > 0 else 1
