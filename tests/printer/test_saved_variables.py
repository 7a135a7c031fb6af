"""SAVE_VARIABLE: variables that macros have again after a restart of the program."""

from __future__ import annotations

import asyncio
import json

import pytest
from tests.support.macro_machine import macro, with_macros

import passo
from passo.errors import CommandError
from passo.events import Message, RemoteCall

SHOW = "M118 {printer.save_variables.variables.z|default('none')}"


def on_printer(test, state=None, gcode=SHOW, machine=None):
    """Runs a test with a printer that has the macro SHOW; the result has what it told."""
    told: list[object] = []

    async def main():
        shown = machine or with_macros(macro("SHOW", gcode))
        async with passo.Printer(passo.Machine(shown), state=state) as printer:
            printer.on_event(told.append)
            await test(printer)
            await asyncio.sleep(0.5)

    passo.run(main(), clock="virtual")
    return told


def test_saved_variables_survive_a_restart_of_the_program(tmp_path):
    async def save(printer):
        await printer.send("SAVE_VARIABLE VARIABLE=z VALUE=\"{'a': [1, 2.5], 'b': 'text'}\"")
        await printer.send("SAVE_VARIABLE VARIABLE=y VALUE=[1,2]")

    async def show(printer):
        await printer.send("SHOW")
        assert printer.status.saved_variables["y"] == [1, 2]

    on_printer(save, str(tmp_path))
    told = on_printer(show, str(tmp_path))
    assert Message("{'a': [1, 2.5], 'b': 'text'}") in told


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("SAVE_VARIABLE VARIABLE=Z VALUE=1", "VARIABLE is Z: expected a name of small letters"),
        ("SAVE_VARIABLE VARIABLE=z", "needs VALUE"),
        ("SAVE_VARIABLE VARIABLE=z VALUE=open", "variable z: 'open' is not a value"),
        ("SAVE_VARIABLE VARIABLE=z VALUE=1e999", "variable z: '1e999' is not a value"),
    ],
)
def test_variable_that_cannot_be_saved_is_refused(tmp_path, line, reason):
    async def test(printer):
        with pytest.raises(CommandError) as refused:
            await printer.send(line)
        assert reason in str(refused.value)
        assert printer.status.saved_variables == {}

    on_printer(test, str(tmp_path))
    assert not (tmp_path / "variables.json").exists()


def test_damaged_variables_are_named_and_left_as_they_are(tmp_path):
    file = tmp_path / "variables.json"
    file.write_text('{"z": 1')

    async def test(printer):
        with pytest.raises(CommandError, match=r"variables\.json.*damaged"):
            await printer.send("SAVE_VARIABLE VARIABLE=z VALUE=2")

    told = on_printer(test, str(tmp_path))
    assert any(isinstance(one, Message) and "damaged" in one.text for one in told)
    assert file.read_text() == '{"z": 1'


def test_variable_is_on_the_disk_when_the_command_is_answered(tmp_path):
    async def test(printer):
        await printer.send("SAVE_VARIABLE VARIABLE=z VALUE=7")
        assert json.loads((tmp_path / "variables.json").read_text()) == {"z": 7}

    on_printer(test, str(tmp_path))


def test_variables_need_a_folder():
    async def test(printer):
        with pytest.raises(CommandError, match="no place to store settings"):
            await printer.send("SAVE_VARIABLE VARIABLE=z VALUE=2")

    on_printer(test)


def test_clients_get_variables_in_the_form_of_json():
    async def test(printer):
        await printer.send("SET_GCODE_VARIABLE MACRO=SHOW VARIABLE=x VALUE=\"{1:None,2:'PETG'}\"")
        assert printer.status.macros["SHOW"] == {
            "corner": [10, 20],
            "x": {"1": None, "2": "PETG"},
        }

    machine = with_macros(macro("SHOW", "", literals="""{ x = "None", corner = "(10, 20)" }"""))
    on_printer(test, machine=machine)


def test_planned_program_has_its_variables_for_itself(tmp_path):
    file = tmp_path / "a.gcode"
    file.write_text("SAVE_VARIABLE VARIABLE=z VALUE=30\nG28\nGO\n")
    gcode = "{% if printer.save_variables.variables.z != 30 %}{action_raise_error('z')}{% endif %}"
    result = passo.Machine(with_macros(macro("GO", gcode))).print(str(file))
    assert not result.warnings


def test_macro_calls_a_remote_method():
    async def test(printer):
        await printer.send("SHOW")

    call = "{action_call_remote_method('frame', n=1, names=['a'])}"
    told = on_printer(test, gcode=call)
    assert RemoteCall("frame", {"n": 1, "names": ["a"]}) in told
