"""Commands are declared once, and each that acts on a console has its handler."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

import passo
from passo.gcode.registry import Declaration, Kind, Subject, When, declare, row_of, table
from passo.library import command_modules


@pytest.fixture(scope="module")
def printer():
    with Scenario("i3") as s:
        yield s.printer


def test_modules_that_declare_commands_are_listed():
    package = Path(passo.__file__).parent
    declares = re.compile(r"^ *(@command|declare|_declare)\($", re.MULTILINE)
    found = {
        ".".join(path.relative_to(package.parent).with_suffix("").parts)
        for path in package.rglob("*.py")
        if declares.search(path.read_text(encoding="utf-8")) and path.stem != "registry"
    }
    assert found == {module.__name__ for module in command_modules.MODULES}


def test_a_command_is_declared_once():
    with pytest.raises(ValueError, match="M104 is declared twice"):
        declare(Declaration("M104", Subject.HEATERS, When.PLANNED, ""))
    row = row_of("M104")
    assert row is not None and row.usage == "S(°C) I(0 to 2) T P F"


def test_lookup_finds_commands_of_modules_not_imported_yet():
    code = (
        "from passo.gcode.registry import row_of; found = row_of('M23');"
        "print(found.kind.value, row_of('M0').kind.value, row_of('G1.1'))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "served user None\n"


def test_every_immediate_command_has_a_handler(printer):
    immediate = {r.code for r in table().values() if r.when in (When.IMMEDIATE, When.AHEAD)}
    without_part = {r.code for r in table().values() if r.lacks and not printer.dispatch.has(r)}
    assert immediate - without_part == set(printer.dispatch.immediate)


def test_planned_handlers_of_immediate_commands_are_for_programs(printer):
    """In a program, or after another command of a line, these act in their place."""
    planned = {code for code in printer.dispatch.planned if code in printer.dispatch.immediate}
    assert planned == {"M112", "M145", "M220", "M221", "M290", "M410", "SET_GCODE_OFFSET"}


def test_commands_that_wait_in_a_file_stop_the_machine():
    assert [r.code for r in table().values() if r.in_turn] == [
        "M25",
        "M112",
        "M404",
        "M405",
        "M406",
        "M410",
        "M412",
        "M524",
        "M591",
        "CANCEL_PRINT",
        "DISABLE_FILAMENT_WIDTH_LOG",
        "DISABLE_FILAMENT_WIDTH_SENSOR",
        "ENABLE_FILAMENT_WIDTH_LOG",
        "ENABLE_FILAMENT_WIDTH_SENSOR",
        "FIRMWARE_RESTART",
        "PAUSE",
        "RESET_FILAMENT_WIDTH_SENSOR",
        "RESTART",
        "SET_FILAMENT_SENSOR",
    ]


def test_halted_printer_refuses_what_changes_plan_or_heat(printer):
    refused = {r.code for r in table().values() if not r.while_halted}
    assert refused == {"M220", "M221", "M290", "M922", "SET_GCODE_OFFSET"}
    assert not any(printer.dispatch.answers_halted(code) for code in (*refused, "M104", "G1"))
    assert all(printer.dispatch.answers_halted(code) for code in ("M105", "M999", "M115"))


@pytest.mark.parametrize(
    "code",
    [r.code for r in table().values() if r.kind is not Kind.MOTION and re.match(r"[GM]\d", r.code)],
)
def test_no_row_is_unknown_to_a_console(code):
    if code in ("M112", "M0", "M1", "M303", "M600", "M601", "M226", "M2", "M30"):
        return
    with Scenario("i3") as s:
        answer = s.host.ok(code, 60)
        assert not any("Unknown command" in line for line in answer)


SPELLINGS = {
    "measure one place": "G30 PROBE",
    "trigger height": "PROBE_CALIBRATE MANUAL_PROBE TESTZ ACCEPT ABORT",
    "points": "G32 SET_PROBE_POINT",
    "mesh": "G29 BED_MESH_CALIBRATE M557",
    "on, off, show, fade": "M420 M561 M376 M937 BED_MESH_CLEAR BED_MESH_OUTPUT BED_MESH_MAP",
    "stored meshes": "BED_MESH_PROFILE M374 M375",
    "one point of the mesh": "M421 G42",
    "repeatability": "M48 PROBE_ACCURACY",
    "probing moves": "G38.2 G38.3 G38.4 G38.5",
    "probe": "M401 M402 ATTACH_PROBE DETACH_PROBE M119 QUERY_PROBE BLTOUCH_DEBUG M558",
    "offsets": "M851 G31 SET_GCODE_OFFSET M290 Z_OFFSET_APPLY_PROBE Z_OFFSET_APPLY_ENDSTOP",
    "delta": "G33 DELTA_CALIBRATE DELTA_ANALYZE M665 M666",
    "motors of Z": "G34 Z_TILT_ADJUST QUAD_GANTRY_LEVEL M666",
    "screws": "G35 SCREWS_TILT_CALCULATE BED_SCREWS_ADJUST ADJUSTED",
    "skew": "M852 SET_SKEW SKEW_PROFILE GET_CURRENT_SKEW CALC_MEASURED_SKEW",
    "motors and moves": "FORCE_MOVE STEPPER_BUZZ MOVE_TO SET_MOVE SET_KINEMATIC_POSITION",
}


def test_every_spelling_of_levelling_has_a_handler():
    """Those of Marlin, RepRapFirmware, APrinter and Klipper, on machines that have the part."""
    handled = set[str]()
    for machine in ("i3-probe", "i3-two-z", "delta-probe"):
        with Scenario(machine) as s:
            handled |= s.printer.dispatch.planned.keys() | s.printer.dispatch.immediate.keys()
    wanted = {"G1 H1", "G1 H2", "G1 A", *" ".join(SPELLINGS.values()).split()}
    assert sorted(wanted - handled) == []
    assert all(row_of(name).text for name in wanted)
    assert row_of("BED_MESH_OFFSET").kind is Kind.NOT_BUILT
