"""Macros in the shapes of Mainsail, Fluidd and KAMP: they take the place of PAUSE, RESUME,
CANCEL_PRINT and BED_MESH_CALIBRATE, park by the ranges of the axes, and prime before the objects.
"""

from __future__ import annotations

from contextlib import ExitStack

import pytest
from tests.support.edited_machine import STILL, edited
from tests.support.macro_machine import macro
from tests.support.scenario import Scenario

OUTLINES = (
    "EXCLUDE_OBJECT_DEFINE NAME=a CENTER=90,90 POLYGON=[[80,84],[100,84],[100,96],[80,96]]\n"
    "EXCLUDE_OBJECT_DEFINE NAME=b CENTER=130,120 POLYGON=[[120,110],[140,110],[140,130]]\n"
)
BOX = """{% set box = namespace(x0=999, y0=999, x1=0, y1=0) %}
{% for object in printer.exclude_object.objects %}{% for x, y in object.polygon %}
{% set box.x0 = [box.x0, x]|min %}{% set box.x1 = [box.x1, x]|max %}
{% set box.y0 = [box.y0, y]|min %}{% set box.y1 = [box.y1, y]|max %}
{% endfor %}{% endfor %}
"""
TUCK = """{% set top = printer.toolhead.axis_maximum %}
{% set z = [[printer.toolhead.position.z + 3, params.LEAST|default(0)|float]|max, top.z]|min %}
_FILAMENT MM=-1.5
{% if "xyz" in printer.toolhead.homed_axes %}
G90
G1 Z{z} F900
G1 X{params.X|default(top.x - 4)} Y{params.Y|default(top.y - 4)} F6000
{% if not printer.gcode_move.absolute_coordinates %}G91{% endif %}
{% endif %}"""
FILAMENT = """{% if printer[printer.toolhead.extruder].can_extrude %}
M83
G1 E{params.MM} F2100
{% if printer.gcode_move.absolute_extrude %}M82{% endif %}
{% endif %}"""
PAUSE = """SET_GCODE_VARIABLE MACRO=RESUME VARIABLE=warm_c VALUE={printer.extruder.target}
PAUSE_BASE
_TUCK {rawparams}"""
RESUME = """{% if printer.idle_timeout.state|upper == "IDLE" %}
M109 S{warm_c}
{% endif %}
{% if printer.idle_timeout.state|upper == "IDLE" or printer.extruder.can_extrude %}
_FILAMENT MM=1.5
RESUME_BASE VELOCITY={printer.configfile.settings.pause_resume.recover_velocity}
{% else %}
RESPOND TYPE=error MSG="too cold to resume"
{% endif %}"""
MESH = (
    BOX
    + """{% set whole = printer.configfile.settings.bed_mesh %}
{% set step_x = (whole.mesh_max[0] - whole.mesh_min[0]) / (whole.probe_count[0] - 1) %}
{% set step_y = (whole.mesh_max[1] - whole.mesh_min[1]) / (whole.probe_count[1] - 1) %}
{% set nx = ((box.x1 - box.x0) / step_x)|round(method='ceil')|int + 1 %}
{% set ny = ((box.y1 - box.y0) / step_y)|round(method='ceil')|int + 1 %}
_WHOLE_MESH mesh_min={box.x0},{box.y0} mesh_max={box.x1},{box.y1} ALGORITHM=lagrange"""
    + " PROBE_COUNT={[nx, 3]|max},{[ny, 3]|max}"
)
PRIME = (
    BOX
    + """SAVE_GCODE_STATE NAME=prime
G92 E0
G90
G0 X{(box.x0 + box.x1) / 2 - 10} Y{box.y0 - 10} F6000
G0 Z0.8
M83
G1 X{(box.x0 + box.x1) / 2 + 10} E20 F144
G1 E-.5 F2100
G92 E0
M82
G0 Z1.6
RESTORE_GCODE_STATE NAME=prime"""
)
NEAR = BOX + "G90\nG0 Z10 F900\nG0 X{box.x0 - 10} Y{box.y0 - 10} F6000"
MACROS = (
    macro("_TUCK", TUCK)
    + macro("_FILAMENT", FILAMENT)
    + macro("PAUSE", PAUSE, rename_existing='"PAUSE_BASE"')
    + macro("RESUME", RESUME, rename_existing='"RESUME_BASE"', variables="{warm_c = 0}")
    + macro(
        "CANCEL_PRINT",
        "_TUCK X=7\nTURN_OFF_HEATERS\nCANCEL_PRINT_BASE",
        rename_existing='"CANCEL_PRINT_BASE"',
    )
    + macro("M600", "PAUSE X=10 Y=12 LEAST=50", rename_existing='"M9600"')
    + macro("BED_MESH_CALIBRATE", MESH, rename_existing='"_WHOLE_MESH"')
    + macro("PRIME", PRIME)
    + macro("NEAR", NEAR)
)
TURNS = "".join(f"G1 X{90 + 20 * (i % 2)} Y{90 + i / 10} E0.5 F1200\n" for i in range(60))
BEGIN = f"{OUTLINES}M109 S200\nG28\n"
PARKED = 246.0, 216.0, 3.6  # 4 mm from the ends of X and Y, 3 mm above the print
NO_PARK = "_TUCK {rawparams}", ""
BROKEN = "PAUSE_BASE\n_TUCK", "PAUSE_BASE\nG1 X9999"
LATE_PARK = "_TUCK X=7\nTURN_OFF_HEATERS\nCANCEL_PRINT_BASE", "CANCEL_PRINT_BASE\n_TUCK X=7"


