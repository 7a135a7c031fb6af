"""The machine with one of each part: what its status and Klipper's objects show."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo.config.exporting.settings import Sections
from passo.printer.klipper.objects import objects


@pytest.fixture
def s():
    with Scenario("i3-all-parts") as s:
        s.passes(2)
        yield s


def shown(s, name: str):
    return objects(s.machine, Sections(s.machine), s.printer.status.read(), {})[name]()


def test_inputs_count_each_change_of_their_level(s):
    door = s.printer.status.read().inputs["button-door"]
    assert (door.active, door.changes) == (False, 0)
    s.host.ok("SIMULATE_FAULT NAME=button-door VALUE=pressed")
    s.passes(1)
    door = s.printer.status.read().inputs["button-door"]
    assert (door.active, door.changes) == (True, 1)
    s.host.ok("SIMULATE_FAULT NAME=button-door VALUE=released")
    s.passes(1)
    assert s.printer.status.read().inputs["button-door"].changes == 2
    s.host.ok("M302 P1")
    s.host.ok("G1 E70 F600")
    s.host.ok("M400", 20)
    s.passes(1)
    # the simulated wheel changes its level four times in 7 mm
    assert s.printer.status.read().inputs["filament-encoder"].changes == pytest.approx(40, abs=1)


def test_fan_with_a_sensor_of_its_name_shows_the_temperature_once(s):
    assert shown(s, "heaters")["available_sensors"] == [
        *("extruder", "heater_bed", "temperature_sensor chamber", "temperature_fan electronics")
    ]
    assert shown(s, "temperature_fan electronics")["temperature"] == pytest.approx(38, abs=0.3)
    settings = shown(s, "configfile")["settings"]["temperature_fan electronics"]
    assert (settings["min_temp"], settings["max_temp"]) == (-273.15, 1200.0)
    assert settings["sensor_pin"] == "PK4"
    s.host.send('TEMPERATURE_WAIT SENSOR="temperature_fan electronics" MINIMUM=30')
    s.host.expect("^ok", 5)


@pytest.mark.parametrize(
    ("fault", "flags", "code"),
    [
        ("hot", {"otpw": 1}, "driver.hot"),
        ("short", {"s2ga": 1}, "driver.short-to-ground"),
        ("silent", None, "driver.silent"),
    ],
)
def test_simulated_driver_reports_its_fault_until_it_ends(s, fault, flags, code):
    s.host.ok(f"SIMULATE_FAULT NAME=z-driver VALUE={fault}")
    s.passes(2)
    z = s.printer.status.read().drivers["z"]
    assert (z.flags, [found.code for found in z.findings]) == (flags, [code])
    s.host.ok("SIMULATE_FAULT NAME=z-driver VALUE=none")
    s.passes(4)
    z = s.printer.status.read().drivers["z"]
    assert (z.flags, z.findings) == ({}, ())
