"""Drivers with registers on a printer that lives: set up, asked, and what their faults do."""

from __future__ import annotations

import random
from functools import partial

import pytest
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.job.test_noisy_link import CABLE, noisy
from tests.support import trinamic_registers as r
from tests.support.disturbed_prints import spiral
from tests.support.driver_machine import DRIVERS, machine, machine_text
from tests.support.scenario import Scenario

from passo import config
from passo.board.ports import in_process
from passo.config.exporting.settings import Sections
from passo.printer.klipper.objects import objects
from passo.printer.setup.boards import board_descriptions
from passo.printer.setup.connections import _connected, connect_simulated
from passo.printer.setup.simulated_world import simulated_machine


@pytest.fixture(params=["virtual", "passo"])
def s(request):
    with Scenario(machine(firmware=request.param)) as scenario:
        yield scenario


def register(s, motor: str, number: int) -> int:
    return s.board.drivers[motor].read(number)


def field(s, motor: str, number: int, name: str) -> int:
    chip = s.printer.drivers.states[motor].settings.chip
    return r.fields(chip, number, register(s, motor, number))[name]


def test_a_print_moves_with_all_drivers_set_up(s):
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 25
    assert field(s, "x", r.CHOPCONF, "mres") == 4
    assert field(s, "x", r.GCONF, "en_spreadcycle") == 0
    assert register(s, "x", r.TPWMTHRS) == 94  # 12 MHz / (100 mm/s · 80 · 16)
    assert field(s, "y", r.GCONF, "en_spreadcycle") == 1
    assert field(s, "e", r.CHOPCONF, "intpol") == 0
    s.host.ok("G28", 60)
    s.host.ok("G1 X50 Y50 Z5 F6000")
    s.host.ok("M400", 20)
    assert s.positions()["x"] == 50


def test_a_short_circuit_stops_the_printer_and_is_named(s):
    s.host.ok("G28", 60)
    s.host.ok("G1 X200 F1200")
    s.passes(2)
    s.board.drivers["x"].set(r.DRV_STATUS, 1 << 2)
    s.host.expect(
        "^Error:Printer halted: motor x: coil A has a short circuit to ground; its driver has"
        " switched it off. Cut the power",
        2,
    )
    assert s.positions()["x"] < 150
    s.board.drivers["x"].set(r.DRV_STATUS, 0)
    s.host.send("M999")
    s.host.expect("ready again", 5)


def test_a_driver_that_is_not_there_refuses_motion_until_it_is(s):
    s.board.drivers["z"].plugged = False
    s.board.drivers["z"].power_on()
    s.host.expect(r"^echo:motor z: its driver, a TMC2208 on P\w\d and P\w\d, does not answer", 5)
    s.host.silent(5, "does not answer")  # told once
    s.host.send("G92 X0 Y0 Z0 E0", "G1 X10 F6000")
    s.host.expect("^Error:Printer halted: motor z: its driver", 2)
    assert s.board.steps("x") == 0
    s.board.drivers["z"].plugged = True
    s.host.send("M999")
    s.host.expect("ready again", 5)
    s.host.ok("G28", 60)
    assert field(s, "z", r.GCONF, "pdn_disable") == 1


def test_a_driver_that_comes_back_is_set_up(s):
    s.board.drivers["x"].plugged = False
    s.host.expect("motor x: its driver", 5)
    s.board.drivers["x"].plugged = True
    s.board.drivers["x"].power_on()
    s.host.expect("^echo:The driver of motor x is set up", 5)
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 25


def test_driver_reset_halts_only_motors_that_are_on(s):
    s.board.drivers["y"].power_on()
    s.host.expect("^echo:motor y: its driver, a TMC2209, was reset: its settings are gone", 3)
    s.passes(1)
    assert field(s, "y", r.IHOLD_IRUN, "irun") > 0
    s.host.ok("M17")
    s.board.drivers["y"].power_on()
    told = s.host.expect("^Error:Printer halted: motor y: its driver, a TMC2209, was reset", 3)
    assert told.endswith(", then M999")
    assert told.count("M999") == 1


