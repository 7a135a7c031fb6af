"""RepRapFirmware's config.g becomes a machine file. The configurations here are our own."""

from pathlib import Path

import pytest
from tests.support.import_remarks import remarks

from passo import config
from passo.cli.main import main
from passo.config.importing.formats import imported
from passo.errors import ConfigError

BASE = """\
; a printer
M550 P"Box; of mine"
G90
M83
M569 P0 S1
M569 P1 S0                       ; backwards
M584 X0 Y1 Z2:4 E3
M669 K1
M350 X16 Y16 Z16 E16 I1
M92 X80 Y80 Z400 E420.5
M566 X600 Y600 Z24 E300
M203 X9000 Y12000 Z600 E3600
M201 X1500 Y1200 Z100 E2500
M906 X800 Y800 Z800 E700 I30
M84 S60
M208 X-5 Y0 Z0 S1
M208 X220 Y210 Z240.5 S0
M574 X1 S1 P"!xstop"
M574 Y2 S1 P"ystop"
M574 Z1 S1 P"zstop"
M308 S0 P"bedtemp" Y"thermistor" T100000 B3950
M950 H0 C"bedheat" T0 Q10
M140 H0
M143 H0 S110
M307 H0 B1 S0.8
M308 S1 P"e0temp" Y"thermistor" T100000 B4725 C7.06e-8
M950 H1 C"e0heat" T1
M143 H1 S260
M950 F0 C"fan0" Q500
M106 P0 X0.9 B0.1
M950 F1 C"fan1" Q250
M106 P1 H1 T45
M558 P9 C"zprobe.in" H5 F240 T6000
G31 P500 X-24 Y3 Z1.25
M557 X20:180 Y30:190 S40
M376 H10
M572 D0 S0.05
M204 P900 T1300
M302 S160
M207 S0.8 F2400 Z0.2
M671 X-10:250 Y100:100 S3
"""


@pytest.fixture
def load(tmp_path: Path):
    """A function from BASE with changes to its draft and its machine."""

    def convert(*changes: tuple[str, str], more: str = ""):
        text = BASE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "config.g"
        path.write_text(text + more, encoding="utf-8")
        draft = imported(path)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


def test_axes_and_motors_have_the_values_of_the_commands(load) -> None:
    _, machine = load()
    assert (machine.name, machine.geometry.kind) == ("box_of_mine", "corexy")
    x, y, z = (machine.axes[name] for name in "xyz")
    assert (x.min_mm, x.max_mm, x.speed_mm_s, x.accel_mm_s2, x.jerk_mm_s) == (
        -5,
        220,
        150,
        1500,
        10,
    )
    assert (y.max_mm, y.speed_mm_s, z.max_mm, z.speed_mm_s) == (210, 200, 240.5, 10)
    steppers = machine.steppers
    assert {name: (s.steps_per_mm, s.socket, s.invert) for name, s in steppers.items()} == {
        "a": (80, "MOTOR0", False),
        "b": (80, "MOTOR1", True),
        "z": (400, "MOTOR2", False),
        "z1": (400, "MOTOR4", False),
        "e": (420.5, "MOTOR3", False),
    }
    e = machine.extruders["e"]
    assert (e.speed_mm_s, e.accel_mm_s2, e.jerk_mm_s, e.advance_s) == (60, 2500, 5, 0.05)


def test_homing_probe_and_mesh(load) -> None:
    _, machine = load()
    homing = machine.homing
    ends = {name: (h.direction, h.position) for name, h in homing.items()}
    assert ends == {"x": ("min", -5), "y": ("max", 210), "z": ("min", 0)}
    assert (homing["x"].pin, homing["y"].pin) == ("!X_STOP", "Y_STOP")
    probe = machine.probe
    assert probe is not None
    assert (probe.kind, probe.fast_mm_s, probe.travel_mm_s) == ("bltouch", 4, 100)
    assert (probe.offset_mm, probe.trigger_height_mm) == ([-24, 3], 1.25)
    levelling = machine.levelling
    assert (levelling.area, levelling.count, levelling.fade_mm) == ([20, 30, 180, 190], [5, 5], 10)


