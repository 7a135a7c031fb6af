"""An eddy current probe stops a descent at a frequency, and measures the height at standstill."""

import re

import pytest
from tests.support.eddy_machine import bed_mm, eddy_machine, eddy_text, hertz
from tests.support.edited_machine import answers, at_home
from tests.support.scenario import Scenario

from passo.config.load import load_text
from passo.errors import ConfigError
from passo.printer.setup.simulated_world import simulated_bed

_EXACT_MM = 0.002


def probed(s, x, y, more=""):
    dx, dy = s.machine.probe.offset_mm
    s.host.ok(f"G1 X{x - dx} Y{y - dy} Z10 F6000", 60)
    (line,) = answers(s, f"PROBE{more}")
    return float(re.search(r"z=(-?[0-9.]+)", line)[1])


def test_eddy_probe_homes_z_and_measures_the_bed():
    with at_home(eddy_machine()) as s:
        assert s.host.ok("M114")[0].startswith("X:150.000 Y:105.000 Z:10.000 ")
        for x, y in ((40, 40), (125, 110), (200, 180)):
            assert probed(s, x, y) == pytest.approx(bed_mm(s.machine, x, y), abs=_EXACT_MM)
        assert answers(s, "QUERY_PROBE") == ["// probe: open"]
        s.host.ok("G1 X100 Y100 Z1 F600", 60)
        assert answers(s, "QUERY_PROBE") == ["// probe: TRIGGERED"]


def test_height_of_m851_moves_what_the_probe_measures():
    with at_home(eddy_machine()) as s:
        before = probed(s, 100, 100)
        s.host.ok("M851 Z-2.1")
        # The zero of Z moves with the height, so the bed stays where it is.
        assert probed(s, 100, 100) == pytest.approx(before, abs=_EXACT_MM)
        assert s.host.ok("M851")[0].endswith("Z-2.1 ; (mm)")


def gap_mm(s):
    """The height of the nozzle above the simulated bed at the probe."""
    x, y, z = (s.positions()[axis] for axis in "xyz")
    dx, dy = s.machine.probe.offset_mm
    return z - simulated_bed(s.machine).shape.height(x + dx, y + dy)


@pytest.mark.parametrize("celsius", [25.0, 45.0])
def test_warm_coil_brings_the_zero_nearer_to_the_bed(celsius):
    machine = load_text(eddy_text() + f"\n[simulated.probe]\ncoil_c = {celsius}\n")
    with at_home(machine) as s:
        # 20 °C are 40 ppm, or 129 Hz; at 2 mm a millimetre is 12.5 kHz.
        drift = 2e-6 * (celsius - 25) * hertz(2.0) / (hertz(1.5) - hertz(2.5))
        assert gap_mm(s) == pytest.approx(10.0 - drift, abs=_EXACT_MM)


@pytest.mark.parametrize(
    ("fault", "says"),
    [("open", "it reports an error of its coil"), ("silent", "its status cannot be read over I2C")],
)
def test_fault_in_a_descent_stops_the_nozzle(fault, says):
    with at_home(eddy_machine()) as s:
        s.host.ok("G1 X100 Y100 Z10 F6000", 60)
        s.host.send("PROBE")
        while s.positions()["z"] > 6:
            s.passes(0.05)
        s.board.break_coil("probe", open_coil=fault == "open", silent=fault == "silent")
        lowest = []
        for _ in range(100):
            s.passes(0.02)
            lowest.append(s.positions()["z"])
        s.host.expect("^ok", 60)
        (reply,) = (line for line in s.host.heard if "cannot be used" in line)
        assert says in reply and "head" in reply
        assert s.positions()["z"] > 10.0  # lifted again; the axes are still homed
        assert min(lowest) > 5.0


@pytest.mark.parametrize("method", ["scan", "rapid_scan"])
def test_scan_measures_the_mesh_without_descents(method):
    with at_home(eddy_machine()) as s:
        start = s.loop.time()
        s.host.ok(f"BED_MESH_CALIBRATE METHOD={method} PROBE_COUNT=7,6", 300)
        took = s.loop.time() - start
        mesh = s.printer.levelling.bed.status().mesh
        assert (len(mesh.xs), len(mesh.ys)) == (7, 6)
        errors = [
            mesh.heights[j][i] - bed_mm(s.machine, x, y)
            for j, y in enumerate(mesh.ys)
            for i, x in enumerate(mesh.xs)
        ]
        assert max(map(abs, errors)) < 0.002
        # 42 descents take 5 minutes. The way is 1.5 m, and a stop takes a quarter of a second.
        assert took < (40 if method == "scan" else 30)


