"""TUNING_TOWER on a console, and in a file that is printed or only planned."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.printer.commands.tuning_tower import tower_of

LAYERS = [0.2 * i for i in range(1, 31)]


def tower(text: str):
    command = Command(1, "", 0, 0, "TUNING_TOWER", text)
    command.check()
    return tower_of(command)


def values(text: str, heights: list[float]) -> list[float]:
    found = tower(f"COMMAND=M900 PARAMETER=K {text}")
    return [round(found.value(z), 9) for z in heights]


def test_value_grows_with_height():
    assert values("START=0.1 FACTOR=.005", [0.2, 10.0]) == [0.101, 0.15]


def test_tower_band_has_the_value_of_its_middle():
    assert values("FACTOR=0.02 BAND=1", [0.2, 0.8, 1.0, 1.8]) == [0.01, 0.01, 0.03, 0.03]


def test_value_rises_by_steps_above_the_skipped_height():
    text = "START=1500 STEP_DELTA=500 STEP_HEIGHT=0.6 SKIP=0.4"
    assert values(text, [0.2, 0.8, 1.0, 1.6]) == [1500, 1500, 2000, 2500]


@pytest.mark.parametrize(
    "text",
    [
        "COMMAND=M900 FACTOR=1",
        "COMMAND=M900 PARAMETER=K",
        "COMMAND=M900 PARAMETER=K STEP_DELTA=1",
        "COMMAND=M900 PARAMETER=K FACTOR=1 STEP_DELTA=1 STEP_HEIGHT=1",
        "COMMAND=M900 PARAMETER=K FACTOR=x",
        "COMMAND=M900 PARAMETER=K FACTOR=1 BAND=-1",
        "COMMAND=TUNING_TOWER PARAMETER=K FACTOR=1",
    ],
)
def test_incomplete_tower_is_refused(text):
    with pytest.raises(CommandError):
        tower(text)


def layers(before_line=lambda z: ""):
    """A file of two lines a layer, with a hop before each; after the last one the bed again."""
    lines = ["M302 S0", "G92 X0 Y0 Z0 E0", "M83"]
    for z in [*LAYERS, 0.2]:
        lines += [f"G0 Z{z + 0.4:.3f} F6000", f"G0 X10 Y10 Z{z:.3f}", before_line(z)]
        lines += ["G1 X20 E0.5 F3000", "G2 X10 I-5 E0.5"]
    return lines


def test_planned_tower_is_a_file_with_its_values(tmp_path):
    machine = config.load("i3")
    line = "TUNING_TOWER COMMAND=M900 PARAMETER=K FACTOR=0.02 BAND=1"
    found = tower(line.removeprefix("TUNING_TOWER "))

    def by_hand(z):
        ends = z == LAYERS[0] and any(seen)
        seen.append(z)
        return "" if ends else f"M900 K{found.value(z):.9g}"

    seen: list[float] = []
    hashes = []
    for name, text in (("tower", [line, *layers()]), ("by-hand", layers(by_hand))):
        path = tmp_path / name
        path.write_text("\n".join(text) + "\n")
        hashes.append(Print(machine, Policy(checked=False)).run(path).stream_hash)
    assert hashes[0] == hashes[1]


def test_tower_sets_the_value_before_the_first_line_of_a_layer():
    with Scenario("i3") as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M302 S0")
        answer = s.host.ok("TUNING_TOWER COMMAND=M900 PARAMETER=K START=0.01 FACTOR=0.1 BAND=1")
        assert answer[0] == ("Starting tuning test (start=0.010000 factor=0.100000 band=1.000000)")
        s.host.ok("M83")
        seen = []
        for z in (0.2, 0.8, 1.0, 2.2):
            s.host.ok(f"G1 Z{z + 0.4} F6000")
            before = s.host.ok("M900")[0]
            s.host.ok(f"G1 X10 Z{z}")
            s.host.ok("G1 X20 E0.5")
            seen.append((before, s.host.ok("M900")[0]))
            s.host.ok("G1 X10 E0.5")
        assert seen == [
            ("Advance K=0", "Advance K=0.06"),
            ("Advance K=0.06", "Advance K=0.06"),
            ("Advance K=0.06", "Advance K=0.16"),
            ("Advance K=0.16", "Advance K=0.26"),
        ]
        s.host.ok("G1 X10 Z0.1")
        assert "Ending tuning test" in s.host.ok("G1 X20 E0.5")
        s.host.ok("G1 X10 Z3")
        s.host.ok("G1 X20 E0.5")
        assert s.host.ok("M900")[0] == "Advance K=0.26"
