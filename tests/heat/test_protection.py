"""Every protection against the fault that it is for, and the state that it leaves behind."""

from __future__ import annotations

import pytest
from tests.heat.oven import Oven

from passo import _core
from passo.board.faults import FaultKind, HeaterFault
from passo.config.sensor_tables import share_at

MODEL = "model = { rise_c = 380.0, fan_loss = 0.3, time_constant_s = 120.0 }"
NO_MODEL = "protection = { deviation = 0.0 }"


def fails(oven: Oven, kind: FaultKind, within_s: float) -> None:
    """The fault comes in time and switches the output off; the board lives."""
    begin = oven.now_s
    oven.run_until(lambda: bool(oven.faults), within_s)
    (fault,) = oven.faults
    assert (fault.heater, fault.kind) == (oven.name, kind)
    assert begin < (fault.clock - oven.start) / oven.hz <= oven.now_s
    oven.run(0.25)
    assert oven.output() == 0
    assert oven.heater.power == 0.0
    assert oven.heater.fault.kind == kind


def mended(oven: Oven, target: float) -> None:
    """Nothing heats until it is rearmed, though all is well again; then it heats as before."""
    oven.board.force_sensor(oven.name, None)
    oven.board.force_heater(oven.name, None)
    oven.board.add_noise(oven.name, 0.0)
    oven.board.drop_sensor(oven.name, fallen=False)
    body = oven.board.temperature(oven.name)
    assert all(row[3] == 0.0 for row in oven.run(60))
    assert oven.output() == 0
    assert oven.board.temperature(oven.name) <= body
    assert oven.heater.target == target
    assert oven.heater.fault is not None
    assert len(oven.faults) == 1
    assert oven.board.device.fault == ""
    oven.heater.rearm()
    assert oven.heater.fault is None
    oven.run(240)
    assert oven.board.temperature(oven.name) == pytest.approx(target or 25, abs=40 - 0.19 * target)
    assert len(oven.faults) == 1


def hot(lines: str = "", target: float = 200.0) -> Oven:
    """A hotend that holds its target."""
    oven = Oven(lines)
    oven.heat(target)
    oven.run(180)
    assert oven.heater.reached
    assert oven.faults == []
    return oven


def idle() -> Oven:
    oven = Oven()
    oven.run(5)
    return oven


@pytest.mark.parametrize("make", [hot, idle])
@pytest.mark.parametrize(
    ("share", "kind"), [(1.0, FaultKind.SENSOR_OPEN), (0.0, FaultKind.SENSOR_SHORT)]
)
def test_broken_sensor_cable_is_a_fault(make, share, kind):
    oven = make()
    oven.board.force_sensor("hotend", share)
    fails(oven, kind, 0.75)
    mended(oven, oven.heater.target)


@pytest.mark.parametrize("broken", [0.0, 1.0])
@pytest.mark.parametrize("name", ["hotend", "bed"])
def test_readings_of_broken_cable_are_not_heat(name, broken):
    """It is rearmed as soon as it is mended, while the model's room is still far off."""
    oven = Oven(name=name)
    oven.heat(60.0)
    oven.run(1)
    oven.board.force_sensor(name, broken)
    oven.run(20)
    oven.board.force_sensor(name, None)
    oven.run(0.5)
    oven.heater.rearm()
    oven.run(240)
    assert [fault.heater for fault in oven.faults] == [name]
    assert oven.board.temperature(name) == pytest.approx(60, abs=1)


SENSORS = {
    "pt100": "",
    "pt1000": "",
    "pt100-amplifier": "",
    "pt1000-amplifier": ", gain = 2.0, pullup_ohm = 4700.0",
    "ad595": "",
    "ad8495": "",
    "table": ", points = [[0.0, 0.1], [300.0, 0.9]], open_reads = 'low'",
}


