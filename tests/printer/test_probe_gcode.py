"""G-code that runs before and after each descent of a probe."""

import pytest
from tests.printer.test_probe_kinds import FIXED
from tests.support.edited_machine import STILL, answers, at_home, edited

from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError

TAP = """
{% set limit, extruder = 150, printer.extruder %}
{% if extruder.target > limit %}
  { action_respond_info("lowering to %d" % limit) }
  M109 R{limit}
{% endif %}
"""


def counts(name):
    value = f"{{printer['gcode_macro COUNT'].{name} + 1}}"
    return f"SET_GCODE_VARIABLE MACRO=COUNT VARIABLE={name} VALUE={value}"


def machine(arm="", disarm="", more=""):
    keys = FIXED + "".join(
        f"\n{key} = '''{text}'''" for key, text in (("arm_gcode", arm), ("disarm_gcode", disarm))
    )
    counter = "[macros.COUNT]\ngcode = ''\nvariables = { up = 0, down = 0 }\n"
    return edited("i3-probe", STILL, (FIXED, keys), more=counter + more)


def counted(s):
    found = s.printer.rig.macros.variables["COUNT"]
    return found["down"], found["up"]


def test_hot_nozzle_cools_to_150_before_it_descends():
    with at_home(machine(TAP)) as s:
        s.host.ok("M109 S200", 300)
        assert answers(s, "G30 X110 Y110")[0] == "// lowering to 150"
        assert s.printer.rig.connection.heaters["hotend"].target == 150
        assert s.printer.rig.connection.heaters["hotend"].celsius < 156


def test_gcode_runs_around_each_descent_and_the_line_goes_on():
    counting = machine(counts("down"), counts("up"))
    with at_home(counting) as s:
        s.host.ok("G30 X110 Y110")
        assert counted(s) == (2, 2)
        s.host.ok("PROBE_ACCURACY SAMPLES=4", 120)
        assert counted(s) == (7, 7)


@pytest.mark.parametrize("source", ["macro", "file", "m98"])
def test_probing_in_a_program_goes_on_with_its_next_line(source, tmp_path):
    text = "G30 X110 Y110\nG1 X50 Y60 F3000\nG30 X30 Y30\nG1 X70\n"
    more = "[macros.AROUND]\ngcode = '''\n" + text + "'''\n"
    counting = machine(counts("down"), counts("up"), more)
    body = {"macro": "AROUND\n", "file": text, "m98": f"M98 P1\nM2\nO1\n{text}M99\n"}[source]
    (tmp_path / "a.gcode").write_text(body)
    with at_home(counting, card=str(tmp_path)) as s:
        s.host.ok("M32 a.gcode")
        s.until(lambda: s.printer.state.busy(), 10)
        s.until(lambda: not s.printer.state.busy(), 300)
        assert counted(s) == (4, 4)
        assert s.host.ok("M114")[0].startswith("X:70.000 Y:25.000")


def test_gcode_that_moves_the_axes_stops_the_probing():
    with at_home(machine("G1 X5 F3000")) as s:
        said = answers(s, "G30 X110 Y110")[-1]
        assert (
            "the G-code of probe.arm_gcode moves the axes from X135.000 Y105.000 Z10.000 to X5.000"
            in said
        )
        assert s.printer.rig.job.locked_axes == []


def test_gcode_after_a_failed_descent_runs_all_the_same():
    counting = machine(counts("down"), counts("up"))
    with at_home(counting) as s:
        s.board.spoil_probe(dead_areas=[(0, 0, 250, 220)])
        assert "the probe was not triggered" in answers(s, "G30 X110 Y110")[-1]
        assert counted(s) == (1, 1)
        s.board.spoil_probe()
        assert answers(s, "G30 X110 Y110")[-1].startswith("Bed X: 110.00")


@pytest.mark.parametrize("end", ["M524", "M410"])
def test_gcode_after_a_descent_runs_when_the_print_is_stopped(end, tmp_path):
    (tmp_path / "a.gcode").write_text("G30 X110 Y110\n")
    keys = 'kind = "bltouch"\npin = "^Z_MAX"\ncontrol_pin = "SERVO0"\ntrigger_height_mm = 1.2'
    keys += f"\narm_gcode = '''{counts('down')}\nM400'''"
    keys += f"\ndisarm_gcode = '''{counts('up')}\nM400'''"
    counter = "[macros.COUNT]\ngcode = ''\nvariables = { up = 0, down = 0 }\n"
    with at_home(edited("i3-probe", STILL, (FIXED, keys), more=counter), card=str(tmp_path)) as s:
        s.host.ok("M32 a.gcode")
        s.until(lambda: counted(s)[0] == 1, 60)
        s.passes(0.3)
        s.host.ok(end, 60)
        s.until(lambda: not s.printer.state.busy() and not s.printer.motion_lock.locked, 60)
        assert counted(s) == (1, 1)
        assert s.positions()["z"] >= 10.0
        assert answers(s, "QUERY_PROBE") == ["// probe: open"]  # its pin is stowed
        assert answers(s, "G30 X110 Y110")[-1].startswith("Bed X: 110.00")


def test_probe_is_stowed_though_its_gcode_fails():
    with at_home(machine(disarm="M104 S900")) as s:
        s.board.spoil_probe(dead_areas=[(0, 0, 250, 220)])
        said = "\n".join(answers(s, "G30 X110 Y110"))
        assert "the probe was not triggered" in said
        assert "900" in said
        assert s.positions()["z"] >= 10.0


def test_refused_gcode_stops_the_probing_with_its_reason():
    with at_home(machine("M104 S900")) as s:
        assert "900" in answers(s, "G30 X110 Y110")[-1]
        assert s.positions()["z"] >= 10.0


def test_template_of_a_probe_is_checked_with_the_machine():
    text = shipped_text("i3-probe").replace(FIXED, FIXED + "\narm_gcode = '{% if %}'")
    with pytest.raises(ConfigError, match="line 1 of the template"):
        load_text(text)