def test_calibration_by_the_paper_test_is_stored(tmp_path):
    machine = load_text(eddy_text("", homes_z=False))
    with at_home(machine, state=str(tmp_path)) as s:
        s.host.ok("G1 X100 Y100 Z5 F6000", 60)
        s.host.ok("LDC_CALIBRATE_DRIVE_CURRENT CHIP=eddy", 30)
        assert "reg_drive_current: 15" in "".join(s.host.heard)
        assert answers(s, "PROBE_EDDY_CURRENT_CALIBRATE CHIP=other")[0].startswith("echo:CHIP")
        s.host.ok("PROBE_EDDY_CURRENT_CALIBRATE CHIP=eddy", 60)
        # The paper touches where the nozzle is; the coil measures from the bed at the same place.
        paper = round(simulated_bed(s.machine).shape.height(100, 100), 4)
        s.host.ok(f"TESTZ Z={paper - 5}", 60)
        s.host.ok("ACCEPT", 200)
        found = {p.mm: p.hz for p in s.printer.motion.prober.gauge.points}
        assert len(found) == 41
        for mm in (0.05, 1.05, 2.05, 3.05):
            slope = (hertz(mm) - hertz(mm + 0.1)) / 0.1
            assert abs(found[mm] - hertz(mm)) / slope < 0.004  # a step is 0.0025 mm
        assert probed(s, 60, 60) == pytest.approx(
            simulated_bed(s.machine).shape.height(60, 60), abs=0.006
        )
        s.host.ok("M500", 10)
    with at_home(machine, state=str(tmp_path)) as s:
        assert {p.mm: p.hz for p in s.printer.motion.prober.gauge.points} == found
        assert probed(s, 60, 60) == pytest.approx(
            simulated_bed(s.machine).shape.height(60, 60), abs=0.006
        )


def test_probe_scans_where_it_is():
    with at_home(eddy_machine()) as s:
        s.host.ok("G1 X100 Y100 Z3 F6000", 60)
        (line,) = answers(s, "PROBE METHOD=scan")
        height = float(re.search(r"z=(-?[0-9.]+)", line)[1])
        assert height == pytest.approx(bed_mm(s.machine, 75, 105), abs=_EXACT_MM)
        assert s.host.ok("M114")[0].startswith("X:100.000 Y:100.000 Z:3.000 ")


def test_stop_in_a_scan_lifts_the_nozzle():
    with at_home(eddy_machine()) as s:
        s.host.send("BED_MESH_CALIBRATE METHOD=rapid_scan PROBE_COUNT=7,6")
        s.passes(12.0)
        s.host.send("M410")
        s.passes(5.0)
        assert s.positions()["z"] > 9.0 and not s.printer.state.halted
        assert s.printer.levelling.bed.status().mesh is None


def test_chip_without_an_answer_is_named():
    with at_home(eddy_machine()) as s:
        s.host.ok("SIMULATE_FAULT NAME=probe-coil VALUE=silent")
        (line,) = answers(s, "QUERY_PROBE")
        assert "0x2a" in line and "gpio1 and gpio2 (board head)" in line


def test_probe_without_a_calibration_does_not_move():
    with Scenario(eddy_machine("")) as s:
        replies = s.host.ok("G28", 60)
        assert any("has no calibration" in line for line in replies)


def test_passos_firmware_is_refused():
    text = eddy_text().replace("head:gpio1", "D32").replace("head:gpio2", "D47")
    with pytest.raises(ConfigError) as caught:
        load_text(text)
    (problem,) = caught.value.problems
    assert "Keep Klipper's firmware on the main board" in str(problem)


@pytest.mark.parametrize(
    ("calibration", "key"),
    [
        ("calibration = [{ mm = 0.5, hz = 3.2e6 }, { mm = 3.0, hz = 3.1e6 }]", "calibration"),
        (
            "calibration = [{ mm = 0.5, hz = 3.2e6 }, { mm = 1.0, hz = 3.1e6 },"
            " { mm = 1.9, hz = 3.0e6 }]",
            "trigger_height_mm",
        ),
    ],
)
def test_calibration_has_the_height_of_the_trigger(calibration, key):
    with pytest.raises(ConfigError) as caught:
        eddy_machine(calibration)
    assert any(f"probe.{key}" in str(problem) for problem in caught.value.problems)
