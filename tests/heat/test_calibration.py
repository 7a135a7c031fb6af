"""Calibration of β against a worked example."""

from __future__ import annotations

import pytest

from passo.config.thermistor import Ntc
from passo.heat.calibration import Point, by_averages, by_least_squares, by_steinhart_hart

NTC = Ntc(100_000.0, 3950.0)
POINTS = [Point(180, 169), Point(200, 177), Point(220, 194), Point(240, 208)]


def test_averages_of_readings_are_weighted():
    found = by_averages(NTC, POINTS)
    assert found.beta_k == pytest.approx(4435.83, abs=0.005)
    assert found.residuals_c == pytest.approx((-13.41, -5.58, -6.96, -5.56), abs=0.01)
    assert found.rms_c == pytest.approx(8.5, abs=0.1)


def test_least_squares_fit_equals_the_oracle():
    found = by_least_squares(NTC, POINTS)
    assert found.beta_k == pytest.approx(4303.5, abs=0.5)
    assert found.residuals_c == pytest.approx((-7.6, 1.2, 0.9, 3.3), abs=0.06)
    assert found.rms_c < by_averages(NTC, POINTS).rms_c


def test_true_readings_change_nothing():
    points = [Point(c, c) for c in (160, 200, 240)]
    for method in (by_averages, by_least_squares):
        assert method(NTC, points).beta_k == pytest.approx(3950, abs=0.01)


def test_a_fit_finds_the_beta_that_made_the_readings():
    true = Ntc(100_000.0, 4260.0, 5e-8)
    shown = Ntc(100_000.0, 3950.0, 5e-8)
    points = [Point(c, true.celsius(shown.ohm(c))) for c in (160, 180, 200, 220)]
    found = by_least_squares(shown, points)
    assert found.beta_k == pytest.approx(4260, abs=0.01)
    assert found.rms_c < 1e-3


def test_three_coefficients_of_a_thermistor_are_found():
    true = Ntc(98_000.0, 4180.0, 9e-8)
    points = [Point(c, true.celsius(NTC.ohm(c))) for c in (40, 100, 160, 200, 240)]
    found = by_steinhart_hart(NTC, points)
    assert found is not None
    assert found.r25_ohm == pytest.approx(98_000, rel=1e-3)
    assert found.beta_k == pytest.approx(4180, rel=1e-3)
    assert found.c_per_k == pytest.approx(9e-8, rel=0.01)
    assert found.rms_c < 1e-3


def test_too_few_or_close_readings_give_no_three_coefficients():
    assert by_steinhart_hart(NTC, POINTS[:3]) is None
    close = [Point(200 + k / 100, 200 + k / 100) for k in range(5)]
    assert by_steinhart_hart(NTC, close) is None