@pytest.mark.parametrize("kind", SENSORS)
@pytest.mark.parametrize("target", [0.0, 100.0])
@pytest.mark.parametrize("broken", [FaultKind.SENSOR_OPEN, FaultKind.SENSOR_SHORT])
def test_broken_cable_of_each_sensor_kind_is_a_fault(kind, target, broken):
    oven = Oven(f"sensor = {{ kind = '{kind}'{SENSORS[kind]} }}")
    oven.heat(target)
    oven.run(10)
    assert oven.faults == []
    assert (oven.output() > 0) == (target > 0)
    high = (broken == FaultKind.SENSOR_OPEN) == (kind != "table")
    oven.board.force_sensor("hotend", 1.0 if high else 0.0)
    fails(oven, broken, 0.75)


@pytest.mark.parametrize(
    ("celsius", "kind"), [(2.0, FaultKind.MIN_TEMPERATURE), (290.0, FaultKind.MAX_TEMPERATURE)]
)
def test_temperature_out_of_range_is_a_fault(celsius, kind):
    oven = idle()
    table = oven.connection.board.sensors[0].table
    oven.board.force_sensor("hotend", share_at(table, celsius))
    fails(oven, kind, 0.75)
    (fault,) = oven.faults
    assert fault.celsius == pytest.approx(celsius, abs=1.0)
    assert fault.limit == (5.0 if celsius < 5 else 285.0)
    mended(oven, 0.0)


def test_very_noisy_sensor_is_a_fault():
    oven = hot()
    oven.board.add_noise("hotend", 0.05)
    fails(oven, FaultKind.SENSOR_ERRATIC, 10)
    mended(oven, 200.0)


def test_a_little_noise_does_not_matter():
    oven = hot()
    oven.board.add_noise("hotend", 0.003)
    oven.run(300)
    assert oven.faults == []
    assert oven.board.temperature("hotend") == pytest.approx(200, abs=2)


def test_sensor_that_falls_out_is_a_fault():
    oven = hot()
    oven.board.drop_sensor("hotend")
    fails(oven, FaultKind.SENSOR_ERRATIC, 3)
    mended(oven, 200.0)


def test_a_sensor_that_slips_out_slowly_is_a_runaway():
    oven = hot(NO_MODEL, target=60.0)
    oven.board.drop_sensor("hotend")
    fails(oven, FaultKind.RUNAWAY, 45)
    assert oven.faults[0].limit == 56.0
    mended(oven, 60.0)


@pytest.mark.parametrize("fault", ["fallen sensor", "stuck sensor", "heater stuck off"])
def test_heater_that_does_not_get_warmer_is_a_fault(fault):
    oven = idle()
    if fault == "fallen sensor":
        oven.board.drop_sensor("hotend")
    elif fault == "stuck sensor":
        table = oven.connection.board.sensors[0].table
        oven.board.force_sensor("hotend", share_at(table, 25.0))
    else:
        oven.board.force_heater("hotend", 0.0)
    oven.heat(200.0)
    fails(oven, FaultKind.HEATING_FAILED, 21)
    assert oven.board.temperature("hotend") < 90
    mended(oven, 200.0)


def test_heater_that_fails_while_hot_is_a_fault():
    oven = hot(NO_MODEL)
    oven.board.force_heater("hotend", 0.0)
    fails(oven, FaultKind.RUNAWAY, 45)
    mended(oven, 200.0)


@pytest.mark.parametrize("target", [0.0, 60.0])
def test_heater_that_is_stuck_on_is_a_fault(target):
    oven = Oven()
    oven.heat(target)
    oven.run(60)
    oven.board.force_heater("hotend", 1.0)
    fails(oven, FaultKind.STUCK_ON, 25)
    assert oven.board.temperature("hotend") < target + 90
    mended(oven, target)


