"""What a host may ask: JSON, limits, switches."""

import json

import pytest
from tests.support.scenario import Scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


def status(s, line="M408"):
    return json.loads(s.host.ok(line)[0])


def test_nothing_has_power_after_an_emergency_stop(s):
    s.host.ok("M140 S60 F")
    s.passes(2)
    assert "B@:127" in s.host.ok("M105")[0]
    s.host.ok("M112")
    assert s.host.ok("M105")[0].endswith("@:0 B@:0")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("P150", "100%"),
        ("P-7", "0%"),
        ("P30 R-2", "30%, 0 min left"),
        ("P30 R5", "30%, 5 min left"),
    ],
)
def test_progress_is_from_0_to_100_percent(s, words, told):
    s.host.ok(f"M73 {words}")
    assert s.host.ok("M73") == [f"echo:Progress: {told}", "ok"]


def test_a_file_that_cannot_be_deleted_and_one_without_a_name(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        assert s.host.ok("M30 no.gcode")[0].startswith("echo:Deletion failed, File: no.gcode. ")
        assert "name" in s.host.ok("M28 F")[0]
        s.host.ok("M29")
    assert not list(tmp_path.iterdir())


def test_m408_reports_the_state_as_json(s):
    s.passes(1)
    first = status(s)
    assert first["status"] == "I"
    assert first["coords"]["axesHomed"] == [0, 0, 0]
    s.host.ok("G92 X10 Y20")
    s.host.ok("M140 S50 F")
    s.host.ok("M106 S255")
    s.host.ok("M220 S150")
    s.host.ok("G1 X60 F600")
    s.passes(1)
    now = status(s, "M408 S0")
    assert now["status"] == "B"
    assert now["coords"] == {"axesHomed": [1, 1, 0], "extr": [0.0], "xyz": [60.0, 20.0, 0.0]}
    assert now["currentTool"] == 0
    assert now["params"]["fanPercent"] == [100.0]
    assert now["params"]["speedFactor"] == 150.0
    assert now["params"]["extrFactors"] == [100.0]
    assert now["temps"]["bed"]["active"] == 50.0
    assert now["temps"]["bed"]["state"] == 2
    assert now["temps"]["heads"]["active"] == [0.0]
    assert now["temps"]["heads"]["state"] == [0]
    assert now["temps"]["heads"]["current"][0] == pytest.approx(21, abs=6)
    assert now["time"] > first["time"]
    assert not {"name", "currentLayer"} & now.keys()


def test_m408_reports_the_machine_and_the_print(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X50 F600\nG1 X0\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        machine = status(s, "M408 S2")
        assert (machine["name"], machine["geometry"]) == ("i3", "cartesian")
        assert machine["tools"] == [{"number": 0, "heaters": [1], "drives": [0]}]
        assert status(s, "M408 S3")["fractionPrinted"] == 0.0
        s.host.ok("M32 a.g")
        s.passes(2)
        printing = status(s, "M408 S3")
        assert printing["status"] == "P"
        assert printing["fractionPrinted"] > 0
        assert printing["extrRaw"] == [0.0]
        s.host.ok("M25")
        assert status(s)["status"] == "A"
        s.host.ok("M112")
        s.passes(1)
        assert status(s)["status"] == "H"


def test_limits_are_reported_and_cannot_be_turned_off(s):
    axes = s.machine.axes
    line = s.host.ok("M122")[0]
    assert line.startswith("Soft endstops: ON  Min: X:0.00 Y:0.00 Z:0.00  Max: X:")
    assert line.endswith(f"Z:{axes['z'].max_mm:.2f}")
    assert s.host.ok("M122 S1")[0] == line
    assert "axes" in s.host.ok("M122 S0")[0]


def test_the_logic_of_switches_belongs_to_the_machine_file(s):
    for code in ("M123", "M124"):
        assert s.host.ok(code)[:2] == [
            "Reporting endstop logic and pullup",
            "x Logic:false Pullup:true",
        ]
        assert "homing" in s.host.ok(f"{code} X1")[0]
