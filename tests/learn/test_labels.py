"""Round values on axes."""

from __future__ import annotations

import pytest

from passo.learn.labels import clock_label, clock_unit, label, round_step, ticks, time_step


@pytest.mark.parametrize(
    ("span", "step"),
    [(100, 20), (101, 50), (0.4, 0.1), (3.1e-5, 1e-5), (7, 2), (19_999, 5000), (1, 0.2)],
)
def test_steps_are_round_and_at_most_five(span, step):
    assert round_step(span, 5) == pytest.approx(step)
    assert span / step <= 5


@pytest.mark.parametrize(
    ("span_s", "step"),
    [(0.5, 0.1), (5, 1), (11, 2), (61, 15), (600, 120), (3344, 600), (7200, 1800), (2e6, 345_600)],
)
def test_time_steps_divide_minutes_hours_and_days(span_s, step):
    assert time_step(span_s, 6) == pytest.approx(step)


@pytest.mark.parametrize(
    ("seconds", "step", "longest_s", "text", "unit"),
    [
        (0.05, 0.05, 0.2, "0.05", "s"),
        (90, 30, 120, "90", "s"),
        (90, 30, 121, "1:30", "min:s"),
        (59.96, 0.1, 600, "1:00.0", "min:s"),
        (7505, 60, 9000, "2:05", "h:min"),
        (7505, 5, 9000, "2:05:05", "h:min:s"),
        (7505.25, 0.05, 9000, "2:05:05.25", "h:min:s"),
    ],
)
def test_times_are_read_in_their_unit(seconds, step, longest_s, text, unit):
    assert clock_label(seconds, step, longest_s) == text
    assert clock_unit(step, longest_s) == unit


def test_numbers_have_the_decimals_of_their_step():
    assert [label(v, 2000) for v in ticks(-4000, 4000, 2000)] == [
        "\N{MINUS SIGN}4,000",
        "\N{MINUS SIGN}2,000",
        "0",
        "2,000",
        "4,000",
    ]
    assert [label(v, 0.2) for v in ticks(-0.2, 0.4, 0.2)] == [
        "\N{MINUS SIGN}0.2",
        "0.0",
        "0.2",
        "0.4",
    ]
