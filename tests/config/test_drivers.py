"""What is wrong with drivers in a machine file, by line, key and what was expected."""

from __future__ import annotations

import pytest
from tests.support.driver_machine import DRIVERS, machine, machine_text

from passo import config
from passo.board.description import SpiPins, UartPins
from passo.config.trinamic import MotorConstants
from passo.errors import ConfigError
from passo.printer.setup.boards import board_description


def problems(text: str) -> list[tuple[str, str]]:
    with pytest.raises(ConfigError) as caught:
        config.load_text(text, "m.toml")
    return [(str(p.values["key"]), str(p)) for p in caught.value.problems]


def changed(old: str, new: str) -> str:
    assert old in DRIVERS
    return machine_text(DRIVERS.replace(old, new, 1))


def test_drivers_become_part_of_the_board():
    board = board_description(machine())
    assert [(d.stepper, d.settings.chip, d.address) for d in board.drivers] == [
        ("x", "TMC2209", 0),
        ("y", "TMC2209", 1),
        ("z", "TMC2208", 0),
        ("e", "TMC5160", 0),
    ]
    assert board.drivers[0].wire == board.drivers[1].wire
    assert board.drivers[0].settings.threshold == 94
    assert board.drivers[1].settings.hold_a == 0.8


@pytest.mark.parametrize(
    ("old", "new", "key", "sentence"),
    [
        ('"TMC2209"', '"A4988"', "steppers.x.driver",
         "expected one of TMC2208, TMC2209, TMC2225, TMC2226,"),
        ("address = 1", "address = 0", "steppers.y.tmc.address",
         "expected an address of its own: it belongs to steppers.x.tmc (m.toml:"),
        ("address = 1", "address = 4", "steppers.y.tmc.address", "expected 0 to 3 for a TMC2209"),
        ("run_current_a = 0.8", "run_current_a = 1.8", "steppers.x.tmc.run_current_a",
         "is 1.8: expected 0.031 to 1.74 A with a sense resistor of 0.11 ohm"),
        ("run_current_a = 1.2\n", "run_current_a = 3.065\n", "steppers.e.tmc.run_current_a",
         "is 3.065: expected 0.012 to 3.064 A with a sense resistor of 0.075 ohm"),
        ("hold_current_a = 0.4", "hold_current_a = 2", "steppers.x.tmc.hold_current_a",
         "0.031 to 1.74 A"),
        ("run_current_a = 0.8", "run_current_a = 1e-6", "steppers.x.tmc.run_current_a",
         "is 1e-06: expected 0.031 to 1.74 A"),
        ("hold_current_a = 0.4", "hold_current_a = 0.03", "steppers.x.tmc.hold_current_a",
         "0.031 to 1.74 A"),
        ('uart_pin = "D42"', 'uart_pin = "^^D42"', "steppers.z.tmc.uart_pin",
         "is '^^D42': expected at most one ^ before D42"),
        ('uart_pin = "D42", ', "", "steppers.z.tmc.uart_pin", "expected a pin, for a TMC2208"),
        ('uart_pin = "D42"', 'uart_pin = "D40"', "steppers.z.tmc.uart_pin",
         "expected a pin of its own: it belongs to steppers.x.tmc"),
        ('tx_pin = "D44"', 'tx_pin = "D44", address = 0', "steppers.z.tmc.address",
         "expected no address"),
        ('tx_pin = "D44"', 'tx_pin = "D40"', "steppers.z.tmc.tx_pin",
         "expected a pin of its own: PG1 belongs to steppers.x.tmc.uart_pin"),
        ('tx_pin = "D44"', 'tx_pin = "D10"', "heaters.hotend.pin", "a pin of its own"),
        ('tx_pin = "D44"', 'cs_pin = "D44"', "steppers.z.tmc.cs_pin",
         "expected uart_pin for a TMC2208"),
        ('clock_pin = "D25"\n', "", "steppers.e.tmc.clock_pin", "a pin, for a TMC5160"),
        ('miso_pin = "D29"', 'miso_pin = "D27"', "steppers.e.tmc.miso_pin", "a pin of its own"),
        ("stealthchop_below_mm_s", "stealthchop_below_deg_s",
         "steppers.x.tmc.stealthchop_below_deg_s", "expected stealthchop_below_mm_s here"),
        ("run_current_a = 1.2\n", "", "steppers.e.tmc.run_current_a", "missing"),
        ('"^D40", address = 1', '"^PG1"', "steppers.y.tmc.address",
         "is 0: expected an address of its own: it belongs to steppers.x.tmc (m.toml:"),
        ('uart_pin = "D42"', 'uart_pin = "PG1"', "steppers.z.tmc.uart_pin",
         "expected a pin of its own: it belongs to steppers.x.tmc"),
        ("address = 1", 'address = 1, tx_pin = "D32"', "steppers.y.tmc.tx_pin",
         "is 'D32': expected D40, on which this wire sends at steppers.x.tmc (m.toml:"),
        ('100, uart_pin = "^D40"', '100, uart_pin = "^D40", tx_pin = "D32"',
         "steppers.y.tmc.tx_pin",
         "missing: expected D32, on which this wire sends at steppers.x.tmc (m.toml:"),
        ('"^D40", address', '"D40", address', "steppers.y.tmc.uart_pin",
         "is 'D40': expected ^D40, as it stands at steppers.x.tmc.uart_pin (m.toml:"),
        ('uart_pin = "D42"', 'uart_pin = "!D42"', "steppers.z.tmc.uart_pin",
         "expected no ! before PL7: it does nothing here"),
        ('tx_pin = "D44"', 'tx_pin = "^D44"', "steppers.z.tmc.tx_pin",
         "expected no ^ before PL5: it does nothing here"),
        ('cs_pin = "D23"', 'cs_pin = "!D23"', "steppers.e.tmc.cs_pin", "expected no ! before PA1"),
        ('clock_pin = "D25"', 'clock_pin = "!D25"', "steppers.e.tmc.clock_pin", "expected no !"),
    ],
)  # fmt: skip
def test_wiring_mistakes_of_drivers_are_named(old, new, key, sentence):
    found = problems(changed(old, new))
    assert [k for k, _ in found] == [key]
    assert sentence in found[0][1]


