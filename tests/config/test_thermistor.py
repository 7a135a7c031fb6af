"""NTC resistors and their dividers against worked tables, both ways."""

from __future__ import annotations

from math import exp

import pytest
from hypothesis import given
from hypothesis import strategies as st

from passo.config.thermistor import Divider, Ntc

BETAS = (3950.0, 4092.0, 4436.0)
# R25 100 kΩ under 4.7 kΩ: raw of 10 bits, Ω, °C for each β.
WORKED = [
    (1000, 200100, (10.166, 10.656, 11.719)),
    (978, 101075.8, (24.759, 24.768, 24.786)),
    (512, 4709.19, (114.382, 110.392, 102.058)),
    (256, 1570.75, (161.167, 154.391, 140.471)),
    (100, 511.48, (222.288, 211.167, 188.799)),
    (60, 295.12, (258.992, 244.884, 216.860)),
    (30, 144.29, (315.765, 296.487, 258.917)),
]


@pytest.mark.parametrize(("raw", "ohm", "celsius"), WORKED)
def test_thermistor_table_equals_the_worked_example(raw, ohm, celsius):
    divider = Divider(4700.0)
    found = divider.ohm((raw + 0.5) / 1024)
    assert found == pytest.approx(ohm, rel=2e-5)
    for beta_k, expected in zip(BETAS, celsius, strict=True):
        ntc = Ntc(100_000.0, beta_k)
        assert ntc.celsius(found) == pytest.approx(expected, abs=6e-4)
        assert divider.share(ntc.ohm(expected)) * 1024 - 0.5 == pytest.approx(raw, abs=0.004)


@pytest.mark.parametrize(
    ("r25", "beta_k", "celsius", "code"),
    [
        (100_000, 3960, 25, 735), (100_000, 3960, 100, 6622), (100_000, 3960, 200, 14166),
        (100_000, 3960, 240, 15149), (10_000, 3480, 25, 5238), (10_000, 3480, 100, 13610),
        (10_000, 3480, 200, 15931),
    ],
)  # fmt: skip
def test_oversampled_adc_codes_are_scaled(r25, beta_k, celsius, code):
    share = Divider(4700.0).share(Ntc(r25, beta_k).ohm(celsius))
    assert 16383 - int(0.5 + 16383 * share) == code


def test_beta_formula_by_resistance_at_infinity():
    assert 100_000 * exp(-3960 / 298.15) == pytest.approx(0.170507, abs=1e-6)
    assert Ntc(100_000, 3960).celsius(0.170507 * exp(3960 / 500.0)) == pytest.approx(
        500 - 273.15, abs=1e-3
    )


def test_the_cubic_term_follows_the_full_equation():
    ntc = Ntc(100_000.0, 4092.0, 1e-7)
    assert ntc.celsius(100_000.0) == pytest.approx(25.0, abs=1e-9)
    # With ln R = 6.9078 at 1 kΩ and 11.5129 at 100 kΩ:
    # 1/T = 1/298.15 + (6.907755 - 11.512925)/4092 + 1e-7 (329.6211 - 1526.0019) = 0.0021089577 / K
    assert ntc.celsius(1000.0) == pytest.approx(1 / 0.0021089577 - 273.15, abs=0.01)
    assert ntc.celsius(1000.0) > Ntc(100_000.0, 4092.0).celsius(1000.0) + 20


@given(
    st.floats(-20, 400), st.floats(1e3, 1e6), st.floats(2500, 5500), st.floats(0, 4e-7),
    st.floats(-8, 8), st.floats(-8, 8),
)  # fmt: skip
def test_resistance_and_temperature_are_inverse(celsius, r25, beta_k, c, low, high):
    ntc, divider = Ntc(r25, beta_k, c), Divider(4700.0, low, high)
    ohm = ntc.ohm(celsius)
    assert ntc.celsius(ohm) == pytest.approx(celsius, abs=1e-6)
    assert divider.ohm(divider.share(ohm)) == pytest.approx(ohm, rel=1e-6)


def test_table_ends_move_with_the_offset():
    divider = Divider(4700.0, offset_low=2.0, offset_high=-3.0)
    # R = 4700 · (511.5 - 4 + 0.5) / (1024 - 6 - 511.5 - 0.5)
    assert divider.ohm(512 / 1024) == pytest.approx(4700 * 508 / 506)
    for share in (4 / 1024, 0.0, 1018 / 1024, 1.0):
        with pytest.raises(ValueError, match="no resistance"):
            divider.ohm(share)


def test_impossible_resistance_has_no_temperature():
    with pytest.raises(ValueError, match="beyond any temperature"):
        Ntc(100_000.0, 3950.0).celsius(0.1)
