"""Macros see without a printer what they see on it: `passo print` and `passo estimate` end at the
line of the print, with its words."""

from __future__ import annotations

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

import passo
from passo.errors import PassoError

OBJECTS = """\
EXCLUDE_OBJECT_DEFINE NAME=cube CENTER=30,30 POLYGON=[[20,20],[40,20],[40,40]]
EXCLUDE_OBJECT_DEFINE NAME=cone CENTER=80.5,30 POLYGON=[[70,20],[90,20]]
"""
START = "G28\nM109 S200\n"
SEEN = {  # expressions of a macro, the lines before it, and what it sees
    "objects": (
        "{ printer.exclude_object.objects|map(attribute='polygon')|sum(start=[])|join(' ') }"
        " { printer.exclude_object.objects[1].center }"
        " { printer.exclude_object.excluded_objects }",
        OBJECTS,
        "[20.0, 20.0] [40.0, 20.0] [40.0, 40.0] [70.0, 20.0] [90.0, 20.0] [80.5, 30.0] []",
    ),
    "print": (
        "{ printer.print_stats.state } { printer.print_stats.filename }"
        " { printer.idle_timeout.state } { printer.virtual_sdcard.is_active }"
        " { printer.pause_resume.is_paused } { printer.virtual_sdcard.file_size }",
        "G28\n",
        "printing a.gcode Printing True False 9",
    ),
    "cold hotend": (
        "{ printer.extruder.can_extrude } { printer.extruder.target }"
        " { printer.toolhead.homed_axes }",
        "G28\nM104 S200\nM400\n",
        "False 200.0 xyz",
    ),
    "warm hotend": (
        "{ printer.extruder.can_extrude } { (printer.extruder.temperature - 200)|abs < 5 }",
        START,
        "True True",
    ),
    "offset": (
        "{ printer.gcode_move.homing_origin.z|round(3) }"
        " { printer.gcode_move.position.z|round(3) }",
        "G28\nM290 Z0.05\nSET_GCODE_OFFSET Z=0.1\nG1 Z5 F600\n",
        "0.1 5.1",
    ),
    "bed": (
        "{ printer.bed_mesh.profile_name == '' } { printer.bed_mesh.profiles }"
        " { printer.probe.name } { printer.probe.last_z_result }",
        "G28\n",
        "True {} probe 0.0",
    ),
    "boards": ("{ 'mcu' in printer } { printer.mcu.mcu_constants.CLOCK_FREQ }", "", "True"),
}
MEASURED = (
    "{ printer.bed_mesh.profile_name } { printer.bed_mesh.mesh_matrix|length }"
    " { printer.bed_mesh.mesh_max }"
    " { printer.bed_mesh.probed_matrix[0][0]|round(2) }"
)


def raising(text):
    """A template that fails with this text."""
    return "{% set text %}" + text + "{% endset %}{ action_raise_error(text) }"


def ends_live(machine, folder):
    """Where and why the print from the card stops, by the line that clients of Klipper send."""
    with Scenario(machine, card=str(folder)) as s:
        s.host.ok("SDCARD_PRINT_FILE FILENAME=a.gcode")
        told = s.host.expect("^echo:Print of a.gcode stopped: a.gcode:", 900)
    return told.partition("stopped: ")[2].partition(" The macro has")[0]


def ends_offline(run, path):
    """Where and why a print without a printer ends."""
    with pytest.raises(PassoError) as caught:
        run(path)
    (problem,) = caught.value.problems
    return f"a.gcode:{problem.line}: {problem.sentence}."


@pytest.mark.parametrize(("gcode", "before", "seen"), SEEN.values(), ids=SEEN)
def test_macros_see_offline_what_they_see_live(tmp_path, gcode, before, seen):
    machine = with_macros(macro("LOOK", raising(gcode)), "i3-probe")
    path = tmp_path / "a.gcode"
    path.write_text(before + "LOOK\n")
    offline = passo.Machine(machine)
    live = ends_live(machine, tmp_path)
    assert seen in live
    assert live.startswith(f"a.gcode:{before.count(chr(10)) + 1}: ")
    assert ends_offline(offline.print, path) == live
    assert ends_offline(offline.estimate, path) == live


def test_macros_see_the_measured_mesh_in_a_print(tmp_path):
    machine = with_macros(macro("LOOK", raising(MEASURED)), "i3-probe")
    path = tmp_path / "a.gcode"
    path.write_text("G28\nBED_MESH_CALIBRATE PROFILE=one\nLOOK\n")
    live = ends_live(machine, tmp_path)
    assert live.startswith("a.gcode:3: macro LOOK: one ")
    assert ends_offline(passo.Machine(machine).print, path) == live


def test_macros_between_moves_do_not_delay_the_board(tmp_path):
    machine = with_macros(macro("LOOK", "M117 {printer.extruder.temperature}"), "i3-probe")
    path = tmp_path / "a.gcode"
    moves = [f"G1 X{i / 10} F9000\n" for i in range(1800)]
    path.write_text("G28\n" + "".join(m + "LOOK\n" * (i % 600 == 599) for i, m in enumerate(moves)))
    offline = passo.Machine(machine)
    assert offline.print(path).final_position_mm["x"] == 179.9
    assert offline.estimate(path).moves >= 1799