def test_tmc2208_is_address_0_of_its_wire():
    board = board_description(config.load_text(changed('"TMC2209"', '"TMC2208"')))
    assert [(d.settings.chip, d.address) for d in board.drivers[:2]] == [
        ("TMC2208", 0),
        ("TMC2209", 1),
    ]
    assert board.drivers[0].wire == board.drivers[1].wire


def test_two_wires_share_no_pin_to_send_on():
    text = changed('"^D40", address = 1', '"D16", address = 1, tx_pin = "D44"')
    ((key, sentence),) = problems(text)
    assert key == "steppers.z.tmc.tx_pin"
    assert "expected a pin of its own: it belongs to the wire of steppers.y.tmc (m.t" in sentence


def test_drivers_on_one_wire_may_name_its_pins_in_different_ways():
    text = changed('"^D40", address', '"^PG1", tx_pin = "PL7", address').replace(
        '"^D40" }', '"^D40", tx_pin = "D42" }'
    )
    text = text.replace('uart_pin = "D42"', 'uart_pin = "D32"')
    x, y, *_ = board_description(config.load_text(text)).drivers
    assert x.wire == y.wire == UartPins("^PG1", "PL7")


BUS = 'run_current_a = 1.2\ncs_pin = "D23"\nspi_bus = "spi1"\n'
WIRES = (
    'run_current_a = 1.2\ncs_pin = "D23"\nclock_pin = "D25"\nmosi_pin = "D27"\nmiso_pin = "D29"\n'
)


def test_a_driver_on_a_bus_of_klippers_firmware():
    text = machine_text(DRIVERS.replace(WIRES, BUS)).replace(
        'base = "ramps"', 'base = "ramps"\nmcu = "klipper"', 1
    )
    board = board_description(config.load_text(text, "m.toml"))
    wire = next(d for d in board.drivers if d.stepper == "e").wire
    assert isinstance(wire, SpiPins) and (wire.bus, wire.pins) == ("spi1", ("PA1",))
    (found,) = problems(machine_text(DRIVERS.replace(WIRES, BUS)))
    assert found[0] == "steppers.e.tmc.spi_bus"
    assert "Passo's firmware has no buses; give clock_pin" in found[1]


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ("registers = { toff = 16 }", "registers.toff is 16: expected 1 to 15"),
        ("registers = { tof = 3 }", "expected a field of a TMC5160: bbmclks, bbmtime, "),
        ("registers = { sgt = -65 }", "registers.sgt is -65: expected -64 to 63"),
        ("registers = { irun = 3 }", "no such field: run_current_a and hold_current_a of tmc"),
        (
            "interpolate = false\naddress = 1",
            "expected cs_pin, clock_pin, mosi_pin, miso_pin for a",
        ),
        ("registers = { mres = 3 }", "no such field: microsteps of tmc set it"),
        ("coolstep_above_deg_s = 3", "expected coolstep_above_mm_s here"),
        ("reference_resistor_ohm = 12000", "expected sense_resistor_ohm for a TMC5160"),
    ],
)
def test_registers_are_bounded_and_named(keys, sentence):
    found = problems(machine_text(DRIVERS.replace("interpolate = false", keys)))
    assert len(found) == 1 and sentence in found[0][1]


@pytest.mark.parametrize(
    ("ohm", "mh", "nm", "ampere", "full", "pwm", "hysteresis", "rev_s"),
    [
        (1.4, 2.0, 0.44, 2.0, 400, (5, 18), (7, 9), 15.09),
        (1.65, 3.6, 0.45, 1.68, 200, (12, 21), (5, 3), 6.21),
    ],
)
def test_constants_of_a_motor(ohm, mh, nm, ampere, full, pwm, hysteresis, rev_s):
    """12 MHz, 24 V, 0.8 A, TOFF 3, 24 clocks of blanking: values of klipper_tmc_autotune."""
    motor = MotorConstants(
        resistance_ohm=ohm, inductance_mh=mh, holding_torque_nm=nm, max_current_a=ampere
    )
    fields = motor.pwm(12_000_000, 0.8, full)
    assert (fields["pwm_grad"], fields["pwm_ofs"]) == pwm
    found = motor.hysteresis(12_000_000, 0.8, toff=3, tbl=1)
    assert (found["hstrt"], found["hend"]) == hysteresis
    assert motor.silent_rev_s(fields) == pytest.approx(rev_s, abs=0.01)


def test_fields_of_the_machine_file_replace_those_of_the_motor():
    text = DRIVERS.replace(
        "stealthchop_below_mm_s = 100,",
        "stealthchop_below_mm_s = 100, coolstep_above_mm_s = 50, registers = { hend = 1 },"
        " motor = { resistance_ohm = 1.65, inductance_mh = 3.6, holding_torque_nm = 0.45,"
        " max_current_a = 1.68 },",
    )
    board = board_description(config.load_text(machine_text(text), "m.toml"))
    fields = next(d for d in board.drivers if d.stepper == "x").settings.fields
    assert fields == {
        "toff": 1, "hstrt": 7, "hend": 1, "pwm_grad": 12, "pwm_ofs": 21, "pwm_freq": 2,
        "tcoolthrs": 188,
    }  # fmt: skip
