"""APrinter's options by name: noted, then applied."""

import json
import re
from pathlib import Path

import pytest
from tests.support.driver_machine import machine as drivers_machine
from tests.support.driver_machine import machine_text
from tests.support.scenario import Host, Scenario

from passo import config
from passo.console.aprinter_option_table import options


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


def test_aprinter_options_are_reported(s):
    for name, value in {
        "XStepsPerUnit": "80",
        "ZMaxSpeed": "12",
        "EMaxAccel": "5000",
        "xmaxpos": "250",
        "ExtruderHeater0MaxSafeTemp": "285",
        "BedHeater0TempBeta": "3950",
        "YHomeDir": "0",
        "InactiveTime": "600",
    }.items():
        assert s.host.ok(f"M925 I{name}") == [value, "ok"], name
    assert "UnknownOption" in s.host.ok("M925 IFooBar")[0]
    assert s.host.ok(r"M925 IInactive\54ime") == s.host.ok("M925 IInactiveTime")


TOLD = {
    "dual-extruder": {
        "XInvertDir": 0,
        "XHomeEndInvert": 0,
        "XHomeFastMaxDist": 396,
        "XHomeSlowMaxDist": 6,
        "XHomeRetractSpeed": 40,
        "XHomeByDefault": 1,
        "E1MaxAccel": 5000,
        "E1StepsPerUnit": 95.5,
        "ExtruderHeater1MinExtrusionTemp": 170,
        "ExtruderHeater1PidIStateMin": 0,
        "ExtruderHeater1PidIStateMax": 1,
        "ExtruderHeater1PidDHistory": 0.8,
        "ExtruderHeater1ControlInterval": 0.25,
        "ExtruderHeater1ObserverInterval": 0.25,
        "ExtruderHeater1ObserverTolerance": 1,
        "ExtruderHeater1ObserverMinTime": 10,
        "BedHeater0TempMinTemp": -20,
        "BedHeater0TempMaxTemp": 400,
    },
    "multi-material": {"ZS1InvertDir": 0},
    "delta": {
        "DeltaDiagonalRod": 160,
        "DeltaDiagonalRodCorr3": 0,
        "DeltaSmoothRodOffset": 81,
        "DeltaEffectorOffset": 0,
        "DeltaCarriageOffset": 0,
        "DeltaLimitRadius": 75.1,
        "AStepsPerUnit": 87.489,
        "AMaxPos": 318,
        "AMaxSpeed": 250,
        "AHomeDir": 1,
        "XMaxPos": 75.1,
    },
    "rotary-delta": {
        "DeltaEndEffectorLength": 30,
        "DeltaBaseLength": 40,
        "DeltaRodLength": 130,
        "DeltaArmLength": 80,
        "DeltaZOffset": 150,
        "AMinPos": -30,
    },
    "scara": {
        "SCARAArm1Length": 150,
        "SCARAArm2Length": 150,
        "SCARAExternalArm2Motor": 1,
        "SCARAXOffset": 100,
        "SCARAYOffset": -56,
    },
    "laser": {"LLaserPower": 100, "LMaxPower": 100},
}


@pytest.mark.parametrize("machine", TOLD)
def test_machine_file_values_have_aprinter_names(machine):
    with Scenario(machine) as s:
        for name, value in TOLD[machine].items():
            assert s.host.ok(f"M925 I{name}") == [f"{value:g}", "ok"], name


def test_a_platinum_sensor_and_currents_of_drivers_are_reported():
    text = machine_text()
    begin = text.index("[heaters.hotend]")
    text = text[:begin] + text[begin:].replace(
        'sensor_pin = "T0"', 'sensor_pin = "T0"\nsensor = { kind = "pt1000" }', 1
    )
    with Scenario(config.load_text(text)) as s:
        for name, value in {
            "ExtruderHeater0TempResistorR": "4700",
            "ExtruderHeater0TempPtR0": "1000",
            "ExtruderHeater0TempPtA": "0.0039083",
            "ExtruderHeater0TempPtB": "-0.0000005775",
            "ZCurrent": "600",
            "ECurrent": "1200",
        }.items():
            assert s.host.ok(f"M925 I{name}")[0] == value, name


