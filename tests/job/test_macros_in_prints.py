"""Macros in files: from the card, without consoles, in estimates; where they fail."""

from __future__ import annotations

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

from passo.errors import InputError
from passo.job.batch.estimate import estimate
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.printer.unfit_commands import NOTHING, Skips

MACROS = (
    macro("START_PRINT", "G28\nG1 X{params.X} F6000\nFILL N=2")
    + macro("FILL", "{% for i in range(params.N|int) %}\nG1 Y{10 * i + 10}\n{% endfor %}")
    + macro("T0", "M118 tool\nT0.1\nG1 X55", rename_existing='"T0.1"')
)
GOOD = "START_PRINT X=30\nG1 X40\nT0\nG1 Y5\n"


def printed(s, name, *, within=120):
    """The lines that a print of this file has told."""
    start = len(s.host.heard)
    s.host.ok(f"M32 {name}")
    assert s.until(lambda: not s.assembly.services.jobs.runner.active, within)
    return s.host.heard[start:]


def test_a_print_from_the_card_calls_macros(tmp_path):
    (tmp_path / "a.g").write_text(GOOD)
    with Scenario(with_macros(MACROS), card=str(tmp_path)) as s:
        heard = printed(s, "a.g")
        assert "tool" in heard
        assert "Done printing file" in heard
        assert (s.positions()["x"], s.positions()["y"]) == (55, 5)


def test_prints_without_consoles_and_estimates_call_macros(tmp_path):
    path = tmp_path / "a.g"
    path.write_text(GOOD)
    plain = tmp_path / "plain.g"
    plain.write_text("G28\nG1 X30 F6000\nG1 Y10\nG1 Y20\nG1 X40\nT0\nG1 X55\nG1 Y5\n")
    machine = with_macros(MACROS)
    for checked in (True, False):
        whole = Print(machine, Policy(checked=checked)).run(path)
        assert whole.stream_hash == Print(with_macros(""), Policy()).run(plain).stream_hash
        assert whole.warnings == []
    planned = estimate(machine, path)
    assert planned.moving_s == estimate(machine, plain).moving_s
    assert planned.moves == 6


@pytest.mark.parametrize(
    ("gcode", "told"),
    [
        ("G1 X1\n{ 'a' * 10**9 }", "a.g:3: macro BAD, line 2 of its template: it makes more"),
        ("{ action_raise_error('no filament') }", "a.g:3: macro BAD: no filament"),
        ("BAD", "a.g:3: macro BAD is called by 16 macros"),
        ("G1 X50\nG1 X1000", "a.g:3: X 1000.000"),
        ("FOO_BAR A=1", "a.g:3: FOO_BAR is unknown here; it is usually a macro, and the"),
        ("G84 X1", "a.g:3: G84 is unknown here"),
    ],
)
def test_a_macro_that_fails_stops_a_print_at_the_line_of_its_call(tmp_path, gcode, told):
    path = tmp_path / "a.g"
    path.write_text("G28\nG1 X10 F6000\nBAD\nG1 X20\n")
    machine = with_macros(macro("BAD", gcode))
    with Scenario(machine, card=str(tmp_path)) as s:
        heard = printed(s, "a.g")
        assert any("Print of a.g stopped" in line and told in line for line in heard)
        s.passes(5)
        assert s.positions()["x"] in (10, 50)
    with pytest.raises(InputError) as caught:
        Print(machine, Policy(skips=NOTHING)).run(path)
    assert told in str(caught.value)


