"""The commands that are told of a line are those that the interpreter hands out."""

import random
import re

import pytest

from passo import _core, config
from passo.gcode.dialect import BY_CODE, Kind
from passo.learn.line import read_line
from passo.printer.words import Command

MOTION = {code for code, row in BY_CODE.items() if row.kind is Kind.MOTION and code != "T"}
PIECES = """X5|Y3.5|Z1|E1|F600|S3|S200|P2|p5|I2|R2|L|q|G1|G28|G 4|G17|G54|G80|G90|G91|m84|M1|M104
M106|M2.0|M3.5|M400|M862.3|M0 Click|M117 hi M3|M600 X1|T0|T1|T1.5|N5|foo|_do it|SET_X A=1|(a G1 X2)
((b) M3)|; M5""".replace("\n", "|").split("|")


def handed_out(machine, line):
    """Codes in their order; None where the line is an error."""
    job = _core.Job(machine.core_spec(), False)
    job.feed(line.encode() + b"\n")
    job.finish()
    codes = []
    while (found := job.advance()) != _core.JobStatus.END:
        if found == _core.JobStatus.ERROR:
            return None
        if found == _core.JobStatus.EVENT:
            command = Command(*job.event)
            codes.append("S" if command.letter == "S" else command.code)
    return [code for code in codes if code not in MOTION]


def told(machine, line):
    """The same of what is told; a laser's power in a move is handed out by itself."""
    codes = []
    for command in read_line(line, machine).commands:
        moves = command.code in ("", "G0", "G1", "G2", "G3")
        if moves and any(re.match(r"S\d", word) for word in command.words):
            codes.append("S")
        if command.code and command.code not in MOTION:
            codes.append("S" if re.match(r"S\d", command.code) else command.code)
    return codes


@pytest.mark.parametrize("name", ["i3", "dual-extruder"])
def test_random_lines(name):
    machine, chance, good = config.load(name), random.Random(4), 0
    for _ in range(1000):
        line = chance.choice(("", " ")).join(chance.choices(PIECES, k=chance.randint(1, 6)))
        codes = handed_out(machine, line)
        if codes is not None:
            good += 1
            assert told(machine, line) == codes, line
    assert good > 500