@pytest.mark.parametrize("machine", ["dual-extruder", "delta", "scara", "drivers"])
def test_every_option_is_set_and_survives_a_halt(machine):
    with Scenario(drivers_machine() if machine == "drivers" else machine) as s:
        settable = [o for o in options(s.printer) if o.command]
        wanted = {o.name: 0.9 * o.value() or 0.5 for o in settable}
        assert len(wanted) >= 20
        for name, value in wanted.items():
            assert s.host.ok(f"M926 I{name} V{value}") == ["ok"], name
        assert s.host.ok("M930", 30) == ["ok"]
        s.host.send("M112")
        s.host.expect("halted", 5)
        s.host.send("M999")
        s.host.expect("ready again", 5)
        told = {name: float(s.host.ok(f"M925 I{name}")[0]) for name in wanted}
        assert told == pytest.approx(wanted)


def test_all_of_aprinters_names_are_on_their_page():
    page = (Path(__file__).parents[2] / "docs/reference/options.md").read_text()
    for machine in (*TOLD, "cnc"):
        with Scenario(machine) as s:
            for option in options(s.printer):
                name = re.sub(r"^(Extruder|Bed|Chamber)Heater\d", "", option.name)
                name = re.sub(r"^(?!SCARA)[XYZABCEL]\d?(S\d)?(?=[A-Z])", "", name)
                assert f"`{name}`" in page or f"{name}`" in page, option.name


def test_a_new_value_is_pending_until_m930(s):
    assert s.host.ok("M926 IXStepsPerUnit V100") == ["ok"]
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "80"
    assert "; pending until M930: M926 IXStepsPerUnit V100" in s.host.ok("M503")
    s.host.ok("M926 IExtruderHeater0PidP V0.125")
    assert s.host.ok("M930") == ["ok"]
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "100"
    assert s.host.ok("M925 IExtruderHeater0PidP")[0] == "0.125"
    assert not any("pending" in line for line in s.host.ok("M503"))
    s.host.ok("M926 IXStepsPerUnit")
    s.host.ok("M930")
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "80"  # as at the start


def test_m408_reports_what_is_pending(s):
    def pending(form=0):
        return json.loads(s.host.ok(f"M408 S{form}")[0])["pending"]

    assert pending() == {}
    s.host.ok("M926 Ixstepsperunit V100")
    s.host.ok("M926 IExtruderHeater0PidP V0.125")
    wanted = {"XStepsPerUnit": 100.0, "ExtruderHeater0PidP": 0.125}
    assert [pending(form) for form in range(4)] == [wanted] * 4
    s.host.ok("M930")
    assert pending() == {}


def test_read_only_options_are_refused(s):
    assert "fixed while the printer runs" in s.host.ok("M926 IXMaxPos V300")[0]
    assert "V is abc: expected a number" in s.host.ok("M926 IXMaxSpeed Vabc")[0]
    assert "V is nan: expected a number" in s.host.ok("M926 IXMaxSpeed Vnan")[0]
    s.host.ok("M926 IXMaxSpeed V999")  # beyond the machine file's
    assert s.host.ok("M930")[0] == "echo:XMaxSpeed stays at 300; M203 X999 was not taken"


def test_parameters_of_m926_may_be_in_any_order(s):
    s.host.ok("M926 V77 IXMaxSpeed")
    assert s.host.ok("M503").count("; pending until M930: M926 IXMaxSpeed V77") == 1
    assert "V is nothing: expected a number" in s.host.ok("M926 IXMaxSpeed V 88")[0]
    assert "UnknownOption" in s.host.ok("M926 V77")[0]
    s.host.ok("M930")
    assert s.host.ok("M925 IXMaxSpeed")[0] == "77"


def test_m92_acts_at_once(s):
    s.host.ok("M92 X90")
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "90"


def test_gains_are_reported_while_an_autotune_runs(s):
    before = s.host.ok("M925 IExtruderHeater0PidP")[0]
    assert float(before) > 0
    s.host.send("M303 H0 S200")
    s.passes(20)
    other = Host(s)
    assert other.ok("M925 IExtruderHeater0PidP")[0] == before
    other.send("M108")
    s.host.expect("^ok", 30)
