"""Sensor chips on I2C: readings of the simulated chips, and their faults."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.i2c_sensors import I2C_KINDS
from passo.config.load import shipped_text
from passo.errors import ConfigError
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


CHIP = sensor("room", "bme280", more='on_fault = "machine"\nletter = "C"\n')


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_silent_chip_is_reported_once_and_stops_nothing(firmware):
    with Scenario(machine(CHIP, firmware=firmware)) as s:
        assert s.until(lambda: seen(s).celsius is not None, 4)
        s.host.ok("SIMULATE_FAULT NAME=room-sensor VALUE=silent")
        place = r"address 118 on I2C \(D11 and D6\)"
        s.host.expect(f"sensor room does not answer at {place}: the bus reports START_NACK", 8)
        s.host.silent(20, "room|halted")
        assert (seen(s).celsius, seen(s).humidity, seen(s).fault) == (None, None, "silent")
        assert shown(s)["bme280 room"]() == {"temperature": 0.0}
        assert " C:-273.15" in s.host.ok("M105")[0]
        s.host.ok("SIMULATE_FAULT NAME=room-sensor VALUE=none")
        assert s.until(lambda: seen(s).celsius is not None, 4)
        assert seen(s).fault == ""


def test_chip_that_is_missing_from_the_start_stops_nothing():
    with Scenario(machine(sensor("room", "sht3x"))) as s:
        s.board.sensor_chips["room"].plugged = False
        s.host.expect("sensor room does not answer at address 68", 8)
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("G1 X5 F3000")
        s.host.ok("M400", 10)


def test_another_chip_at_the_address_is_reported():
    with Scenario(machine(CHIP)) as s:
        s.board.sensor_chips["room"].registers[0xD0] = 0x33
        s.host.expect("the chip at address 118 on .* is not the one of sensor room: it reports", 8)
        assert (seen(s).celsius, seen(s).fault) == (None, "other-chip")


@pytest.mark.parametrize("kind", ["htu21d", "sht3x", "aht2x"])
def test_wrong_checksum_gives_no_value(kind):
    with Scenario(machine(sensor("room", kind))) as s:
        assert s.until(lambda: seen(s).celsius is not None, 4)
        s.host.ok("SIMULATE_FAULT NAME=room-sensor VALUE=garbled")
        s.host.expect("sensor room at address .* sends the checksum 0x.. in place of 0x..", 8)
        assert (seen(s).celsius, seen(s).fault) == (None, "garbled")


def test_one_lost_answer_is_not_a_fault():
    with Scenario(machine(sensor("room", "sht3x"))) as s:
        assert s.until(lambda: seen(s).celsius is not None, 4)
        s.board.sensor_chips["room"].plugged = False
        s.passes(2.5)
        s.board.sensor_chips["room"].plugged = True
        s.host.silent(10, "sensor room")
        assert seen(s).celsius is not None


def test_reading_beyond_the_range_halts_if_the_file_says_so():
    more = 'on_fault = "machine"\nmax_c = 60.0\n'
    with Scenario(machine(sensor("room", "lm75", more=more))) as s:
        s.passes(3)
        s.board.sensor_chips["room"].celsius = 70.0
        assert s.until(lambda: bool(s.printer.state.halted), 8)
        assert "sensor room reads 70.0 °C, above its maximum of 60.0 °C" in s.printer.state.halted
        s.board.sensor_chips["room"].celsius = 30.0
        s.host.ok("M999", 30)
        assert s.until(lambda: seen(s).celsius == 30.0, 5)


def test_chips_on_one_bus_with_a_light_do_not_mix():
    lamp = '[lights.lamp]\nkind = "pca9632"\nscl_pin = "D11"\nsda_pin = "D6"\n'
    sensors = sensor("a", "lm75"), sensor("b", "lm75", ", address = 73"), sensor("c", "bmp180")
    with Scenario(machine(*sensors, lamp)) as s:
        for name, celsius in (("a", 20.0), ("b", 30.0), ("c", 40.0)):
            s.board.sensor_chips[name].celsius = celsius
        s.passes(4)
        s.host.ok("SET_LED LED=lamp RED=1")
        s.passes(4)
        assert [seen(s, name).celsius for name in "abc"] == pytest.approx([20, 30, 40], abs=0.1)
        assert s.board.boards[""].led_chips["lamp"].register(2) == 255


def test_wait_for_a_chip_ends_when_warm_and_is_refused_at_a_fault():
    with Scenario(machine(CHIP)) as s:
        s.passes(3)
        s.host.send("M191 S45", "M118 warm")
        s.host.silent(10, "^warm")
        s.board.sensor_chips["room"].celsius = 46.0
        s.host.expect("warm", 5)
        s.host.send("M191 S60")
        s.passes(2)
        s.board.sensor_chips["room"].plugged = False
        s.host.expect("sensor room does not answer", 10)
        s.host.expect("^ok", 2)


def test_fan_of_a_silent_chip_runs_fully():
    fan = '[fans.case]\npin = "D11"\nthermostat = { sensor = "room", target_c = 60.0 }\n'
    chip = sensor("room", "lm75").replace("D11", "D5")
    with Scenario(machine(chip, fan)) as s:
        assert s.until(lambda: s.printer.status.read().fans["case"] == 0.0, 5)
        s.board.sensor_chips["room"].plugged = False
        assert s.until(lambda: s.printer.status.read().fans["case"] == 1.0, 10)


def test_macro_reads_the_humidity():
    macro = "[macros.DAMP]\ngcode = \"M118 {printer['htu21d room'].humidity} %\"\n"
    with Scenario(machine(sensor("room", "si7021"), macro)) as s:
        s.board.sensor_chips["room"].humidity = 55.0
        s.passes(4)
        s.host.send("DAMP")
        s.host.expect(r"5[45]\.\d+ %", 2)


@pytest.mark.parametrize(
    ("sensors", "limit"),
    [
        (sensor("a", "lm75") + sensor("b", "lm75"), "sensors.a has this one"),
        (sensor("a", "lm75").replace(', sda_pin = "D6"', ""), "sda_pin is missing"),
        (sensor("a", "lm75").replace(BUS, 'i2c_bus = "i2c1"'), "Passo's firmware has no buses"),
        (sensor("a", "lm75", more='sensor_pin = "T2"\n'), "a sensor of the kind lm75 has no pin"),
        (sensor("a", "lm75").replace('"D6"', '"other:D6"'), "the name of one of the boards"),
        (sensor("a", "lm75").replace('"D6"', '"D10"'), "PB4 belongs to heaters.hotend.pin"),
        (sensor("a", "lm76"), "one of thermistor"),
    ],
)
def test_impossible_chips_are_refused(sensors, limit):
    with pytest.raises(ConfigError) as caught:
        machine(sensors)
    assert any(limit in str(problem) for problem in caught.value.problems), caught.value
