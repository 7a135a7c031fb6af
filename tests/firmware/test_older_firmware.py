"""Passo's host on a board whose firmware has older words for analog inputs, converters and I2C."""

import pytest
from tests.firmware.library import library_for_older_hosts
from tests.printer.test_thermocouples import text
from tests.support.edited_machine import answers, edited
from tests.support.link_bench import Bench
from tests.support.scenario import Scenario

from passo import config
from passo.simulator import dictionary


@pytest.fixture(autouse=True)
def library(monkeypatch):
    library = library_for_older_hosts()
    monkeypatch.setattr(dictionary, "firmware_library", lambda: library)
    monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)


@pytest.fixture
def bench():
    return Bench()


def test_older_firmware_heats_and_watches_sensor(bench):
    assert not bench.connection.dictionary.takes("query_analog_in", "bytes_per_report")
    assert bench.connection.dictionary.takes("query_analog_in", "range_check_count")
    heater = bench.connection.heaters["hotend"]
    bench.connection.set_target("hotend", 150.0)
    bench.run(200.0)
    assert heater.celsius == pytest.approx(150.0, abs=1.0)
    told = []
    bench.connection.on_fault = lambda name, fault: told.append(name)
    bench.simulated.force_sensor("hotend", 1.0)
    bench.run(2.0)  # the host switches off, and asks anew, with wider limits
    assert told == ["hotend"]
    assert bench.simulated.output_value("hotend") == 0
    assert not bench.device.stopped


def test_older_firmware_heats_by_thermocouple():
    machine = config.load_text(text(firmware="passo", policy="heater"), "t.toml")
    with Scenario(machine) as s:
        asked = s.printer.rig.connection.main.dictionary
        assert asked.takes("query_thermocouple", "max_invalid_count")
        assert not asked.takes("config_thermocouple", "consecutive_fault_limit")
        s.host.ok("M109 S150", 300)
        s.board.force_sensor("hotend", 1.0)
        s.host.expect("heater hotend was switched off: its sensor reads .* means a broken cable", 1)
        s.passes(5)
        assert not s.printer.state.halted
        s.board.force_sensor("hotend", None)
        s.passes(1)
        s.host.ok("M922")
        s.host.ok("M109 S100", 300)


def test_older_firmware_reads_an_accelerometer_over_i2c():
    board = ('base = "ramps"', 'base = "ramps"\nfirmware = "passo"')
    more = '[accelerometer]\nchip = "lis2dw"\nscl_pin = "D40"\nsda_pin = "D42"\n'
    with Scenario(edited("i3", board, more=more)) as s:
        (said,) = answers(s, "ACCELEROMETER_QUERY")
        values = [float(value) for value in said.partition(": ")[2].split(",")]
        assert values == pytest.approx([0, 0, 9806], abs=250)
        s.printer.board.boards[""].accelerometers[0].plugged = False
        s.host.send("ACCELEROMETER_QUERY")
        s.host.expect("the board shut down: I2C NACK. A device on I2C, such as an accelerometer", 5)
