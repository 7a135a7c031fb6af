"""Numbers by hand: 6 prints of 4 h in each of 52 weeks."""

import pytest

from passo.learn.lessons.counters_and_service import EXPERIMENT, LESSON


def test_counters_of_a_year():
    outcome = EXPERIMENT.run({})
    found = {number.name: number.value for number in outcome.numbers}
    assert found == pytest.approx(
        {
            "prints": 312,
            "failed": 15.6,
            "year_h": 1248,
            "on_h": 8736,
            "use_percent": 14.2857,
            "filament_km": 3.744,
            "belt_km": 224.64,  # 1248 · 3600 · 50 mm
            "service_weeks": 12.5,
        },
        rel=1e-5,
    )


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(16)  # 400 / 25
    assert LESSON.asked(1).answer == pytest.approx(202.176)  # 936 · 3600 · 60 mm
