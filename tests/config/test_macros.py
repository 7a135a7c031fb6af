"""Macros in machine files: names, templates, and what is loaded for them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.support.macro_machine import macro, with_macros

from passo.errors import ConfigError
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print

PAGE = Path(__file__).parents[2] / "docs/how-to/write-a-macro.md"
KEPT = ("G0", "G1", "G3", "M2", "M30", "M98", "M112", "M410", "M108", "M999", "EXCLUDE_OBJECT")


@pytest.mark.parametrize("name", KEPT)
def test_some_commands_cannot_be_replaced_by_macros(name):
    with pytest.raises(ConfigError, match=rf"macros\.{name} is '{name}': expected another name"):
        with_macros(macro(name, "M400", rename_existing='"M9999"'))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (macro("1st", "M400"), "expected a command, such as START_PRINT, M600 or T0"),
        (macro("G028", "M400"), "expected a command, such as START_PRINT"),
        (macro("Foo", "M400") + macro("FOO", "M400"), "a name in another case is the same command"),
        (macro("g28", "M400"), "macros.g28.rename_existing is missing: expected a name for the bu"),
        (macro("G28", "M400"), "macros.G28.rename_existing is missing: expected a name for the bu"),
        (macro("T0", "M400"), "macros.T0.rename_existing is missing"),
        (macro("FOO", "M400", rename_existing='"BAR"'), "no such key: FOO is not built in"),
        (macro("G28", "M400", rename_existing='"HOME"'), "a letter and a number, as G28 is"),
        (macro("G28", "M400", rename_existing='"G4"'), "a name that no other command has"),
        (
            macro("G28", "M400", rename_existing='"G28.1"') + macro('"G28.1"', "M400"),
            "a name that no other command has",
        ),
        (macro("FOO", "G1\n{% if %}"), "macros.FOO.gcode is '{% if %}': expected G-code with exp"),
        (macro("FOO", "{ 'a'|nofilter }"), "line 1 of the template: No filter named 'nofilter'"),
        (macro("FOO", "x" * 65_536), "a template of at most 65,536 characters"),
        (macro("FOO", "x", variables="{A = 1}"), "a name of lower-case letters, digits, _"),
        (
            macro("FOO", "x", literals='{a = "open"}'),
            "is 'open': expected a value in Python's nota",
        ),
        (macro("FOO", "x", literals='{a = "1e999"}'), "macros.FOO.literals.a is '1e999'"),
        (macro("FOO", "x", literals='{a = "' + "[" * 3000 + '"}'), "macros.FOO.literals.a is"),
        (
            macro("FOO", "x", variables="{a = 1}", literals='{a = "None"}'),
            "another name: variables has it too",
        ),
        ("[delayed_gcode.one]\ngcode = '{'", "delayed_gcode.one.gcode is '{': expected G-code"),
    ],
)
def test_invalid_macros_are_refused(text, told):
    with pytest.raises(ConfigError, match=re.escape(told)):
        with_macros(text)


def test_the_core_gets_macros_and_what_they_replace():
    text = macro("G28", "G28.1", rename_existing='"G28.1"') + macro("FOO", "M400")
    assert with_macros(text).core_spec()["macros"] == {
        "names": ["G28", "FOO"],
        "built_in": {"G28.1": "G28"},
    }


def test_the_examples_of_the_page_are_printed(tmp_path):
    blocks = re.findall(r"```(\w+)\n(.*?)```", PAGE.read_text(), re.DOTALL)
    tables = "\n".join(text for kind, text in blocks if kind == "toml")
    (call,) = (text for kind, text in blocks if kind == "gcode")
    path = tmp_path / "part.gcode"
    path.write_text(call)
    calls = []
    job = Print(with_macros(tables), Policy(checked=True))
    job.macros.watchers.append(lambda command, text: calls.append((command.code, text.split())))
    job.run(path)
    start = "M140 S50.0 G28 M190 S50.0 G1 X10 Y10 F6000 G1 X15 Y10 F6000"
    assert calls == [("START_PRINT", start.split()), ("G28", ["M117", "homing", "G28.1"])]


def test_a_machine_without_macros_loads_no_templates():
    code = "import sys, passo.library.assembly, passo.config as c; c.load('i3')"
    code += "; print('jinja2' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "False\n"
