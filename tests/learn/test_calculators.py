"""Calculators against numbers that are worked by hand."""

import pytest

from passo.learn.course import calculator


def found(name, **given):
    return {number.name: number.value for number in calculator(name).run(given).numbers}


@pytest.mark.parametrize(
    ("given", "volts"),
    [
        ({}, 0.952),  # A4988: 1.19 A · 8 · 0.1 Ω
        ({"driver": "DRV8825"}, 0.595),  # 1.19 A · 5 · 0.1 Ω
        ({"driver": "TMC2209", "sense_ohm": 0.11}, 1.2086),  # 1.19 · 2.5 · 0.13 / 0.32
    ],
)
def test_reference_voltage_of_a_driver(given, volts):
    numbers = found("motor-current", **given)
    assert numbers["reference_v"] == pytest.approx(volts, abs=1e-4)
    assert numbers["peak_a"] == pytest.approx(1.19)  # 70 % of 1.7 A
    assert numbers["heat_w"] == pytest.approx(2.266, abs=1e-3)  # 2 · 1.19²/2 · 1.6 Ω


@pytest.mark.parametrize(
    ("given", "power_w", "junction_c"),
    [
        ({"current_a": 4}, 0.288, 43),
        ({"current_a": 12}, 2.592, 187),
        ({"current_a": 12, "part": "IRLB8743"}, 0.504, 56.5),
        ({"current_a": 12, "part": "IRLB3034"}, 0.2448, 40.3),
    ],
)
def test_heat_of_mosfets(given, power_w, junction_c):
    numbers = found("mosfet-heat", **given)
    assert numbers["power_w"] == pytest.approx(power_w)
    assert numbers["junction_c"] == pytest.approx(junction_c)
    assert numbers["fits"] == (junction_c < 100)


def test_a_mosfet_whose_resistance_grows_is_hotter():
    numbers = found("mosfet-heat", current_a=8)
    # 1.152 W · 62.5 = 72; T = 25 + 72 / (1 - 72 · 0.006)
    assert numbers["junction_c"] == pytest.approx(97)
    assert numbers["hot_junction_c"] == pytest.approx(25 + 72 / 0.568)


def test_heater_at_another_voltage_and_its_warm_up():
    numbers = found("heater-power", supply_v=24)
    assert (numbers["ohm"], numbers["power_w"]) == pytest.approx((3.6, 160))  # 12² / 40; 24² / 3.6
    numbers = found("heater-power")
    assert numbers["final_c"] == pytest.approx(358.33, abs=0.01)  # 25 + 40 / 0.12
    assert numbers["warm_s"] == pytest.approx(99.3, abs=0.1)  # 133.3 · ln(333.33 / 158.33)
    assert numbers["hold_percent"] == pytest.approx(52.5)  # 0.12 · 175 / 40


def test_filament_of_a_line():
    numbers = found("line-and-flow")
    assert numbers["area_mm2"] == pytest.approx(0.0814159, abs=1e-6)  # 0.2 · 0.25 + π · 0.01
    assert numbers["e_mm"] == pytest.approx(3.3849, abs=1e-4)  # 8.14159 / 2.405282
    assert numbers["flow_mm3_s"] == pytest.approx(4.884956, abs=1e-5)


def test_volumetric_limit():
    numbers = found("volumetric-limit")
    assert numbers["highest_mm_s"] == pytest.approx(135.11, abs=0.01)  # 11 / 0.0814159
    assert numbers["fits"] == 0
    assert found("volumetric-limit", speed_mm_s=135)["fits"] == 1


def test_cost_of_a_print():
    numbers = found("filament-cost")
    assert numbers["mass_g"] == pytest.approx(29.825, abs=1e-3)  # 24.0528 cm³ · 1.24
    assert numbers["total_cost"] == pytest.approx(0.5965 + 0.108, abs=1e-4)


def test_step_rate_of_a_board():
    numbers = found("step-rate")
    assert (numbers["rate_hz"], numbers["interval_us"]) == (8000, 125)
    assert numbers["board_hz"] == pytest.approx(0.65 * 16e6 / 90)
    assert numbers["highest_mm_s"] == pytest.approx(722.22, abs=0.01)


def test_frequency_from_waves_and_the_time_of_shapers():
    numbers = found("ringing-shaper")
    assert numbers == {"frequency_hz": 40, "period_ms": 25, "wave_mm": 2.5}
    rows = {row[0]: float(row[1]) for row in calculator("ringing-shaper").run({}).tables[0].rows}
    assert rows["zv"] == pytest.approx(12.6, abs=0.05)  # half of a damped wave
    assert rows["ei"] == pytest.approx(25.1, abs=0.05)


def test_table_of_a_thermistor_goes_through_its_points():
    table = calculator("thermistor-table").run({"second_c": 160, "third_c": 260}).tables[0]
    rows = {row[0]: row for row in table.rows}
    assert (rows["160"][1], rows["260"][1]) == ("1642", "226")
    share = 226 / (226 + 4700)
    assert rows["260"][2:] == [f"{100 * share:.2f}", str(int(1024 * share))]
