"""Sensors of a machine file: what the ADC sees of them."""

from __future__ import annotations

import pytest
from tests.heat.oven import Oven
from tests.heat.tables import celsius_at

from passo.config import platinum
from passo.config.sensor_tables import open_is_high, sensor_table, share_at
from passo.config.sensors import (
    Platinum,
    PlatinumAmplifier,
    SensorTable,
    Thermistor,
    ThermocoupleAmplifier,
)
from passo.printer.setup.sensors import sensor_of


@pytest.mark.parametrize(
    ("celsius", "ohm"),
    [
        (-200, 18.52), (-100, 60.26), (-50, 80.31), (0, 100.0), (25, 109.73), (100, 138.51),
        (200, 175.86), (400, 247.09), (850, 390.48),
    ],
)  # fmt: skip
def test_platinum_resistance_follows_iec_60751(celsius, ohm):
    assert platinum.ohm(celsius, 100.0) == pytest.approx(ohm, abs=0.005)
    assert platinum.celsius(platinum.ohm(celsius, 1000.0), 1000.0) == pytest.approx(
        celsius, abs=1e-6
    )


@pytest.mark.parametrize(
    ("celsius", "volts"), [(1, 1.11), (10, 1.15), (20, 1.20), (30, 1.24), (400, 2.66), (500, 3.00)]
)
def test_pt100_with_amplifier(celsius, volts):
    table = sensor_table(PlatinumAmplifier(kind="pt100-amplifier"))
    assert share_at(table, celsius) * 5 == pytest.approx(volts, abs=0.006)


def test_a_pt1000_under_a_pull_up():
    table = sensor_table(Platinum(kind="pt1000"))
    assert share_at(table, 25) == pytest.approx(1097.35 / 5797.35, abs=1e-6)
    assert share_at(table, 235) == pytest.approx(1886.5 / 6586.5, abs=1e-4)
    assert table[0][0] == -50
    assert table[-1][0] == 850


@pytest.mark.parametrize(("kind", "by_raw"), [("ad595", 500 / 1024), ("ad8495", 1000 / 1024)])
def test_thermocouple_amplifiers(kind, by_raw):
    table = sensor_table(ThermocoupleAmplifier(kind=kind))
    for raw in (10, 100, 1000):
        assert celsius_at(table, raw / 1024) == pytest.approx(raw * by_raw, abs=1e-4)
    corrected = sensor_table(ThermocoupleAmplifier(kind=kind, scale=1.1, offset_c=-3.0))
    assert celsius_at(corrected, 100 / 1024) == pytest.approx(110 * by_raw - 3, abs=1e-4)
    assert celsius_at(table, 1.0) < 1.0 * 1024 * by_raw  # full scale lies beyond the table: broken


def test_a_table_is_sorted():
    sensor = SensorTable(kind="table", points=[[200.0, 0.2], [25.0, 0.9]], open_reads="low")
    assert sensor_table(sensor) == ((25.0, 0.9), (200.0, 0.2))
    assert not open_is_high(sensor)


def test_thermistor_table_ends_are_faults():
    table = sensor_table(Thermistor())
    assert open_is_high(Thermistor())
    assert table[0] == (-20.0, pytest.approx(0.99556, abs=1e-5))
    assert table[-1][0] == 400
    assert celsius_at(table, 0.5) == pytest.approx(114.45, abs=0.3)
    shifted = sensor_table(Thermistor(adc_offset_low=4.0))
    assert share_at(shifted, 400) - share_at(table, 400) == pytest.approx(8 / 1024, rel=0.02)


def test_a_sensor_is_changed_while_it_measures():
    oven = Oven()
    oven.heat(200.0)
    oven.run(180)
    old = sensor_table(Thermistor())
    new = Thermistor(beta_k=4436.0)
    config = oven.machine.heaters["hotend"].model_copy(update={"sensor": new, "max_c": 230.0})
    oven.connection.set_sensor("hotend", sensor_of(oven.machine, "hotend", config))
    oven.run(0.5)
    shown = celsius_at(sensor_table(new), share_at(old, 200.0))
    assert oven.heater.celsius == pytest.approx(shown, abs=1.0)
    assert shown == pytest.approx(171.0, abs=1.0)
    oven.run(60)
    assert oven.faults == []
    assert oven.heater.celsius == pytest.approx(200, abs=1.5)
    # The board keeps to the new range by itself.
    silence = oven.connection.now
    oven.board.force_sensor("hotend", share_at(sensor_table(new), 240.0))
    oven.board.device.poll(silence + 2 * oven.hz)
    assert oven.board.device.fault == "ADC out of range"
