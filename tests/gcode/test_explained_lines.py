"""What the interpreter tells of a line is what it makes of it."""

import random
import re

import pytest

from passo import _core, config
from passo.gcode.command import Command
from passo.gcode.registry import Kind, table

MOTION = {code for code, row in table().items() if row.kind is Kind.MOTION and code != "T"}
PIECES = """X5|Y3.5|Z1|E1|F600|S3|S200|P2|p5|I2|R2|L|q|G1|G28|G 4|G17|G54|G43 H1|G94|G80|G90|G91
G53|G40|G81 X1|M6|M8
m84|M1|M104|M106|M2.0|M3.5|M400|M862.3|M0 Click|M117 hi M3|M600 X1|T0|T1|T1.5|N5|foo|_do it
SET_X A=1|(a G1 X2)|((b) M3)|; M5""".replace("\n", "|").split("|")


def read(machine, line):
    """The codes handed out, and the commands heard; None where the line is an error."""
    job = _core.Job(machine.core_spec(), False)
    job.program.watch_line(1)
    job.feed(line.encode() + b"\n")
    job.finish()
    codes = []
    while (found := job.advance()) != _core.JobStatus.END:
        if found == _core.JobStatus.ERROR:
            return None
        if found == _core.JobStatus.EVENT:
            command = Command(*job.event)
            codes.append("S" if command.letter == "S" else command.code)
    return (
        [code for code in codes if code not in MOTION],
        job.program.watched_line,
        job.program.commands,
    )


def told(commands):
    """The codes of the same; a laser's power in a move is handed out by itself."""
    codes = []
    for code, words, _ in commands:
        moves = code in ("", "G0", "G1", "G2", "G3")
        if moves and any(re.match(r"S *\d", word) for word in words):
            codes.append("S")
        if code and code not in MOTION:
            codes.append(code)
    return codes


@pytest.mark.parametrize("name", ["i3", "dual-extruder"])
def test_random_lines_are_explained_completely(name):
    machine, chance, good = config.load(name), random.Random(4), 0
    for _ in range(1000):
        line = chance.choice(("", " ")).join(chance.choices(PIECES, k=chance.randint(1, 6)))
        found = read(machine, line)
        if found is not None:
            good += 1
            codes, (_, _, commands), count = found
            assert told(commands) == codes, line
            assert count == len(commands)
    assert good > 500


@pytest.mark.parametrize(
    ("line", "heard"),
    [
        (
            "N7 G1 X5 y.5 F600 (fast) M104 S200 *104",
            (
                "7",
                True,
                [
                    ("G1", ["X5", "y.5", "F600"], "X5 y.5 F600"),
                    ("M104", ["S200"], "S200"),
                ],
            ),
        ),
        ("x1 e.5 ; more", ("", False, [("", ["x1", "e.5"], "")])),
        ("G91 X5", ("", False, [("G91", [], ""), ("", ["X5"], "")])),
        ("G43 H1 Z5", ("", False, [("G43", [], ""), ("", ["H1", "Z5"], "")])),
        ("G43 H1", ("", False, [("G43", ["H1"], "H1")])),
        ("S12000 M3", ("", False, [("M3", ["S12000"], "S12000")])),
        ("M117 Hi  you", ("", False, [("M117", [], "Hi  you")])),
        ("set_fan SPEED=1 A=2", ("", False, [("SET_FAN", [], "SPEED=1 A=2")])),
        ("T0", ("", False, [("T0", [], "")])),
        ("; nothing", ("", False, [])),
    ],
)
def test_watched_line_is_reported(line, heard):
    codes = read(config.load("i3"), line)
    assert codes is not None
    assert codes[1] == heard


def test_words_before_a_command_are_shown_with_it():
    job = _core.Job(config.load("i3").core_spec(), False)
    job.feed(b"P300 G4\n")
    job.finish()
    assert job.advance() == _core.JobStatus.END
    job.flush()
    assert job.results.statistics()["dwell_s"] == 0.3