def test_heaters_fans_and_limits(load) -> None:
    _, machine = load()
    bed, hotend = machine.heaters["bed"], machine.heaters["hotend"]
    assert (bed.max_c, bed.max_power, bed.pwm_hz, bed.control.kind) == (110, 0.8, 10, "bang-bang")
    assert (hotend.max_c, hotend.control.kind) == (260, "pid")
    assert (hotend.sensor.beta_k, hotend.sensor.c_per_k) == (4725, 7.06e-8)
    part, other = machine.fans["part"], machine.fans["fan1"]
    assert (part.max_power, part.kick_start_s, part.pwm_hz) == (0.9, 0.1, 500)
    assert (other.follows, other.above_c) == ("hotend", 45)
    limits, retraction = machine.limits, machine.retraction
    assert (limits.print_accel_mm_s2, limits.travel_accel_mm_s2) == (900, 1300)
    assert (limits.min_extrude_c, machine.idle.motors_off_s) == (160, 60)
    assert (retraction.length_mm, retraction.speed_mm_s, retraction.hop_mm) == (0.8, 40, 0.2)


def test_delta_has_carriages_that_home_upward(load) -> None:
    delta = ("M669 K1", "M665 R100 L250 B85 H300 X0.5 Y0 Z0")
    ends = ('M574 X1 S1 P"!xstop"', 'M574 X2 S1 P"!xstop"'), ("M574 Z1", "M574 Z2")
    _, machine = load(delta, *ends, ("Z2:4", "Z2"))
    assert machine.geometry.kind == "delta"
    assert machine.geometry.angles == [210.5, 330, 90]
    height = 300 + (250**2 - 100**2) ** 0.5
    assert machine.homing["a"].direction == "max"
    assert machine.homing["a"].position == pytest.approx(height, abs=1e-5)


def test_rrf_report_names_open_decisions(load) -> None:
    draft, machine = load(more='if {state.status = "idle"}\n  M117 hi\nM98 P"more.g"\nM42 P1 S1\n')
    decide = "\n".join(remarks(draft, "decide"))
    assert machine.board.link == "simulated"
    assert "simulated on the sockets and pins of octopus, which are not yours" in decide
    assert "config.g:14: M906: give driver and tmc.run_current_a" in decide
    assert "2 lines: conditions, variables and indented lines are not read" in decide
    assert "config.g:44: M98: the commands of that file are not read" in decide
    assert "config.g:45: M42: it is not taken over" in "\n".join(remarks(draft, "dropped"))


def test_tools_have_heaters_and_offsets(load) -> None:
    more = 'M308 S2 Y"pt1000"\nM950 H2 T2\nM563 P0 D0 H1\nM563 P1 D1 H2\nG10 P1 X17.8 Y-1 Z0\n'
    _, machine = load(("E3\n", "E3:5\n"), more=more)
    first, second = machine.tools
    assert (first.extruder, first.heater, first.offset_mm) == ("e", "hotend", [0, 0, 0])
    assert (second.extruder, second.heater, second.offset_mm) == ("e1", "hotend1", [17.8, -1, 0])
    assert (machine.heaters["hotend1"].sensor.kind, machine.heaters["hotend1"].max_c) == (
        "pt1000",
        285,
    )


def test_tool_keeps_its_fans_without_those_of_heaters(load) -> None:
    more = 'M950 F2 C"fan2"\nM106 P2 S0\nM563 P0 D0 H1 F2:1\n'
    _, machine = load(more=more)
    assert machine.fans["fan1"].follows == "hotend"
    assert [tool.fans for tool in machine.tools] == [["fan2"]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("M92 X80", "M92 X-80", "steps_per_mm is -80"),
        ("M203 X9000", "M203 Z9000", "M203 X is missing: expected the speed of the axis"),
        ("M669 K1", "M669 K9", "the kind of machine is 'M669 K9'"),
        ("M92 X80", "M92 Xhot", "M92/X is 'hot': expected a number"),
    ],
)
def test_rrf_import_needs_the_values_of_motion(load, old, new, message) -> None:
    with pytest.raises(ConfigError) as caught:
        load((old, new))
    assert message in str(caught.value)


def test_command_imports_a_config_g_that_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("config.g").write_text(BASE)
    assert main(["import", "config.g", "--output", "mine.toml"]) == 0
    assert main(["check", "mine.toml"]) == 0
    Path("a.gcode").write_text("G28\nG1 X50 Y50 F6000\nM400\n")
    assert main(["print", "a.gcode", "--machine", "mine.toml"]) == 0
    capsys.readouterr()