def test_a_damaged_answer_is_asked_for_again(s):
    for chip in s.board.drivers.values():
        chip.damaged_answers = 3
    s.host.ok("M17")
    s.host.silent(5, "halted|driver")


@pytest.mark.parametrize("ms", [0, 5, 10, 20, 35, 60, 90])
def test_driver_settings_sent_at_link_loss_arrive_later(ms):
    with Scenario(machine(firmware="passo")) as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X20 F6000")
        s.host.ok("M400", 10)
        s.host.send("M906 X500 Z300 E900")
        s.passes(ms / 1000)
        break_link(s, 1.0)
        s.host.expect("The board is back", 10)
        s.passes(2)
        assert [field(s, m, r.IHOLD_IRUN, "irun") for m in "xzye"] == [15, 9, 25, 31]
        assert not s.printer.state.halted


@pytest.mark.parametrize("seed", range(4))
def test_noise_on_the_link_is_not_a_fault_of_a_driver(monkeypatch, tmp_path, seed):
    """The board's answers are lost, not the driver's."""
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=CABLE))
    (tmp_path / "a.g").write_text(spiral())
    generator = random.Random(seed)
    with Scenario(machine(firmware="passo"), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(14)
        for _ in range(12):
            noisy(s, generator.choice((0.02, 0.05, 0.2)), 5.0)
            s.passes(generator.uniform(0.0, 2.0))
            assert not s.printer.state.halted
        assert s.printer.outputs.motors.on
        s.board.drivers["x"].set(r.DRV_STATUS, 1 << 2)
        s.host.expect("^Error:Printer halted: motor x: coil A has a short circuit", 15)


def test_driver_reset_during_link_loss_halts_before_resume():
    with Scenario(machine(firmware="passo")) as s:
        s.host.ok("G28", 60)
        s.host.send("G1 X150 F3000")
        s.passes(1)
        s.board.drivers["y"].power_on()
        break_link(s, 1.0)
        s.host.expect("^Error:Printer halted: motor y: its driver, a TMC2209, was reset", 10)
        assert s.positions()["x"] < 100
        assert not any("The board is back" in line for line in s.host.heard)


def test_lost_driver_settings_are_restored_before_resume():
    with Scenario(machine(firmware="passo")) as s:
        s.host.ok("G28", 60)
        s.host.send("G1 X150 F3000")
        s.passes(1)
        s.board.drivers["x"].set(r.IHOLD_IRUN, 0)
        break_link(s, 1.0)
        s.host.expect("The board is back", 10)
        assert field(s, "x", r.IHOLD_IRUN, "irun") == 25
        s.host.ok("M400", 20)
        assert s.positions()["x"] == 150


def test_overheating_is_reported_before_it_stops_the_motor(s):
    s.host.ok("M17")
    s.board.drivers["e"].set(r.DRV_STATUS, 1 << 26)
    s.host.expect("^echo:motor e: its driver, a TMC5160, is hot", 2)
    assert s.host.ok("M911")[:-1] == [
        f"{m} temperature prewarn triggered: {'true' if m == 'E' else 'false'}" for m in "XYZE"
    ]
    s.board.drivers["e"].set(r.DRV_STATUS, 0)
    s.passes(2)
    s.host.ok("M912 E")
    assert "E temperature prewarn triggered: false" in s.host.ok("M911")
    s.board.drivers["e"].set(r.DRV_STATUS, 1 << 25)
    s.host.expect("halted: motor e: its driver, a TMC5160, is too hot and has switched the", 2)


def test_currents_and_modes_by_command(s):
    assert s.host.ok("M906")[:-1] == [
        "X driver current: 800",
        "Y driver current: 800",
        "Z driver current: 600",
        "E driver current: 1200",
    ]
    s.host.ok("M906 X500 E900")
    s.host.ok("M569 S1 Y")
    s.passes(2)
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 15
    assert field(s, "x", r.CHOPCONF, "vsense") == 1
    assert field(s, "y", r.GCONF, "en_spreadcycle") == 0
    assert register(s, "y", r.TPWMTHRS) == 0
    assert register(s, "e", r.GLOBALSCALER) == 75
    assert "Y driver mode: stealthChop" in s.host.ok("M569")
    assert "M906 X500" in "\n".join(s.host.ok("M503"))
    s.host.send("M906 X5000")
    s.host.expect("X is 5000.*31 to 1740 mA", 1)
    s.host.send("M906 X1741")
    s.host.expect("X is 1741: expected 31 to 1740 mA", 1)
    s.host.send("M569 S2 X")
    s.host.expect("S is 2: expected 0 or 1", 1)
    s.host.send("M112")
    s.host.expect("halted", 2)
    s.host.send("M999")
    s.host.expect("ready again", 5)
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 15  # it outlives the halt


def test_thresholds_and_standstill_currents_are_stored(tmp_path):
    with Scenario(machine(), state=str(tmp_path)) as s:
        assert s.host.ok("M913")[:-1] == [
            "X stealthChop below: 99.734 units/s", "Y stealthChop below: off",
            "Z stealthChop below: off", "E stealthChop below: off",
        ]  # fmt: skip
        s.host.ok("M913 X50")
        s.host.ok("M569 S1 Y")
        s.host.ok("M917 X25 E50")
        assert "echo:Z is in spreadCycle: M569 S1 Z first" in s.host.ok("M913 Z5")
        s.host.send("M917 X101")
        s.host.expect("X is 101: expected 0 to 100 %", 2)
        s.host.ok("M500")
    with Scenario(machine(), state=str(tmp_path)) as s:
        s.passes(2)
        assert (register(s, "x", r.TPWMTHRS), register(s, "y", r.TPWMTHRS)) == (188, 0)
        assert (field(s, "x", r.IHOLD_IRUN, "ihold"), field(s, "x", r.IHOLD_IRUN, "irun")) == (
            6, 25,
        )  # fmt: skip
        assert field(s, "e", r.IHOLD_IRUN, "ihold") == 15
        assert s.host.ok("M917")[:-1] == [
            f"{m} standstill current: {percent} %"
            for m, percent in zip("XYZE", (25, 100, 100, 50), strict=True)
        ]  # fmt: skip


def test_klippers_words_set_currents_in_program_order(s):
    assert s.host.ok("SET_TMC_CURRENT STEPPER=stepper_x")[0] == (
        "Run Current: 0.80A Hold Current: 0.40A"
    )
    s.host.ok("G28", 60)
    s.host.send("G1 X100 F6000", "SET_TMC_CURRENT STEPPER=stepper_x CURRENT=0.5", "G1 X101 F6000")
    s.passes(0.5)
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 25
    s.host.ok("M400", 20)
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 15
    assert field(s, "x", r.IHOLD_IRUN, "ihold") == 12  # 0.4 A still
    s.host.ok("SET_TMC_CURRENT STEPPER=extruder CURRENT=0.9 HOLDCURRENT=0.3")
    s.passes(1)
    assert (register(s, "e", r.GLOBALSCALER), field(s, "e", r.IHOLD_IRUN, "ihold")) == (75, 10)
    for line, why in (
        ("STEPPER=stepper_q CURRENT=1", "STEPPER is stepper_q: expected stepper_x, stepper_y"),
        ("STEPPER=stepper_x CURRENT=3", "CURRENT is 3: expected 0.031 to 1.74 A"),
    ):
        s.host.send(f"SET_TMC_CURRENT {line}")
        s.host.expect(why, 2)


def test_a_field_of_a_register_is_set_and_kept(s):
    s.host.ok("SET_TMC_FIELD STEPPER=stepper_x FIELD=toff VALUE=5")
    s.host.ok("SET_TMC_FIELD STEPPER=stepper_x FIELD=tpwmthrs VELOCITY=50")
    s.host.ok("SET_TMC_FIELD STEPPER=stepper_x FIELD=TCOOLTHRS VELOCITY=30")
    s.host.ok("SET_TMC_FIELD STEPPER=extruder FIELD=en_pwm_mode VALUE=1")
    assert field(s, "x", r.CHOPCONF, "toff") == 5
    assert (register(s, "x", r.TPWMTHRS), register(s, "x", 0x14)) == (188, 313)
    assert field(s, "e", r.GCONF, "en_pwm_mode") == 1
    s.board.drivers["x"].power_on()
    s.passes(3)  # the motors are off: it is set up again
    assert field(s, "x", r.CHOPCONF, "toff") == 5
    for line, why in (
        ("FIELD=toff VALUE=16", "VALUE is 16: expected 1 to 15 for toff"),
        ("FIELD=tof VALUE=3", "FIELD is tof: expected a field of a TMC2209. Did you mean 'toff'"),
        ("FIELD=mres VALUE=3", "FIELD is mres: expected microsteps of the machine file"),
        ("FIELD=irun VALUE=3", "FIELD is irun: expected SET_TMC_CURRENT for irun"),
        ("FIELD=toff VELOCITY=3", "VELOCITY is 3: expected VALUE for toff"),
        ("FIELD=toff", "VALUE is missing: expected one of VALUE and VELOCITY"),
    ):
        s.host.send(f"SET_TMC_FIELD STEPPER=stepper_x {line}")
        s.host.expect(why, 2)


def test_registers_are_reported_as_in_klipper(s):
    s.board.drivers["x"].set(r.DRV_STATUS, 1 << 6 | 25 << 16)
    lines = s.host.ok("DUMP_TMC STEPPER=stepper_x", 5)
    assert "IHOLD_IRUN: 0008190c ihold=12 irun=25 iholddelay=8" in lines
    assert "DRV_STATUS: 00190040 ola=1 cs_actual=25" in lines
    assert "GCONF:      000001c0 pdn_disable=1 mstep_reg_select=1 multistep_filt=1" in lines
    assert lines.index("========== Queried registers ==========") < lines.index(
        "DRV_STATUS: 00190040 ola=1 cs_actual=25"
    )
    assert s.host.ok("DUMP_TMC STEPPER=stepper_x REGISTER=tpwmthrs")[0] == (
        "TPWMTHRS:   0000005e tpwmthrs=94"
    )
    s.board.drivers["x"].plugged = False
    s.host.send("DUMP_TMC STEPPER=stepper_x")
    s.host.expect("motor x: its driver, a TMC2209 on .* does not answer", 5)


def test_a_driver_is_written_again_on_request(s):
    s.board.drivers["x"].set(r.IHOLD_IRUN, 0)
    s.host.ok("INIT_TMC STEPPER=stepper_x")
    assert field(s, "x", r.IHOLD_IRUN, "irun") == 25


def test_hold_current_above_run_current_is_within_range():
    drivers = DRIVERS.replace("hold_current_a = 0.4", "hold_current_a = 1.6")
    with Scenario(machine(drivers)) as s:
        lines = s.host.ok("M122")
        assert "X TMC2209 0.82 A running, 1.58 A standing, 16 microsteps, stealthChop" in lines
        s.host.send("M906 X871")
        s.host.expect("X is 871: expected 31 to 870 mA", 1)
        s.host.ok("M906 X870")
        assert any("1.74 A standing" in line for line in s.host.ok("M122"))


def test_microsteps_are_reported_and_fixed(s):
    assert s.host.ok("M350")[:-1] == [f"{m} microsteps: 16" for m in "XYZE"]
    s.host.send("M350 X32")
    s.host.expect("steppers is fixed while the printer runs", 1)


SHARED_BUS = """
[steppers.z]
driver = "TMC2130"
steps_per_mm = 400.0
socket = "Z"

[steppers.z.tmc]
run_current_a = 0.6
cs_pin = "D33"
clock_pin = "D25"
mosi_pin = "D27"
miso_pin = "D29"
"""
CONVERTER = """sensor_pin = "D31"
sensor = { kind = "max31855", clock_pin = "D25", mosi_pin = "D27", miso_pin = "D29" }
"""


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_drivers_and_a_thermocouple_share_a_bus(firmware):
    begin, end = DRIVERS.index("[steppers.z]"), DRIVERS.index("[steppers.e]")
    text = machine_text(DRIVERS[:begin] + SHARED_BUS + DRIVERS[end:], firmware)
    text = text.replace('sensor_pin = "T0"\n', CONVERTER, 1)
    with Scenario(config.load_text(text, "m.toml")) as s:
        s.host.ok("M17")
        s.host.ok("M109 S100", 300)
        assert field(s, "z", r.IHOLD_IRUN, "irun") == 19
        s.host.silent(5, "driver|halted")
        s.board.drivers["z"].set(r.DRV_STATUS, 1 << 28)
        s.host.expect("halted: motor z: coil B has a short circuit to ground", 3)


def test_the_state_of_each_driver_is_reported(s):
    s.board.drivers["z"].set(r.DRV_STATUS, 1 << 6)
    s.passes(2)
    lines = s.host.ok("M122")
    assert "X TMC2209 0.80 A running, 0.40 A standing, 16 microsteps, stealthChop" in lines
    at = lines.index("Z TMC2208 0.61 A running, 0.61 A standing, 16 microsteps, spreadCycle")
    assert lines[at + 1].startswith("  motor z: coil A looks open")


def test_status_has_the_set_flags_of_each_driver(s):
    s.board.drivers["x"].set(r.DRV_STATUS, 1 | 25 << 16)
    s.passes(2)
    status = s.printer.status.read()
    x = status.drivers["x"]
    assert (x.chip, x.run_a, x.hold_a, x.mode) == ("TMC2209", 0.795, 0.398, "stealthChop")
    assert x.flags == {"otpw": 1, "cs_actual": 25}
    assert [fault.code for fault in x.findings] == ["driver.hot"]
    assert x.findings[0].action.startswith("Cool it better, or lower its current")
    assert status.drivers["e"].flags == {}
    found = objects(s.printer.machine, Sections(s.printer.machine), status, {})
    assert found["tmc2209 stepper_x"]() == {
        "run_current": 0.795, "hold_current": 0.398, "drv_status": {"otpw": 1, "cs_actual": 25},
        "temperature": None, "mcu_phase_offset": None, "phase_offset_position": None,
    }  # fmt: skip
    assert found["tmc5160 extruder"]()["run_current"] == pytest.approx(1.2, abs=0.01)
    s.board.drivers["x"].plugged = False
    s.passes(3)
    x = s.printer.status.read().drivers["x"]
    assert (x.flags, [fault.code for fault in x.findings]) == (None, ["driver.silent"])


TMC2240 = """
[steppers.e]
driver = "TMC2240"
steps_per_mm = 95.5
socket = "E0"

[steppers.e.tmc]
run_current_a = 0.8
cs_pin = "D23"
clock_pin = "D25"
mosi_pin = "D27"
miso_pin = "D29"
"""


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_a_tmc2240_reports_its_temperature_and_supply(firmware):
    text = DRIVERS[: DRIVERS.index("[steppers.e]")] + TMC2240
    with Scenario(machine(text, firmware)) as s:
        s.board.drivers["e"].set(0x51, 2962)
        s.passes(2)
        e = s.printer.status.read().drivers["e"]
        assert e.temperature_c == pytest.approx(120.0)
        assert e.supply_v == pytest.approx(24.0, abs=0.01)
        seen = objects(s.machine, Sections(s.machine), s.printer.status.read(), {})
        assert seen["tmc2240 extruder"]()["temperature"] == pytest.approx(120.0)
        assert (s.board.drivers["e"].read(0x0A), register(s, "e", r.GLOBALSCALER)) == (1, 145)
        assert any(line.endswith("spreadCycle, 120 C, 24.0 V") for line in s.host.ok("M122"))


def test_currents_and_modes_are_stored(tmp_path):
    with Scenario(machine(), state=str(tmp_path)) as s:
        s.host.ok("M906 X500 E900")
        s.host.ok("M569 S0 X")
        s.host.ok("M500")
    with Scenario(machine(), state=str(tmp_path)) as s:
        s.passes(2)
        assert field(s, "x", r.IHOLD_IRUN, "irun") == 15
        assert field(s, "x", r.GCONF, "en_spreadcycle") == 1
        assert field(s, "y", r.IHOLD_IRUN, "irun") == 25
        assert register(s, "e", r.GLOBALSCALER) == 75
        lines = [line.removeprefix("echo:").strip() for line in s.host.ok("M503")]
        assert [x for x in lines if x.startswith(("M906", "M569"))] == [
            "M906 X500", "M569 S0 X", "M906 Y800", "M569 S0 Y",
            "M906 Z600", "M569 S0 Z", "M906 T0 E900", "M569 T0 S0 E",
        ]  # fmt: skip


@pytest.mark.parametrize("drivers", [True, False])
def test_the_printer_starts_over_a_bad_link(monkeypatch, drivers):
    """Three of a hundred bytes arrive as others: most long frames are lost."""

    def spoilt(machine):
        boards = board_descriptions(machine)
        simulated = simulated_machine(machine, boards, CABLE)
        for name in boards:
            simulated.spoil_cable(name, 0.03)
        return _connected(boards, in_process(list(simulated.devices.values()))), simulated

    monkeypatch.setattr("passo.printer.printer.connect", spoilt)
    with Scenario(machine(firmware="passo") if drivers else FIRMWARE) as s:
        assert s.printer.rig.connection.now < 20 * s.printer.rig.connection.board.clock_hz
        assert not any(state.failure for state in s.printer.drivers.states.values())


SECOND_Z = """
[steppers.left]
drives = "z"
driver = "TMC2209"
steps_per_mm = 400.0
socket = "E1"
tmc = { run_current_a = 0.9, stealthchop_below_mm_s = 5, uart_pin = "^D40", address = 2 }
"""


def set_to(s):
    states = s.printer.drivers.states
    return {
        m: (round(1000 * state.settings.run_a), state.settings.threshold is not None)
        for m, state in states.items()
    }


def test_each_motor_of_an_axis_has_its_own_current(tmp_path):
    meant = {"x": (800, True), "y": (800, False), "z": (600, False), "left": (900, True)}
    meant["e"] = (1200, False)
    with Scenario(machine(DRIVERS + SECOND_Z), state=str(tmp_path)) as s:
        assert set_to(s) == meant
        s.host.ok("M500")
    with Scenario(machine(DRIVERS + SECOND_Z), state=str(tmp_path)) as s:
        assert set_to(s) == meant  # nothing has changed
        s.host.ok("M906 I1 Z700")
        s.host.ok("M569 I0 S1 Z")
        changed = meant | {"z": (600, True), "left": (700, True)}
        assert set_to(s) == changed
        s.host.ok("M500")
    with Scenario(machine(DRIVERS + SECOND_Z), state=str(tmp_path)) as s:
        assert set_to(s) == changed
        s.host.ok("M906 Z500")
        assert set_to(s) == changed | {"z": (500, True), "left": (500, True)}
        assert s.host.ok("M906 I2 Z600")[0] == "echo:Z has no driver that can be set up"


@pytest.mark.parametrize(
    ("line", "stealthy"),
    [
        ("M569 S1 X1", "x"),
        ("M569 S1 X Y2", "xy"),
        ("M569 S1 E T0", "e"),
        ("M569S1Z", "z"),
        ("M569 P0 S1", ""),
        ("M569 S1", "xyze"),
    ],
)
def test_m569_sets_modes_of_named_motors(s, line, stealthy):
    s.host.ok("M569 S0")
    lines = s.host.ok(line)
    assert [m for m, (_, stealth) in set_to(s).items() if stealth] == list(stealthy)
    assert (lines[0] == "echo:P has no driver that can be set up") == ("P" in line)


def test_currents_are_set_all_or_none(s):
    s.host.send("M906 X500 Y99999")
    s.host.expect("Y is 99999: expected 31 to 1740 mA", 1)
    assert set_to(s)["x"] == (800, True)


def test_old_driver_fault_flag_does_not_halt(s):
    s.host.ok("G28", 60)
    s.host.ok("M84")
    s.board.drivers["e"].set(r.GSTAT, 4)  # its charge pump had too little voltage once
    s.host.expect("too little voltage", 3)
    s.passes(3)
    assert register(s, "e", r.GSTAT) == 0
    s.host.ok("G28", 60)
    assert s.printer.state.halted == ""
