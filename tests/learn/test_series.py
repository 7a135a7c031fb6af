"""Series: exact while they are short, then bounded with all their extremes."""

from __future__ import annotations

import math
import random

import pytest
from tests.learn.pages import Curve

from passo.learn import series as rooms
from passo.learn.series import Series


def filled(pieces: int, length_s: float, seed: int = 1) -> tuple[Series, list[tuple[float, ...]]]:
    """A series of random pieces, with jumps, and the pieces."""
    rng, series, rows, t = random.Random(seed), Series(), list[tuple[float, ...]](), 0.0
    for _ in range(pieces):
        end = t + rng.uniform(0.1, 1.9) * length_s / pieces
        row = (t, rng.uniform(-50, 100), end, rng.uniform(-50, 100))
        series.add(*row)
        rows.append(row)
        t = end
    return series, rows


def test_a_trapezoid_is_kept_with_its_four_corners():
    series = Series()
    for row in [(0, 0, 0.25, 50), (0.25, 50, 1, 50), (1, 50, 1.5, 0)]:
        series.add(*row)
    assert Curve.of(series.encoded()).corners == [(0, 0), (0.25, 50), (1, 50), (1.5, 0)]


def test_a_jump_has_two_corners_and_a_level_only_its_ends():
    series = Series()
    for i in range(1000):
        series.add(i, 7, i + 1, 7)
    series.add(1000, 9, 1001, 9)
    series.hold(1010)
    assert Curve.of(series.encoded()).corners == [(0, 7), (1000, 7), (1000, 9), (1010, 9)]


@pytest.mark.parametrize("length_s", [0.02, 3.0, 90_000.0])
def test_a_long_series_keeps_extremes_and_means_of_each_column(length_s, monkeypatch):
    monkeypatch.setattr(rooms, "MAX_CORNERS", 200)
    monkeypatch.setattr(rooms, "MAX_COLUMNS", 64)
    series, rows = filled(3000, length_s)
    curve = Curve.of(series.encoded())
    width = curve.width_s
    assert math.log2(width) == int(math.log2(width))
    assert 32 <= len(curve.columns) <= 65
    for i, (low, high, mean) in curve.columns.items():
        values, area, span = [], 0.0, 0.0
        for t0, v0, t1, v1 in rows:
            a, b = max(t0, i * width), min(t1, (i + 1) * width)
            if b <= a:
                continue
            u, v = (v0 + (v1 - v0) * (t - t0) / (t1 - t0) for t in (a, b))
            values += [u, v]
            area, span = area + (u + v) / 2 * (b - a), span + b - a
        rounding = 100 / 32_767
        assert (low, high) == pytest.approx((min(values), max(values)), abs=rounding)
        assert mean == pytest.approx(area / span, abs=2 * rounding)


def test_memory_does_not_grow_with_the_length(monkeypatch):
    monkeypatch.setattr(rooms, "MAX_CORNERS", 200)
    monkeypatch.setattr(rooms, "MAX_COLUMNS", 64)
    sizes = []
    for pieces in (10_000, 100_000):
        series, _ = filled(pieces, pieces)
        sizes.append(len(str(series.encoded())))
        assert len(series.times_s) == 0
    assert sizes[1] < 1.3 * sizes[0] < 2000


def test_time_before_the_first_value_has_no_columns(monkeypatch):
    monkeypatch.setattr(rooms, "MAX_CORNERS", 4)
    series = Series()
    for second in range(5, 10):
        series.add(second, 20 * second, second + 1, 0)
    curve = Curve.of(series.encoded())
    assert min(curve.columns) * curve.width_s == pytest.approx(5, abs=curve.width_s)
    assert not Series()
    assert Series().range() == (0, 0)
