"""The path of a report."""

from __future__ import annotations

from itertools import pairwise
from math import cos, hypot, pi, sin

import pytest
from tests.learn.pages import unpacked

from passo.learn import toolpath
from passo.learn.toolpath import COLOURS, Line, Toolpath, thinned

BED = (0.0, 0.0, 200.0, 200.0)


def circle(chords: int, radius: float = 50.0, layer: int = 1) -> list[Line]:
    def at(i: int) -> tuple[float, float]:
        return 100 + radius * cos(2 * pi * i / chords), 100 + radius * sin(2 * pi * i / chords)

    return [Line(layer, *at(i), *at(i + 1), 40.0, True) for i in range(chords)]


@pytest.mark.parametrize("miss_mm", [0.005, 0.05, 0.5])
def test_joined_lines_miss_the_path_by_little(miss_mm):
    lines = circle(4096)
    for _ in range(20):
        lines = thinned(lines, miss_mm)
    assert len(lines) < 300
    for line in lines:
        x, y = (line.x0 + line.x1) / 2 - 100, (line.y0 + line.y1) / 2 - 100
        assert 50 - hypot(x, y) <= 4 * miss_mm  # each pass adds a quarter of the last
        assert (line.speed, line.prints, line.layer) == (40, True, 1)
    assert all((a.x1, a.y1) == (b.x0, b.y0) for a, b in pairwise(lines))


def test_lines_of_two_layers_or_kinds_are_never_joined():
    a = Line(1, 0, 0, 1, 0, 10, True)
    assert a.joined(Line(1, 1, 0, 2, 0, 30, True), 0.1) == Line(1, 0, 0, 2, 0, 30, True)
    for other in [
        Line(2, 1, 0, 2, 0, 10, True),
        Line(1, 1, 0, 2, 0, 10, False),
        Line(1, 1, 0.5, 2, 0.5, 10, True),  # begins elsewhere
        Line(1, 1, 0, 0.5, 0, 10, True),  # turns back
        Line(1, 1, 0, 1, 1, 10, True),  # a corner
    ]:
        assert a.joined(other, 0.1) is None


@pytest.mark.parametrize("apart", [False, True])
def test_a_path_of_any_length_has_a_bounded_number_of_lines(monkeypatch, apart):
    monkeypatch.setattr(toolpath, "MAX_LINES", 500)
    path = Toolpath(BED)
    for layer in range(1, 20):
        for line in circle(400, layer=layer):
            if apart:  # nothing can be joined
                line.x0 += 0.1
            path.add(line, 0.2 * layer, layer, layer + 1)
    assert 100 < len(path.lines) <= 500
    assert {line.layer for line in path.lines} == set(range(1, 20))


def test_the_page_has_each_line_with_its_colour_in_its_layer():
    path = Toolpath(BED)
    path.add(Line(0, 0, 0, 10, 0, 120, False), 5, 0, 1)
    path.add(Line(1, 10, 0, 90, 0, 50, True), 0.2, 1, 2)
    path.add(Line(1, 90, 0, 90, 60, 25, True), 0.2, 2, 4)
    path.add(Line(3, 90, 60, 10, 0, 100, True), 0.6, 4, 9)
    data = path.data()
    ends = unpacked(data["ends"], "H")
    mm = [data["origin"][i % 2] + data["unit"] * q for i, q in enumerate(ends)]
    assert mm[4:8] == pytest.approx([10, 0, 90, 0], abs=0.002)
    assert unpacked(data["colours"], "B") == [0, 7, 4, COLOURS]
    # Layers 0 to 3: first line, height, when it begins and ends; layer 2 has no moves.
    assert data["layers"] == [[0, 5, 0, 1], [1, 0.2, 1, 4], [3], [3, 0.6, 4, 9]]


def test_without_extrusion_all_moves_are_coloured():
    path = Toolpath(BED)
    path.add(Line(0, 0, 0, 10, 0, 100, False), 0, 0, 1)
    assert unpacked(path.data()["colours"], "B") == [COLOURS]
    assert path.data()["prints"] is False
