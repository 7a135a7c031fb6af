"""`--out-of-range` and `--missing-tool`: what a print leaves out or moves to the limit."""

from __future__ import annotations

import json

import pytest
from tests.support.print_result import printed
from tests.support.scenario import Scenario

from passo.cli.main import main


def test_options_of_print_become_policies(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("T5\nG1 X300 F3000\nM0\nM0\nG777\n")
    words = ["--out-of-range", "clamp", "--missing-tool", "ignore"]
    result = printed(capsys, str(path), *words)
    assert result["final_position_mm"]["x"] == 250.0
    assert [w.partition(": ")[2] for w in result["warnings"]] == [
        "G777 is unknown and was skipped (1 time)",
        "M0 waits for the user; without a console it took no time (2 times)",
        "tool T5 does not exist and was ignored (1 time)",
        "X 300.000 mm is beyond the limit of 250.000 mm; such targets were moved to the limit"
        " (1 time)",
    ]
    assert main(["estimate", str(path), "--assume-ready", "--json", *words]) == 0
    estimate = json.loads(capsys.readouterr().out)
    assert estimate["warnings"] == result["warnings"]
    assert estimate["moving_s"] == result["move_time_s"] > 0
    for lacking in (words[:2], words[2:]):
        assert main(["estimate", str(path), "--assume-ready", *lacking]) == 4


def test_clamp_is_reported_once_for_each_axis(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G1 X9 F3000\nG1 X260\nG1 Y-5 X270\nG1 Y-1 X280\nG1 X300 E1\n")
    assert printed(capsys, str(path), "--out-of-range", "clamp")["warnings"] == [
        f"{path}:2: X 260.000 mm is beyond the limit of 250.000 mm;"
        " such targets were moved to the limit (4 times)",
        f"{path}:3: Y -5.000 mm is beyond the limit of 0.000 mm;"
        " such targets were moved to the limit (2 times)",
    ]


def test_unreachable_target_is_reported_with_its_value(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nG1 Z100 F3000\nG1 X70 Y40\nG1 X0 Y80\nG1 X-54 Y-54 E1\n")
    words = [str(path), "--machine", "delta"]
    # Straight from the middle, tried every 2 mm.
    where = "the point X 66.585, Y 38.049, Z 100.000 mm cannot be reached by this machine"
    measure = "it is 76.690 mm from the middle (limit 75.100 mm)"
    assert main(["print", *words, "--assume-ready"]) == 4
    assert f"{path}:3: {where}: {measure}. Move the model" in capsys.readouterr().err
    assert printed(capsys, *words, "--out-of-range", "clamp")["warnings"] == [
        f"{path}:4: Y 80.000 mm is beyond the limit of 75.100 mm; such targets were moved to the"
        " limit (1 time)",
        f"{path}:3: {where}: {measure}; such moves were left out (2 times)",
    ]


def test_retraction_after_skipped_move_stays_in_place(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G92 X0 Y0 Z50\nM83\nG1 X20 F3000\nG1 X74 Y74 Z160\nG1 E2 F300\n")
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    # The towers stand where the point (20, 0, 50) has them, as without the move out of reach.
    path.write_text("G92 X0 Y0 Z50\nM83\nG1 X20 F3000\nG1 E2 F300\n")
    assert result["final_steps"] == printed(capsys, str(path), "--machine", "delta")["final_steps"]


@pytest.mark.parametrize("lines", ["G4 P10", "M83\nG1 Y-74 E-1\nG4 P10\nG1 E1"])
def test_dwell_after_skipped_move_stays_in_place(capsys, tmp_path, lines):
    path = tmp_path / "p.gcode"
    path.write_text(f"G1 X20 F3000\nG1 X68 Y89\n{lines}\nG90\nG1 X13 Y-36\n")
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    path.write_text("G1 X20 F3000\nG1 X13 Y-36\n")
    assert result["final_steps"] == printed(capsys, str(path), "--machine", "delta")["final_steps"]


@pytest.mark.parametrize("mode", ["M83", "M82"])
def test_filament_of_a_move_that_was_left_out_is_left_out(capsys, tmp_path, mode):
    """The next move does not print it too, whichever way E is counted; a retraction is kept."""
    lines = ["G92 X0 Y0 Z50 E0", mode, "G1 X20 F3000 E1", "G1 X74 Y74 Z160 E5"]
    lines += ["G1 X0 E1", "G1 E-1", "G1 E1"] if mode == "M83" else ["G1 X0 E6", "G1 E5", "G1 E6"]
    path = tmp_path / "p.gcode"
    path.write_text("\n".join(lines))
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    assert sum(result["filament_mm"].values()) == pytest.approx(2.0)
    assert result["final_position_mm"]["e"] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("line", "option"), [("G1 X999", "--out-of-range clamp"), ("T7", "--missing-tool ignore")]
)
def test_hint_names_the_option_that_allows_a_print(line, option, capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text(f"{line}\nG1 X1 F600\n")
    assert main(["print", str(path), "--assume-ready"]) == 4
    assert f"or allow {option}." in capsys.readouterr().err
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        refusal = s.host.ok(line)[0]
        assert refusal.startswith("echo:")
        assert "--" not in refusal
