"""Layers of a program: by the comments of slicers, and by heights where there are none."""

from __future__ import annotations

from math import cos, pi, sin

import pytest
from tests.gcode.driver import run


def layers(text: str, surveyed: bool = True, machine: str = "i3") -> tuple[int, list[int]]:
    """The count, and the layer of each move that extrudes along X or Y."""
    out = run(text, machine, surveyed=surveyed)
    assert out.errors == []
    return out.statistics["layers"], [m.layer for m in out.moves if m.kind == "print"]


def square(z: float, lifts: int = 3) -> str:
    """Lines at one height with lifts between them, all relative in E."""
    text = f"G0 Z{z}\n"
    for i in range(lifts):
        text += f"G1 X{10 + i} Y5 E1 F3000\nG1 E-1\nG0 Z{z + 0.4}\nG0 X{i} Y0\nG0 Z{z}\nG1 E1\n"
    return text


HEAD = "G28\nM83\n"


def test_a_lift_between_two_lines_begins_no_layer():
    count, of = layers(HEAD + "".join(square(round(0.2 * i, 3)) for i in (1, 2, 3)))
    assert count == 3
    assert of == [1] * 3 + [2] * 3 + [3] * 3


def test_the_first_layer_may_have_any_height():
    assert layers(HEAD + square(20) + square(20.05))[0] == 2


def test_priming_at_another_height_begins_no_layer():
    assert layers(HEAD + "G0 Z5\nG1 Z0.3 E2\nG1 X5 E1\nG0 Z5\nG1 E4\nG0 Z.3\nG1 X9 E1\n")[0] == 1


def test_a_line_above_the_first_layer_belongs_to_it():
    assert layers(HEAD + "G0 Z.3\nG1 X100 E9\n" + square(0.2) + square(0.4))[0] == 2


def test_each_object_of_a_sequence_has_its_own_layers():
    count, of = layers(HEAD + 2 * (square(0.2, 1) + square(0.4, 1)))
    assert (count, of) == (4, [1, 2, 3, 4])


@pytest.mark.parametrize("height", [0.1, 0.2, 0.35])
def test_a_spiral_has_a_layer_for_each_turn(height):
    text = HEAD + square(height) + square(2 * height)
    turns, chords = 20, 50
    for i in range(1, turns * chords + 1):
        a, z = 2 * pi * i / chords, 2 * height + height * i / chords
        text += f"G1 X{50 + 20 * cos(a):.3f} Y{50 + 20 * sin(a):.3f} Z{z:.3f} E.05\n"
    assert layers(text)[0] == 2 + turns


def test_the_offset_of_a_tool_begins_no_layer():
    head = "G28\nM83\nM218 T1 X0 Y0 Z-0.6\n"
    each = "T0\nG0 Z{z}\nG1 X30 E1\nT1\nG1 X60 E1\nT0\n"
    text = head + "".join(each.format(z=z) for z in (1.0, 1.2, 1.4))
    count, of = layers(text, machine="dual-extruder")
    assert (count, of) == (3, [1, 1, 2, 2, 3, 3])


def test_a_file_without_extrusion_has_no_layers():
    assert layers("G28\nG0 X50\nG0 Z5\nG0 X9\n") == (0, [])


MARKS = [
    ";LAYER:{i}",
    ";LAYER_CHANGE",
    "; CHANGE_LAYER",
    "; layer {i}, Z = 0.2",
    ";layer:0.{i}",
]


@pytest.mark.parametrize("mark", MARKS)
def test_the_comments_of_slicers_count_and_heights_do_not(mark):
    text = HEAD + "G0 Z.3\nG1 X9 E1\n"  # before the first mark: layer 0
    text += "".join(mark.format(i=i) + "\n" + square(0.2, 1) + square(0.25, 1) for i in range(4))
    assert layers(text) == (4, [0, 1, 1, 2, 2, 3, 3, 4, 4])


@pytest.mark.parametrize(
    "comment",
    ["LAYER_COUNT:71", " layer end", " layer_height = 0.2", "BEFORE_LAYER_CHANGE", "LAYER:wall"],
)
def test_unrelated_layer_comments_mark_no_layer(comment):
    assert layers(f"{HEAD};{comment}\n{square(0.2)};{comment}\n{square(0.4)};{comment}\n")[0] == 2


def test_of_two_kinds_of_comments_the_more_frequent_counts():
    each = ";LAYER_CHANGE\n;LAYER:{i}\n"
    text = HEAD + "; layer 0 is the raft\n"
    text += "".join(each.format(i=i) + square(0.2 + 0.2 * i, 1) for i in range(3))
    assert layers(text) == (3, [1, 2, 3])


def test_without_a_survey_the_first_comment_decides():
    """As from a pipe, which is read once."""
    text = HEAD + square(0.3, 1) + "".join(f";LAYER_CHANGE\n;LAYER:{i}\n" for i in range(3))
    assert layers(text + square(0.4, 1), surveyed=False) == (3, [1, 3])
