"""Macros that consoles call."""

from __future__ import annotations

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario


def answers(s, line, within=60):
    """What a line is answered, without `ok` and signs of life."""
    heard = s.host.ok(line, within)
    return [text for text in heard if text != "ok" and "busy" not in text]


def test_a_macro_moves_with_its_parameters():
    text = macro("GO_TO", "{% set X = params.X|default(5)|float %}\nG90\nG1 X{X + 1} F6000")
    with Scenario(with_macros(text)) as s:
        s.host.ok("G28", 60)
        s.host.ok("GO_TO x=20")
        s.passes(5)
        assert s.positions()["x"] == 21
        s.host.ok("go_to")
        s.passes(5)
        assert s.positions()["x"] == 6


def test_a_macro_in_place_of_homing_reaches_the_built_in_command():
    gcode = "M118 homing {rawparams}\nG28.1 {rawparams}\nG1 X33 F6000"
    with Scenario(with_macros(macro("G28", gcode, rename_existing='"G28.1"'))) as s:
        assert answers(s, "G28 X Y") == ["homing X Y"]
        s.passes(5)
        assert s.positions()["x"] == 33
        assert s.printer.rig.job.locked_axes == [2]


def test_a_macro_in_place_of_a_tool_takes_what_follows_in_its_line():
    gcode = "M118 to tool 0 {params.P}\nT0.1\nG1 X10 F6000"
    with Scenario(with_macros(macro("T0", gcode, rename_existing='"T0.1"'))) as s:
        s.host.ok("G28", 60)
        assert answers(s, "T0 P7 G1 X20") == ["to tool 0 7"]
        s.passes(5)
        assert s.positions()["x"] == 20  # after the lines of the macro


def test_a_macro_in_place_of_an_immediate_command_comes_in_turn():
    gcode = "M118 said {rawparams}\nM117.1 {rawparams}"
    with Scenario(with_macros(macro("M117", gcode, rename_existing='"M117.1"'))) as s:
        assert answers(s, "M117 Hello World") == [
            "said Hello World",
            "// action:notification Hello World",
        ]


def test_message_of_a_macro_and_of_a_file_keeps_its_semicolon(tmp_path):
    """As in Klipper; the value of RESPOND keeps it in quotes only."""
    lines = "M117 hello; world\nM118 a (1/2); b\nRESPOND MSG='c; d' ; e\nRESPOND MSG=f;g"
    told = ["// action:notification hello; world", "a (1/2); b", "echo: c; d", "echo: f"]
    (tmp_path / "a.g").write_text(lines)
    with Scenario(with_macros(macro("TALK", lines)), card=str(tmp_path)) as s:
        assert answers(s, "TALK") == told
        assert [answers(s, line) for line in lines.split("\n")] == [[text] for text in told]
        s.host.ok("M32 a.g")
        before = len(s.host.heard)
        s.host.expect("Done printing file")
        assert [x for x in s.host.heard[before - 4 :] if x in told] == told
        assert s.printer.prompts.message == "hello; world"


def test_variables_keep_what_calls_have_set():
    gcode = "SET_GCODE_VARIABLE MACRO=COUNT VARIABLE=n VALUE={n + 1}\nM118 {n} {variables.n}"
    other = "M118 {printer['gcode_macro COUNT'].n}"
    text = macro("COUNT", gcode, variables="{n = 1}") + macro("LOOK", other)
    with Scenario(with_macros(text)) as s:
        assert answers(s, "COUNT") == ["1 1"]
        assert answers(s, "COUNT") == ["2 2"]
        assert answers(s, "LOOK") == ["3"]
        s.host.ok("SET_GCODE_VARIABLE MACRO=count VARIABLE=n VALUE=\"'text'\"")
        assert answers(s, "LOOK") == ["text"]


