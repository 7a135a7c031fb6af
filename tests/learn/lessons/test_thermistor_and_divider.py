"""Numbers of other sources: 100 kΩ at 25 °C, β 3950, pull-up 4700 Ω."""

from math import exp

import pytest

from passo.learn.lessons.thermistor_and_divider import EXPERIMENT, LESSON


def test_resistance_voltage_and_count_at_200_c():
    outcome = EXPERIMENT.run({})
    ohm = 100_000 * exp(3950 * (1 / 473.15 - 1 / 298.15))
    assert ohm == pytest.approx(744.61, abs=0.01)
    assert outcome["ohm"] == pytest.approx(ohm)
    assert outcome["volt"] == pytest.approx(0.68381, abs=1e-5)  # 5 · 744.61 / 5444.61
    assert outcome["count"] == 140  # of 1024 · 0.136761 = 140.04
    assert outcome["read_c"] == pytest.approx(200)


@pytest.mark.parametrize(("celsius", "bits", "per_count_c"), [(200, 10, 0.47), (240, 12, 0.23)])
def test_a_count_is_the_distance_of_two_temperatures(celsius, bits, per_count_c):
    def share(at_c):
        ohm = 100_000 * exp(3950 * (1 / (at_c + 273.15) - 1 / 298.15))
        return ohm / (ohm + 4700)

    slope = (share(celsius - 0.01) - share(celsius + 0.01)) / 0.02
    assert 1 / slope / 2**bits == pytest.approx(per_count_c, abs=0.005)
    found = EXPERIMENT.run({"celsius": celsius, "bits": bits})
    assert found["per_count_c"] == pytest.approx(1 / slope / 2**bits, rel=1e-3)


def test_a_wrong_pull_up_shows_a_wrong_temperature():
    outcome = EXPERIMENT.run({"assumed_pullup_ohm": 2200})
    ohm = 2200 * 744.612 / 4700  # the same share, taken for that of another divider
    assert ohm == pytest.approx(348.54, abs=0.01)
    assert outcome["read_c"] == pytest.approx(247.3, abs=0.05)
    assert outcome["error_c"] == pytest.approx(47.3, abs=0.05)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(2.987, abs=1e-3)
    assert LESSON.asked(1).answer == pytest.approx(0.2308, abs=1e-3)