@pytest.fixture
def served(tmp_path):
    """Starts a print on a printer with these macros, with texts in place of others in them."""
    with ExitStack() as stack:

        def start(program: str, *changes: tuple[str, str]) -> Scenario:
            (tmp_path / "a.g").write_text(program)
            text = MACROS
            for old, new in changes:
                assert old in text
                text = text.replace(old, new)
            machine = edited("i3-probe", STILL, ('"quadratic"', '"mesh"'), more=text)
            s = stack.enter_context(Scenario(machine, card=str(tmp_path)))
            s.host.ok("SDCARD_PRINT_FILE FILENAME=a.g")
            return s

        yield start


@pytest.fixture
def printing(served):
    """The same, in the middle of a file."""

    def start(*changes: tuple[str, str]) -> Scenario:
        s = served(f"{BEGIN}G90\nM83\nG1 Z0.6 F900\nM118 begun\n{TURNS}", *changes)
        s.host.expect("^begun$", 900)
        s.passes(8)
        return s

    return start


def place(s):
    """Where the planned moves end, mm."""
    return tuple(round(s.printer.rig.job.machine_position[i], 2) for i in range(3))


def state(s):
    return s.assembly.services.jobs.runner.state.name


def after(s, line, seconds=15):
    """State and place some time after a line."""
    s.host.ok(line, 300)
    s.passes(seconds)
    return state(s), place(s)


def test_start_measures_the_objects_and_primes_before_them(served):
    steps = "BED_MESH_CALIBRATE\nNEAR\nM400\nM118 near\nG4 S1\nPRIME\nM400\nM118 primed\nG4 S1\n"
    s = served(BEGIN + steps)
    s.host.expect("^near$", 900)
    mesh = s.printer.motion.correction.correction.mesh
    assert (mesh.xs, mesh.ys) == ((80, 110, 140), (84, 107, 130))
    assert s.printer.motion.correction.correction.interpolation == "bilinear"
    assert (s.positions()["x"], s.positions()["y"]) == (70, 74)
    begun = s.positions()["e"]
    s.host.expect("^primed$", 900)
    assert (s.positions()["x"], s.positions()["y"]) == (120, 74)
    assert s.positions()["e"] - begun == pytest.approx(20 - 0.5, abs=0.01)


@pytest.mark.parametrize(("line", "parked"), [("PAUSE", PARKED), ("M600", (10, 12, 50))])
def test_only_the_macros_move_the_nozzle_in_a_pause(printing, line, parked):
    s = printing()
    seen = []
    s.printer.lifetime.as_time_passes(lambda: seen.append(s.positions()))
    assert after(s, line) == ("PAUSED", parked)
    stopped, filament = s.printer.rig.job.stops.position, s.positions()["e"]
    assert max(one["e"] for one in seen) - filament == pytest.approx(1.5, abs=0.02)
    seen.clear()
    s.host.ok("RESUME", 60)
    assert s.until(lambda: state(s) == "PRINTING", 60)
    over = next(
        one for one in seen if abs(one["x"] - stopped[0]) + abs(one["y"] - stopped[1]) < 0.1
    )
    assert over["z"] > stopped[2] + 1  # above the place, and then down
    assert over["e"] - filament == pytest.approx(1.5, abs=0.02)
    s.host.expect("^Done printing file$", 900)
    assert s.positions()["e"] == pytest.approx(60 * 0.5, abs=0.02)
    assert place(s) == (110, 95.9, 0.6)


@pytest.mark.parametrize("change", [NO_PARK, BROKEN])
def test_pause_macro_that_does_not_move_still_parks(printing, change):
    s = printing(change)
    (was, at), top = after(s, "PAUSE"), s.machine.park.raise_mm
    assert (was, at[2]) == ("PAUSED", pytest.approx(0.6 + top))
    assert after(s, "RESUME", 5)[0] == "PRINTING"
    s.host.expect("^Done printing file$", 900)
    assert place(s) == (110, 95.9, 0.6)


@pytest.mark.parametrize("paused", [False, True])
@pytest.mark.parametrize("changes", [(), (LATE_PARK,)])
def test_cancel_macro_parks_before_or_after_the_end(printing, changes, paused):
    s = printing(*changes)
    if paused:
        after(s, "PAUSE")
    at_z = place(s)[2] + 3
    assert after(s, "CANCEL_PRINT") == ("READY", (7, 216, at_z))
    assert s.assembly.services.jobs.runner.ended == "cancelled"
    assert s.printer.rig.connection.heaters["hotend"].target == 0


def test_resume_macro_knows_a_cold_and_an_idle_printer(printing):
    s = printing()
    after(s, "PAUSE")
    s.host.ok("M104 S0")
    s.passes(200)
    assert after(s, "RESUME") == ("PAUSED", PARKED)
    assert "!! too cold to resume" in s.host.heard
    s.host.ok("M104 S200")
    s.passes(200)
    assert after(s, "RESUME", 5)[0] == "PRINTING"
    after(s, "PAUSE")
    s.passes(s.machine.idle.heaters_off_s + 300)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert after(s, "RESUME", 10)[0] == "PRINTING"
    assert s.printer.rig.connection.heaters["hotend"].target == 200