def test_a_template_changes_tables_and_lists_of_variables_in_place():
    text = macro("KEEP", "M118 {table} {names}", variables="{ table = {}, names = [1] }")
    write = "{% set t = printer['gcode_macro keep'].table %}"
    text += macro(
        "SET", write + "{% for k in params %}{% do t.__setitem__(k, params[k]) %}{% endfor %}"
    )
    text += macro("ADD", "{% do printer['gcode_macro KEEP'].names.append(2) %}\nKEEP")
    text += macro("WORSE", write + "{% do t.update(f=action_respond_info) %}")
    with Scenario(with_macros(text)) as s:
        s.host.ok("SET BED=60")
        assert answers(s, "KEEP") == ["{'BED': '60'} [1]"]
        assert answers(s, "ADD") == ["{'BED': '60'} [1, 2]"]
        (said,) = answers(s, "WORSE")
        assert "table of KEEP can hold texts, numbers, lists and tables only" in said
        assert answers(s, "KEEP") == ["{'BED': '60'} [1, 2]"]


def test_variables_have_values_that_toml_lacks():
    literals = """{ stage = "None", corner = "(10, 20)", names = "{0: 'PLA', .6: None}" }"""
    gcode = "M118 {stage is none} {corner[1]} {corner|length} {names[0]} {names[0.6]}"
    other = "M118 {printer['gcode_macro SHOW'].names[n]}"
    text = macro("SHOW", gcode, literals=literals, variables='{ "pa_0.4" = 1 }')
    with Scenario(with_macros(text + macro("LOOK", other, variables="{n = 0}"))) as s:
        assert answers(s, "SHOW") == ["True 20 2 PLA None"]
        s.host.ok("SET_GCODE_VARIABLE MACRO=SHOW VARIABLE=names VALUE=\"{1:None,2:'PETG'}\"")
        s.host.ok("SET_GCODE_VARIABLE MACRO=SHOW VARIABLE=pa_0.4 VALUE=2.5")
        s.host.ok("SET_GCODE_VARIABLE MACRO=LOOK VARIABLE=n VALUE=2")
        assert answers(s, "LOOK") == ["PETG"]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("MACRO=X VARIABLE=n VALUE=1", "there is no macro X; known here: COUNT"),
        ("MACRO=COUNT VARIABLE=m VALUE=1", "macro COUNT has no variable m; known here: n"),
        ("MACRO=COUNT VARIABLE=n VALUE=abc", "variable n: 'abc' is not a value"),
        ("MACRO=COUNT VARIABLE=n", "SET_GCODE_VARIABLE needs VALUE"),
    ],
)
def test_variables_that_cannot_be_set(line, told):
    with Scenario(with_macros(macro("COUNT", "{n}", variables="{n = 1}"))) as s:
        (answer,) = answers(s, f"SET_GCODE_VARIABLE {line}")
        assert told in answer


def test_a_template_reads_the_printer_where_the_plan_ends():
    gcode = (
        "M118 {printer.toolhead.position.x} {printer.gcode_move.absolute_coordinates}"
        " {printer.toolhead.homed_axes} {printer.extruder.target} {printer.heater_bed.target}"
        " {printer.toolhead.axis_maximum.x} {printer.print_stats.state}"
        " {printer.configfile.settings.extruder.min_extrude_temp} {'fan' in printer}"
    )
    with Scenario(with_macros(macro("LOOK", gcode))) as s:
        s.host.ok("G28", 60)
        s.host.ok("M140 S55")
        s.host.ok("G91")
        s.host.ok("G1 X30 F60")  # takes half a minute
        assert answers(s, "LOOK") == ["30.0 False xyz 0.0 55.0 250.0 standby 170.0 True"]