@pytest.mark.parametrize("target", [0.0, 60.0])
def test_bed_that_is_stuck_on_is_a_fault(target):
    oven = Oven(name="bed")
    oven.heat(target)
    oven.run(240)
    before = oven.board.temperature("bed")
    oven.board.force_heater("bed", 1.0)
    fails(oven, FaultKind.MODEL_DEVIATION, 60)
    assert oven.board.temperature("bed") < before + 16


def test_cooling_down_is_not_a_fault():
    oven = hot()
    oven.heat(0.0)
    oven.run(300)
    oven.heat(50.0)
    oven.run(300)
    assert oven.faults == []


@pytest.mark.parametrize("control", ["pid", "model"])
def test_stuck_sensor_reading_is_a_fault(control):
    """Its reading looks well; only a model tells that it does not follow the power."""
    oven = hot(f"{MODEL}\ncontrol = {{ kind = '{control}' }}")
    table = oven.connection.board.sensors[0].table
    oven.board.force_sensor("hotend", share_at(table, 198.0))
    fails(oven, FaultKind.MODEL_DEVIATION, 90)
    assert oven.faults[0].limit == 0.25
    assert oven.board.temperature("hotend") < 260
    mended(oven, 200.0)


def test_weak_heater_deviates_from_its_model():
    oven = Oven("model = { rise_c = 760.0, time_constant_s = 120.0 }")
    oven.heat(200.0)
    fails(oven, FaultKind.MODEL_DEVIATION, 45)


def test_fan_cooling_is_not_a_model_deviation():
    oven = hot(f"{MODEL}\nprotection = {{ deviation = 0.1, deviation_s = 20.0 }}")
    oven.blow(1.0)
    oven.run(120)
    assert oven.faults == []


def test_a_slow_heater_near_its_end_is_not_a_fault():
    oven = Oven(name="bed")
    oven.heat(110.0)
    oven.run(900)
    assert oven.heater.reached
    assert oven.faults == []


def test_disabled_protection_reports_nothing():
    oven = Oven("protection = { watch_rise_c = 0.0, deviation = 0.0 }")
    oven.board.force_heater("hotend", 0.0)
    oven.heat(200.0)
    oven.run(120)
    assert oven.faults == []
    assert oven.heater.limits.watch_rise_c == 0.0
    oven.heater.limits = _core.ProtectionLimits(max_c=285.0)
    fails(oven, FaultKind.HEATING_FAILED, 21)


def test_every_heater_fault_has_a_sentence():
    oven = idle()
    oven.board.force_heater("hotend", 0.0)
    oven.heat(200.0)
    fails(oven, FaultKind.HEATING_FAILED, 21)
    fault = oven.faults[0]
    assert fault.problem.code == "heat.heating-failed"
    assert str(fault) == (
        f"heater hotend was switched off: it is at {fault.celsius:.1f} °C and did not reach"
        f" {fault.limit:.1f} °C in time. Check its cartridge, its supply, and that its sensor sits"
        " where it heats, then send M922."
    )


@pytest.mark.parametrize(
    ("kind", "celsius", "limit", "says"),
    [
        (FaultKind.SENSOR_OPEN, -20.0, 5.0, "reads -20.0 °C; below 5.0 °C means a broken cable"),
        (FaultKind.SENSOR_OPEN, 850.0, 5.0, "reads 850.0 °C, which means a broken cable"),
        (
            FaultKind.SENSOR_SHORT,
            400.0,
            285.0,
            "reads 400.0 °C; above 285.0 °C means a short circuit in its cable",
        ),
        (
            FaultKind.SENSOR_SHORT,
            -50.0,
            285.0,
            "reads -50.0 °C, which means a short circuit in its cable",
        ),
    ],
)
def test_a_broken_sensor_is_named_with_its_reading(kind, celsius, limit, says):
    fault = HeaterFault("bed", kind, celsius, limit, 0)
    assert str(fault).startswith(f"heater bed was switched off: its sensor {says}. Check the ")
    assert str(fault).endswith(", then send M922.")
    assert str(fault.halting) == str(fault).replace("M922", "M999")
