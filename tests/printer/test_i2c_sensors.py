"""Sensor chips on I2C: readings of the simulated chips, and their faults."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.i2c_sensors import I2C_KINDS
from passo.config.load import shipped_text
from passo.printer.klipper.objects import objects

BUS = 'scl_pin = "D11", sda_pin = "D6"'
HUMID = ("bme280", "bme680", "htu21d", "si7013", "si7020", "si7021", "sht21", "sht3x")
HUMID += ("aht1x", "aht2x", "aht3x")
PRESSED = ("bme280", "bmp280", "bmp180", "bme680")


def machine(*sensors: str, firmware: str = "virtual"):
    """A RAMPS with these sensors: `name = "kind"` and further keys."""
    text = shipped_text("i3").replace("[fans.part]", f"{''.join(sensors)}[fans.part]")
    if firmware == "passo":
        text = text.replace("[board]\n", '[board]\nfirmware = "passo"\n')
    return config.load_text(text)


def sensor(name: str, kind: str, keys: str = "", more: str = "") -> str:
    return f'[sensors.{name}]\nsensor = {{ kind = "{kind}", {BUS}{keys} }}\n{more}'


def seen(s, name: str = "room"):
    return s.printer.status.read().sensors[name]


def shown(s):
    return objects(s.machine, Sections(s.machine), s.printer.status.read(), {})


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
@pytest.mark.parametrize("kind", I2C_KINDS)
def test_chip_shows_what_it_measures(kind, firmware):
    with Scenario(machine(sensor("room", kind), firmware=firmware)) as s:
        chip = s.board.sensor_chips["room"]
        chip.celsius, chip.humidity, chip.pressure_hpa = 41.25, 27.5, 987.5
        assert s.until(lambda: seen(s).celsius is not None, 4)
        near = 0.26 if kind == "lm75" else 0.06
        assert seen(s).celsius == pytest.approx(41.25, abs=near)
        assert seen(s).humidity == (pytest.approx(27.5, abs=0.1) if kind in HUMID else None)
        assert seen(s).pressure_hpa == (pytest.approx(987.5, abs=0.1) if kind in PRESSED else None)
        chip.celsius, chip.humidity, chip.pressure_hpa = -11.0, 71.0, 1021.0
        s.passes(4)
        assert seen(s).celsius == pytest.approx(-11.0, abs=near)
        assert seen(s).humidity == (pytest.approx(71.0, abs=0.1) if kind in HUMID else None)
        assert seen(s).pressure_hpa == (pytest.approx(1021, abs=0.1) if kind in PRESSED else None)
