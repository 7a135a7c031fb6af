"""Programs on the card that are not as they should be."""

import pytest
from tests.support.scenario import Scenario


def printing(tmp_path, text):
    (tmp_path / "a.g").write_bytes(text)
    scenario = Scenario("i3", card=str(tmp_path))
    scenario.host.ok("G92 X0 Y0 Z0")
    scenario.host.ok("M32 a.g")
    return scenario


@pytest.mark.parametrize(
    "text",
    [
        b"G1 X10 F6000\n;" + b"x" * 10_000 + b"\nG1 X20\n",  # longer than any buffer
        b"; first\r\nG1 X10 F6000\r\n\r\n   \r\nG1 X20\r\n",
        b"G1 X10 F6000 ; there\nG1 X20",  # no end of the last line
        b"%\nN10 G1 X10 F6000\nN20 G1 X20\n",
        b"G999\nG1 X20 F6000\nM123 S4\n",
    ],
)
def test_program_prints_to_its_end(tmp_path, text):
    with printing(tmp_path, text) as s:
        s.host.expect("^Done printing file$", 30)
        assert s.positions()["x"] == 40.0


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (b"G1 X999", "beyond the limit"),
        (b"G1 Xabc", "no valid number"),
        (b"G1 E5", "cold extrusion"),
        (b"T7", "does not exist"),
    ],
)
def test_program_stops_at_failed_command_and_continues(tmp_path, line, said):
    with printing(tmp_path, b"G1 X10 F6000\n" + line + b"\nG1 X20\n") as s:
        s.host.expect(said, 10)
        s.passes(3)
        assert s.positions()["x"] == 30.0
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 30)
        assert s.positions()["x"] == 40.0


def test_m2_ends_the_program(tmp_path):
    with printing(tmp_path, b"G1 X10 F6000\nM2\nG1 X20\n") as s:
        s.host.expect("^Done printing file$", 30)
        assert s.positions()["x"] == 30.0


@pytest.mark.parametrize("command", ["M601", "M600"])
@pytest.mark.parametrize("answer", ["M602", "M24"])
def test_m0_in_a_program_ends_with_an_answer(tmp_path, command, answer):
    text = f"G1 X10 Y50 Z20 F6000\n{command}\nG1 X20 F6000\n".encode()
    with printing(tmp_path, text) as s:
        s.passes(30)
        assert "Done printing file" not in s.host.heard
        s.host.ok(answer)
        s.host.expect("^Done printing file$", 30)
        assert s.positions()["x"] == 40.0


def test_eof_ends_the_program(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X5 F6000\nEOF\nG1 X50\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M2")  # a console has no program to end
        before = s.positions()["x"]
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 20)
        s.passes(1)
        assert s.positions()["x"] == before + 5
