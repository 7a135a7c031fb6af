"""The chip's modules: reset, pins, pulse width modulation, the alarm."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from tests.support.link_bench import TABLE

from passo import _core, config
from passo.board.boards import Boards
from passo.board.description import BoardDescription, Endstop, Output, Sensor, Stepper
from passo.board.endstops import Endstops
from passo.errors import MachineError
from passo.printer.setup.boards import board_description
from passo.toolchain.targets import board_target

from .boards import HZ, MELZI, MELZI_PINS, OTHER_PINS, RAMPS, RAMPS_PINS, bench, motors
from .host import AvrConnection

OCR2A, TCCR2A, TCCR2B, DDRH = 0xB3, 0xB0, 0xB1, 0x101


def test_the_dictionary_names_chip_and_pins():
    connection = motors(1, MELZI, (("PD7", "PC5"),))
    dictionary = connection.dictionary
    assert dictionary.constants["MCU"] == "atmega1284p"
    assert dictionary.number("CLOCK_FREQ") == HZ
    assert dictionary.enumerations["pin"]["PD7"] == 31
    assert "PE0" not in dictionary.enumerations["pin"]
    assert connection.move_count > 900
    connection.bench.close()


@pytest.mark.parametrize(
    ("machine", "moves"), [("i3", 423), ("mk3s", 415), ("dual-extruder", 401), ("cnc", 479)]
)
def test_a_ramps_holds_at_least_the_moves_of_its_file(machine, moves):
    description = replace(board_description(config.load(machine)), survives=None)
    chip = bench()
    for channel in range(16):
        chip.set_voltage(channel, 4.7)
    connection = AvrConnection(description, chip)
    connection.connect()
    assert connection.move_count == moves >= description.move_count == 401
    chip.close()


def test_a_melzi_holds_the_moves_of_its_file():
    connection = motors(4, MELZI, MELZI_PINS)
    assert connection.move_count == board_target("melzi").board.move_count == 1024
    connection.bench.close()


def test_a_board_configured_otherwise_is_reset():
    chip = bench()
    first = BoardDescription(HZ, outputs=(Output("light", "PH5", start=1.0, at_halt=1.0),))
    AvrConnection(first, chip).connect()
    assert chip.level("PH5") == 1
    second = BoardDescription(HZ, (Stepper("x", *RAMPS_PINS[0]),), (Output("fan", "PH3"),))
    connection = AvrConnection(second, chip)
    connection.connect()
    assert chip.ram(DDRH) & 1 << 5 == 0
    connection.switch("fan", True)
    connection.run(connection.now + HZ // 10)
    assert chip.level("PH3") == 1
    assert connection.net_steps("x") == 0
    assert connection.move_count > 450
    chip.close()


def test_a_board_that_was_in_use_restarts():
    chip = bench()
    description = BoardDescription(HZ, outputs=(Output("light", "PH5"),))
    connection = AvrConnection(description, chip)
    connection.connect()
    connection.switch("light", True)
    connection.run(connection.now + HZ // 10)
    assert chip.level("PH5") == 1
    AvrConnection(description, chip).connect()
    assert chip.level("PH5") == 0
    chip.close()


def test_pulse_width_modulation_by_a_timer():
    chip = bench()
    description = BoardDescription(HZ, outputs=(Output("laser", "PB4", "pwm", HZ // 500),))
    connection = AvrConnection(description, chip)
    connection.connect()
    assert chip.ram(OCR2A) == 0
    assert chip.ram(TCCR2A) == 0b1000_0001  # phase correct, to OC2A
    assert chip.ram(TCCR2B) == 4  # 1/64: 490 Hz is nearest
    connection.command(
        f"queue_pwm_out oid=0 clock={connection.link.clock_at(connection.now) + HZ // 10} value=200"
    )
    connection.run(connection.now + HZ // 20)
    assert chip.ram(OCR2A) == 0
    connection.run(connection.now + HZ // 10)
    assert chip.ram(OCR2A) == 200
    chip.close()


@pytest.mark.parametrize(
    ("description", "reason"),
    [
        (
            BoardDescription(
                HZ,
                tuple(
                    Stepper(f"m{i}", *pins) for i, pins in enumerate((*OTHER_PINS, ("PC4", "PC6")))
                ),
            ),
            "Image cannot drive a stepper with these pins and pulses",
        ),
        (
            BoardDescription(HZ, (Stepper("x", *RAMPS_PINS[0], pulse_ticks=500),)),
            "Image cannot drive a stepper with these pins and pulses",
        ),
        (BoardDescription(HZ, outputs=(Output("o", "PG6"),)), "Not a valid output pin"),
        (BoardDescription(HZ, outputs=(Output("o", "PE1"),)), "Not a valid output pin"),
        (BoardDescription(HZ, outputs=(Output("o", "PH5", "pwm", 1000),)), "Not a valid PWM pin"),
        (
            BoardDescription(
                HZ,
                outputs=(Output("a", "PB4", "pwm", 510), Output("b", "PH6", "pwm", HZ // 500)),
            ),
            "Not a valid PWM pin",  # the two of one timer have one cycle
        ),
        (BoardDescription(HZ, sensors=(Sensor("s", "PA0", TABLE),)), "Not a valid ADC pin"),
    ],
)
def test_impossible_requests_are_refused(description, reason):
    with pytest.raises(MachineError, match=reason):
        AvrConnection(description, bench(RAMPS)).connect()


def test_each_analog_input_is_read_at_its_own_pin():
    chip = bench()
    for channel in range(16):
        chip.set_voltage(channel, 0.3 * (channel + 1))
    pins = [f"PF{i}" for i in range(8)] + [f"PK{i}" for i in range(8)]
    sensors = tuple(Sensor(pin, pin, TABLE) for pin in pins)
    connection = AvrConnection(BoardDescription(HZ, sensors=sensors), chip)
    connection.connect()
    connection.take_responses("analog_in_state")
    connection.run(connection.now + HZ // 2)
    told = {}
    for _, values in connection.take_responses("analog_in_state"):
        told[values["oid"]] = int.from_bytes(values["values"], "little") / 8 / 1023 * 5
    assert [told[oid] for oid in range(16)] == pytest.approx(
        [0.3 * (i + 1) for i in range(16)], abs=0.01
    )
    chip.close()


def test_input_no_longer_sampled_releases_the_adc():
    chip = bench()
    chip.set_voltage(0, 1.0)
    chip.set_voltage(1, 3.0)
    sensors = (Sensor("a", "PF0", TABLE), Sensor("b", "PF1", TABLE))
    connection = AvrConnection(BoardDescription(HZ, sensors=sensors), chip)
    connection.connect()
    asked = "query_analog_in oid=0 clock={} sample_ticks=2000 sample_count={} rest_ticks=1600000"
    limits = " bytes_per_report=2 min_value=0 max_value=65535 range_check_count=0"
    for trial in range(4):
        connection.command(asked.format(connection.now + HZ // 100, 60) + limits)
        # For more than 10 ms one sample or another is under way.
        connection.run(connection.now + HZ // 50 + 391 * trial)
        connection.command(asked.format(0, 0) + limits)
        connection.run(connection.now + HZ // 100)
        connection.take_responses("analog_in_state")
        connection.run(connection.now + HZ * 7 // 10)
        told = connection.take_responses("analog_in_state")
        assert {values["oid"] for _, values in told} == {1}
    chip.close()


def test_inputs_are_read_with_and_without_pull_up():
    chip = bench()
    description = BoardDescription(HZ, endstops=(Endstop("a", "^PE4"), Endstop("b", "!PD3")))
    connection = AvrConnection(description, chip)
    chip.set_pin("PD3", False)
    connection.connect()
    endstops = Endstops(Boards([connection]))
    assert endstops.pressed("a")
    assert endstops.pressed("b")
    chip.set_pin("PE4", False)
    chip.set_pin("PD3", True)
    assert not endstops.pressed("a")
    assert not endstops.pressed("b")
    chip.close()


@pytest.mark.parametrize("board", [RAMPS, MELZI])
def test_outputs_change_at_their_clock(board):
    chip = bench(board)
    outputs = (Output("a", "PA1"), Output("b", "PA2"))
    description = BoardDescription(HZ, outputs=outputs, mcu=board.mcu)
    connection = AvrConnection(description, chip)
    connection.connect()
    chip.watch(["PA1", "PA2"])
    clock = connection.link.clock_at(connection.now) + HZ // 5
    # The second follows the first closer and closer, and then from further and further away.
    gaps = [*range(20, 1000, 25), *range(20_000, 200_000, 6_007)]
    firsts = [clock + k * 210_011 for k in range(len(gaps))]
    seconds = [first + gap for first, gap in zip(firsts, gaps, strict=True)]
    for k, (first, second) in enumerate(zip(firsts, seconds, strict=True)):
        connection.command(f"queue_digital_out oid=0 clock={first} on_ticks={(k + 1) % 2}")
        connection.command(f"queue_digital_out oid=1 clock={second} on_ticks={(k + 1) % 2}")
        connection.run(connection.now + HZ // 100)
    connection.run(connection.now + HZ)
    edges = chip.edges()
    late = []
    for pin, planned in (("PA1", firsts), ("PA2", seconds)):
        made = [e.cycle for e in edges if e.pin == pin]
        late += [cycle - due for cycle, due in zip(made, planned, strict=True)]
    # A Melzi's alarm counts units of 64 ticks; where they begin differs from image to image. So
    # does where the link's bytes fall: 644 to 733 ticks on the other, for twelve beginnings.
    assert max(late) - min(late) <= (800 if board is RAMPS else 960)
    chip.close()


def test_heater_is_off_before_last_messages(monkeypatch):
    lines = [
        "allocate_oids count=3",
        "config_spi_without_cs oid=0",
        # The message takes 256 000 ticks.
        "spi_set_sw_bus oid=0 miso_pin=PA0 mosi_pin=PA2 sclk_pin=PA4 mode=0 pulse_ticks=800",
        f"config_spi_shutdown oid=1 spi_oid=0 shutdown_msg={'55' * 20}",
        "config_digital_out oid=2 pin=PH5 value=0 default_value=0 max_duration=0",
    ]
    monkeypatch.setattr("passo.board.connection.commands", lambda *_: lines)
    chip = bench()
    connection = AvrConnection(BoardDescription(HZ), chip)
    connection.connect()
    connection.command("update_digital_out oid=2 value=1")
    connection.run(connection.now + HZ // 100)
    chip.watch(["PH5", "PA4"])
    connection.command("emergency_stop")
    assert connection.pump.run(connection.now + HZ // 10) is _core.Stop.SHUTDOWN
    connection.pump.run(connection.now + HZ // 10)
    off, *clocked = chip.edges()
    assert (off.pin, off.level) == ("PH5", 0)
    assert [edge.level for edge in clocked] == [1, 0] * 160
    assert clocked[0].cycle - off.cycle < 4000
    waits = [b.cycle - a.cycle for a, b in pairwise(clocked)]
    assert 800 <= min(waits) <= max(waits) < 2000  # interrupts may come in between
    chip.close()


def test_a_board_that_hangs_restarts_with_its_heater_off():
    chip = bench()
    description = BoardDescription(HZ, outputs=(Output("heater", "PH5"),))
    connection = AvrConnection(description, chip)
    connection.connect()
    connection.switch("heater", True)
    connection.run(connection.now + HZ)
    assert (chip.level("PH5"), chip.ram(DDRH) >> 5 & 1) == (1, 1)
    chip.hang()
    chip.run_for(9 * HZ // 10)
    assert chip.ram(DDRH) >> 5 & 1 == 1
    chip.run_for(HZ // 5)
    assert chip.ram(DDRH) >> 5 & 1 == 0
    chip.receive()
    AvrConnection(description, chip).connect()
    assert chip.level("PH5") == 0
    chip.close()
