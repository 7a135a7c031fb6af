"""Commands of the probe in a print without consoles: they measure the simulated bed."""

import asyncio

import pytest
from tests.support.eddy_machine import eddy_text

from passo.config.load import load_text, shipped_text
from passo.errors import InputError
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.printer.setup.simulated_world import simulated_bed
from passo.printer.unfit_commands import NOTHING

NOISE = ("noise_mm = 0.002", "")
PRINTED = [
    "G1 X40 Y40 Z5 F9000",
    "G1 Z0.2 F300",
    "G1 X180 Y40 E1 F3000",
    "G1 X180 Y180 E2",
    "G1 X40 Y180 E3",
    "G1 X40 Y40 E4",
]


def machine(name, *changes):
    text = shipped_text(name)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return load_text(text)


PROBED = machine("i3-probe", NOISE)
HOMED_BY_PROBE = machine(
    "i3-probe", NOISE, ('position = 0.0\npin = "^Z_MIN"\nfast = 5.0\nslow = 1.0', "probe = true")
)


@pytest.fixture
def printed(tmp_path):
    def run(lines, of=PROBED, *, checked=True):
        path = tmp_path / "a.gcode"
        path.write_text("\n".join(["M302 S0", *lines, ""]))
        return Print(of, Policy(checked=checked, skips=NOTHING)).run(path)

    return run


def spread(result):
    layer = result.first_layer
    return max(0.2 - layer.lowest_mm, layer.highest_mm - 0.2)


@pytest.mark.parametrize(
    ("start", "limit"),
    [
        (["G28", "G29"], 0.01),
        (["G28 W", "G80"], 0.01),
        (["G28", "G32"], 0.01),
        # Homing keeps the map, and suspends it only.
        (["G28", "G29", "G1 X70 Y90 Z8 F9000", "G28 X", "G28"], 0.01),
        (["G28", "G29", "M420 S0", "G1 X10 F9000", "M420 S1"], 0.01),
    ],
)
def test_first_layer_follows_the_bed_that_the_file_measures(printed, start, limit):
    result = printed([*start, *PRINTED])
    assert spread(result) <= limit
    assert result.warnings == result.errors == []
    assert result.stream_hash == printed([*start, *PRINTED]).stream_hash


@pytest.mark.parametrize("homes_z", [True, False])
def test_eddy_probe_scans_the_bed_before_its_calibration(printed, homes_z):
    # A print without boards uses the calibration of the simulated coil.
    of = load_text(eddy_text("", homes_z=homes_z))
    result = printed(["G28", "BED_MESH_CALIBRATE METHOD=rapid_scan", *PRINTED], of)
    assert spread(result) <= 0.01
    assert result.errors == []


@pytest.mark.parametrize("start", [["G28"], ["G28", "G29", "M420 S0"], ["G28", "G29", "M561"]])
def test_first_layer_without_a_map_has_the_shape_of_the_bed(printed, start):
    assert spread(printed([*start, *PRINTED])) > 0.2


def test_first_layer_follows_the_bed_if_the_probe_homes_z(printed):
    assert spread(printed(["G28", "G29", *PRINTED], HOMED_BY_PROBE)) <= 0.01


def test_second_nozzle_follows_the_bed_below_itself(printed):
    tools = (
        '[steppers.e1]\nsteps_per_mm = 95.5\nsocket = "E1"\n'
        "[extruders.e1]\nspeed_mm_s = 100.0\naccel_mm_s2 = 5000.0\n"
        '[[tools]]\nextruder = "e"\n'
        '[[tools]]\nextruder = "e1"\noffset_mm = [30.0, 0.0, 0.1]\n'
    )
    of = machine("i3-probe", NOISE, ("[limits]", f"{tools}[limits]"))
    lines = ["G1 X60 Y40 Z5 F9000", *PRINTED[1:3], "T1", *PRINTED[3:]]
    assert spread(printed(["G28", "G29", *lines], of)) <= 0.01
    assert spread(printed(["G28", *lines], of)) > 0.2


def test_gantry_is_level_after_the_file_has_levelled_it(printed):
    of = machine("i3-two-z", NOISE)
    askew = printed(["G28", *PRINTED], of).first_layer
    level = printed(["G28", "G34", *PRINTED], of).first_layer
    assert askew.highest_mm - askew.lowest_mm > 0.2
    assert level.highest_mm - level.lowest_mm <= 0.02


def test_delta_prints_flat_after_the_file_has_calibrated_it(printed):
    of = machine("delta-probe", ("noise_mm = 0.01", ""))
    square = ["G1 X-35 Y-30 Z5 F6000", "G1 Z0.2 F600", "G1 X35 E1", "G1 Y30 E2", "G1 X-35 E3"]
    assert spread(printed(["G28", *square], of)) > 0.1
    assert spread(printed(["G28", "G33", "G28", *square], of)) <= 0.02


def test_probing_move_ends_at_the_bed_and_keeps_offsets(printed):
    bed, probe = simulated_bed(PROBED).shape, PROBED.probe
    lines = ["G28", "G1 X60 Y70 Z8 F9000", "G92 X10", "G38.2 Z0 F120", "G92 Z0", "G1 X15 Z3"]
    at = printed(lines).final_position_mm
    dx, dy = probe.offset_mm
    touched_mm = bed.height(60 + dx, 70 + dy) + probe.trigger_height_mm
    assert at["x"] == pytest.approx(65, abs=1e-9)
    assert at["y"] == pytest.approx(70, abs=1e-9)
    assert at["z"] == pytest.approx(3 + touched_mm, abs=0.003)


def test_rest_of_the_macro_that_measures(printed):
    of = load_text(
        shipped_text("i3-probe") + '\n[macros.START]\ngcode = """\nG28\nG29\nG1 X100\n"""'
    )
    assert printed(["START"], of).final_position_mm["x"] == pytest.approx(100)


def test_axes_must_be_homed_before_the_bed_is_measured(printed):
    with pytest.raises(InputError) as caught:
        printed(["G29", *PRINTED])
    (problem,) = caught.value.problems
    assert problem.line == 2
    assert "home" in str(problem).lower()
    # A piece of G-code is for a machine that is homed.
    assert spread(printed(["G29", *PRINTED], checked=False)) <= 0.01


def test_print_stops_where_the_probe_fails(printed):
    of = machine(
        "i3-probe", ("[simulated.bed]", '[simulated.probe]\nstuck = "open"\n[simulated.bed]')
    )
    with pytest.raises(InputError) as caught:
        printed(["G28", "G29", *PRINTED], of)
    assert caught.value.problems[0].line == 3
    assert caught.value.problems[0].code.startswith("probe.")


def test_print_within_an_event_loop_and_for_a_real_board(printed):
    of = machine(
        "i3-probe",
        NOISE,
        ("[board]", '[board]\nlink = "serial"\nport = "/dev/none"\nfirmware = "klipper"'),
    )

    async def run():
        return printed(["G28", "G29", *PRINTED], of)

    assert spread(asyncio.run(run())) <= 0.01
