"""Calls of words that nothing defines: an import and the check of a machine find them."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE
from tests.support.import_remarks import remarks

from passo.config.importing.formats import imported
from passo.config.load import load_text, shipped_text
from passo.config.macro_calls import words_called
from passo.config.notes import notes

LIGHTS = """[gcode_macro START]
gcode:
  G28
  {% if params.BED %}
    LIGHTS_ON COLOR=red
  {% endif %}
"""


@pytest.mark.parametrize(
    ("template", "words"),
    [
        ("G1 X1\nFOO A=1\nM104 S200\nT0", {"FOO": 2}),
        ("{% if a %}\n  foo\n{% else %}BAR\n{% endif %}\nFOO", {"FOO": 2, "BAR": 3}),
        ("SET Y={% if a %}LEFT{% endif %} RIGHT", {"SET": 1}),
        ("{ action_respond_info('''one\nTWO''') }\nTHREE", {"THREE": 3}),
        ("FOO{x} 1\n{y}BAR\n{% set a =\n 2 %}\nLAST", {"LAST": 5}),
        ("M117 HELLO THERE\n; NOT THIS\n{# NOR\nTHIS #}", {}),
    ],
)
def test_only_literal_words_at_the_start_of_a_line_are_calls(template: str, words: dict[str, int]):
    assert words_called(template) == words


def imported_with(tmp_path: Path, more: str):
    path = tmp_path / "printer.cfg"
    path.write_text(BASE + more, encoding="utf-8")
    draft = imported(path)
    return draft, load_text(draft.text("From a test."))


def test_a_macro_stands_for_a_call_that_klipper_skips(tmp_path: Path):
    draft, machine = imported_with(tmp_path, LIGHTS)
    assert machine.macros["LIGHTS_ON"].gcode == "M118 LIGHTS_ON: no file defines it"
    (remark,) = [r for r in remarks(draft, "changed") if "LIGHTS_ON" in r]
    assert "LIGHTS_ON in START, line 3: no file here defines it" in remark


def test_beside_an_unknown_plug_in_the_owner_decides(tmp_path: Path):
    draft, machine = imported_with(tmp_path, LIGHTS + "[robot_arm]\nspeed: 5\n")
    assert [*machine.macros] == ["START"]
    (remark,) = [r for r in remarks(draft, "decide") if "LIGHTS_ON" in r]
    assert "unless [robot_arm] has it: a print stops there" in remark
    (note,) = [n for n in notes(machine) if "LIGHTS_ON" in n]
    assert note.startswith("macros.START, line 3, calls LIGHTS_ON, which is neither a command")


def test_the_check_finds_a_call_in_delayed_gcode():
    text = '[delayed_gcode.later]\ngcode = "FOO"\n[macros.SAY]\ngcode = "LATER_ON\\nSAY_IT"\n'
    machine = load_text(shipped_text("i3") + text + '[macros.SAY_IT]\ngcode = "M118 it"\n')
    found = [n.partition(", which")[0] for n in notes(machine) if "neither a command" in n]
    assert found == [
        "macros.SAY, line 1, calls LATER_ON",
        "delayed_gcode.later, line 1, calls FOO",
    ]