def test_unknown_commands_of_macros_are_left_out_where_that_is_asked_for(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nODD\nG1 X20 F6000\n")
    machine = with_macros(macro("ODD", "FOO_BAR A=1\nG1 Y7 F6000"))
    result = Print(machine, Policy(skips=Skips(unknown=True))).run(path)
    assert [line.split(": ")[1] for line in result.warnings] == [
        "FOO_BAR is unknown and was skipped (1 time)"
    ]


def test_a_profile_without_its_macro_stops_before_the_first_move(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("START_PRINT BED=60\nG28\nG1 X20 F6000\nEND_PRINT\n")
    with pytest.raises(InputError) as caught:
        Print(with_macros(macro("END_PRINT", "M104 S0")), Policy(skips=NOTHING)).run(path)
    assert str(caught.value) == (
        f"{path}:1: START_PRINT is unknown here; it is usually a macro, and the machine file has no"
        " [macros.START_PRINT]. Add this section with its gcode to the machine file, or allow it to"
        " be left out by --unknown skip."
    )


def test_an_emergency_stop_in_a_macro_ends_a_print(tmp_path):
    (tmp_path / "a.g").write_text("G28\nHALT\nG1 X20 F6000\n")
    with Scenario(
        with_macros(macro("HALT", "{ action_emergency_stop('smoke') }")), card=str(tmp_path)
    ) as s:
        printed(s, "a.g")
        assert s.printer.state.halted


def test_a_print_follows_the_delayed_gcode_of_the_start(tmp_path):
    """Macros keep their settings there. One that fails is a warning; a late one has not run."""
    path = tmp_path / "a.g"
    path.write_text("GO\n")
    starts = {
        "settings": ("SET_GCODE_VARIABLE MACRO=GO VARIABLE=x VALUE=30", 1),
        "broken": ("{ printer.nothing.at.all }\\nG1 X99", 2),
        "unhomed": ("G1 X99\\nSET_GCODE_VARIABLE MACRO=GO VARIABLE=x VALUE=40", 3),
        "later": ("SET_GCODE_VARIABLE MACRO=GO VARIABLE=x VALUE=50", 3600),
        "never": ("SET_GCODE_VARIABLE MACRO=GO VARIABLE=x VALUE=60", 0),
    }
    delayed = "".join(
        f'[delayed_gcode.{name}]\ngcode = "{gcode}"\ninitial_duration_s = {after_s}.0\n'
        for name, (gcode, after_s) in starts.items()
    )
    go = macro("GO", "G28\nG1 X{x} F6000", variables="{ x = 10 }")
    machine = with_macros(go + delayed)
    whole = Print(machine, Policy(checked=True)).run(path)
    assert whole.final_position_mm["x"] == 30.0
    assert [text.split(": ")[1] for text in whole.warnings] == [
        "delayed_gcode.broken",
        "delayed_gcode.unhomed",
    ]
    with Scenario(machine, card=str(tmp_path)) as s:
        s.passes(10)
        printed(s, "a.g")
        assert s.positions()["x"] == 30


KEPT = """
[klipper."output_pin lock"]
[klipper."filament_switch_sensor roll"]
[klipper."fan_generic Bed Fans"]
[klipper."heater_generic box"]
[klipper.motors_sync]
"""
READS = macro(
    "READ",
    "{% set fan = printer['fan_generic bed_fans'].speed %}"
    "{% if not printer.motors_sync.applied %}"
    "G1 X{printer['output_pin lock'].value + 10 * fan}"
    " Y{printer['filament_switch_sensor roll'].filament_detected|int + 4 *"
    " printer['filament_switch_sensor roll'].enabled|int}{% endif %}",
)
SETS = "SET_PIN PIN=lock VALUE=20\nSET_FAN_SPEED FAN='bed fans' SPEED=0.5\n"
SETS += "SET_FILAMENT_SENSOR SENSOR=Roll ENABLE=0\nSET_HEATER_TEMPERATURE HEATER=box TARGET=0\n"


def test_macros_go_on_with_parts_that_are_left_out(tmp_path):
    """The same in a print from the card; a heater that is missing never gets a target."""
    path = tmp_path / "a.g"
    path.write_text(f"G28\nREAD\n{SETS}READ\n")
    machine = with_macros(READS + KEPT)
    result = Print(machine, Policy(checked=True)).run(path)
    assert result.final_position_mm["x"] == pytest.approx(25)
    assert result.final_position_mm["y"] == pytest.approx(1)
    told = "\n".join(result.warnings)
    assert all(f"{code} does nothing here" in told for code in ("SET_PIN", "SET_FAN_SPEED"))
    with Scenario(machine, card=str(tmp_path)) as s:
        printed(s, "a.g")
        assert (s.positions()["x"], s.positions()["y"]) == (25, 1)
    path.write_text("SET_HEATER_TEMPERATURE HEATER=box TARGET=50\n")
    with pytest.raises(InputError, match="HEATER is box: expected"):
        Print(machine, Policy(checked=True)).run(path)


def test_a_print_may_set_positions_of_its_axes(tmp_path):
    """Macros raise the nozzle so before they home."""
    path = tmp_path / "a.g"
    path.write_text("SET_KINEMATIC_POSITION Z=0\nG1 Z10 F600\nG28\n")
    result = Print(with_macros(""), Policy(checked=True)).run(path)
    assert result.steps["z"] > 0
    with Scenario("i3", card=str(tmp_path)) as s:
        assert "Done printing file" in printed(s, "a.g")
    path.write_text("G28\nSET_KINEMATIC_POSITION X=9 CLEAR_HOMED=Y\nG1 X19 F600\nG1 Y5\n")
    with pytest.raises(InputError, match=r"a\.g:4: axis Y is not homed"):
        Print(with_macros(""), Policy(checked=True)).run(path)
    with Scenario("i3", card=str(tmp_path)) as s:
        assert any("axis Y is not homed" in line for line in printed(s, "a.g"))
        assert s.printer.rig.job.machine_position[0] == 19


def test_klippers_commands_do_not_call_macros_that_replace_others(tmp_path):
    """A macro M106 or M140 often calls the command that Passo carries out as M106 or M140."""
    fan = "SET_FAN_SPEED FAN=fan SPEED={params.S|float / 510}"
    bed = "SET_HEATER_TEMPERATURE HEATER=heater_bed TARGET={params.S|float + 1}"
    machine = with_macros(
        macro("M106", fan, rename_existing='"M9106"')
        + macro("m140", bed, rename_existing='"M9140"')
    )
    (tmp_path / "a.g").write_text("M106 S255\nM140 S40\nM400\n")
    with Scenario(machine, card=str(tmp_path)) as s:
        printed(s, "a.g")
        assert s.printer.rig.commands.outputs.fans == {"part": 0.5}
        assert s.printer.rig.commands.set_points.targets_c["bed"] == 41


def test_macros_go_on_where_a_fan_is_missing(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nCOOL\n")
    machine = with_macros(macro("COOL", "M106 P2 S0\nM107 P3\nG1 X5 F6000"))
    result = Print(machine, Policy(checked=True)).run(path)
    assert result.final_position_mm["x"] == 5
    assert ["P2 does nothing here. The fans are 0" in text for text in result.warnings] == [
        True,
        False,
    ]
    path.write_text("G28\nM106 P2 S0\n")
    with pytest.raises(InputError, match="P is 2: expected 0"):
        Print(machine, Policy(checked=True)).run(path)