@pytest.mark.parametrize(
    ("gcode", "told"),
    [
        ("G1 X1\n{ 'a' * 10**9 }", "macro BAD, line 2 of its template: it makes more than 65,536"),
        ("\n{ params.SIZE }", "line 2 of its template: a table has no 'SIZE': it is empty"),
        ("{ printer['gcode_macro X'].n }", "its template: printer has no 'gcode_macro X'"),
        ("{ 1 + printer }", "unsupported operand type(s) for +: 'int' and printer"),
        ("{ action_raise_error('no filament') }", "macro BAD: no filament. The macro has stopped"),
        ("BAD", "macro BAD is called by 16 macros that call each other. Remove the circle"),
        (
            "{% for i in range(9999) %}\n{% for j in range(9999) %}{% endfor %}{% endfor %}",
            "line 2 of its template: it takes more than 100,000 steps",
        ),
        ("{% for i in range(10000) %}\n;{% endfor %}", "it becomes more than 10,000 lines"),
        ("G90\nG1 Fa\nM118 not reached", "the word 'F' has no valid number"),
    ],
)
def test_a_call_that_fails_does_nothing_more(gcode, told):
    with Scenario(with_macros(macro("BAD", gcode) + macro("GOOD", "M118 good"))) as s:
        (answer,) = answers(s, "BAD")
        assert told in answer
        assert answers(s, "GOOD") == ["good"]


def test_the_lines_of_nested_macros_are_counted_together():
    inner = macro("INNER", "{% for i in range(900) %};\n{% endfor %}")
    text = inner + macro("OUTER", "INNER\n" * 12)
    with Scenario(with_macros(text)) as s:
        (answer,) = answers(s, "OUTER")
        assert "macro INNER: it becomes more than 10,000 lines" in answer


def test_a_macro_answers_and_stops_the_printer():
    text = macro("ASK", "{ action_respond_info('two\nlines') }")
    text += macro("HALT", "{ action_emergency_stop('smoke') }")
    with Scenario(with_macros(text)) as s:
        assert answers(s, "ASK") == ["// two", "// lines"]
        assert "macro HALT: smoke" in " ".join(answers(s, "HALT"))
        assert s.printer.state.halted


def delayed(name, gcode, seconds=0.0):
    return f"[delayed_gcode.{name}]\ngcode = '''\n{gcode}\n'''\ninitial_duration_s = {seconds}\n"


def test_delayed_gcode_comes_after_its_time():
    text = delayed("first", "M118 first\nUPDATE_DELAYED_GCODE ID=again DURATION=5", 3.0)
    text += delayed("again", "G28\nG1 X12 F6000\nM118 again <{printer.toolhead.homed_axes}>")
    with Scenario(with_macros(text)) as s:
        s.host.silent(2.9, "first")
        s.host.expect("^first$", 1)
        s.host.silent(4.5, "again")
        s.host.expect("^again <>$", 30)  # as it was when the template was rendered
        s.passes(5)
        assert s.positions()["x"] == 12
        s.host.silent(60, "first|again")


def test_delayed_gcode_stops_a_hot_printer():
    with Scenario(with_macros(delayed("watch", "{ action_emergency_stop('smoke') }", 30.0))) as s:
        s.host.ok("M104 S200")
        s.passes(20)
        assert s.board.output_value("hotend") > 0
        s.host.expect("watch: .*smoke", 20)
        s.passes(1)
        assert s.printer.state.halted
        assert s.board.output_value("hotend") == 0


def test_delayed_gcode_is_taken_back_and_set_again():
    with Scenario(with_macros(delayed("one", "M118 one"))) as s:
        s.host.ok("UPDATE_DELAYED_GCODE ID=one DURATION=2")
        s.host.ok("UPDATE_DELAYED_GCODE ID=one DURATION=0")
        s.host.silent(5, "one")
        (answer,) = answers(s, "UPDATE_DELAYED_GCODE ID=two DURATION=1")
        assert "there is no [delayed_gcode.two]; known here: one" in answer
        (answer,) = answers(s, "UPDATE_DELAYED_GCODE ID=one DURATION=-1")
        assert "DURATION" in answer


def test_delayed_gcode_that_fails_reports_it():
    text = delayed("one", "\n{ 1 / 0 }", 1.0) + macro("GOOD", "M118 good")
    with Scenario(with_macros(text)) as s:
        told = s.host.expect("^echo:", 3)
        assert "macro delayed_gcode.one, line 2 of its template: division by zero" in told
        assert answers(s, "GOOD") == ["good"]
