"""The scales of motors stay as they are while moves of a paused print are counted in them."""

import pytest
from tests.support.scenario import Host, Scenario

TURNS = "".join(f"G1 X{50 + i % 2 * 5} Y{50 + i * 0.05:g} E0.1 F1500\n" for i in range(100))
PROGRAM = f"G92 X20 Y20 Z20\nM83\nM302 P1\nG1 X50 Y50 F6000\n{TURNS}G1 X33 Y44 F6000\n"


def settings(s: Scenario) -> list[str]:
    return s.host.ok("M503 S0")


@pytest.fixture
def s(tmp_path):
    """Paused and parked; what is stored differs from what holds in a scale and an acceleration."""
    card, state = tmp_path / "card", tmp_path / "state"
    card.mkdir()
    (card / "a.g").write_text(PROGRAM)
    with Scenario("i3", card=str(card), state=str(state)) as scenario:
        host = scenario.host
        for line in ("M92 E100", "M204 P777", "M500", "M502", "M32 a.g"):
            host.ok(line)
        scenario.begin = scenario.positions()
        scenario.passes(8)
        host.ok("M25")
        scenario.passes(10)
        yield scenario


@pytest.mark.parametrize("line", ["M92 E100", "M92 X100", "M501", "M502", "M930"])
def test_scales_in_pause_are_refused_and_print_continues(s, line):
    s.host.ok("M204 P888")
    s.host.ok("M926 IXStepsPerUnit V100")
    before = settings(s)
    code = line.split()[0]
    told = s.host.ok(line)[0]
    assert told.startswith(
        f"echo:{code} would change steps per mm or the geometry while a print is paused"
    )
    assert "Resume (M24) or cancel (M524)" in told
    assert settings(s) == before  # all of them, and what M926 has noted
    s.host.ok("M24")
    s.host.expect("^Done printing file$", 120)
    way = {name: s.positions()[name] - s.begin[name] for name in "xyze"}
    assert way == pytest.approx({"x": 13, "y": 24, "z": 0, "e": 10}, abs=0.02)
    assert s.host.ok(line)[-1] == "ok"
    assert settings(s) != before


def test_options_other_than_scales_apply_in_pause(s):
    s.host.ok("M926 IXMaxSpeed V77")
    s.host.ok("M930")
    assert s.host.ok("M925 IXMaxSpeed")[0] == "77"


def test_a_scale_that_waits_for_moves_when_the_pause_comes(s):
    s.host.ok("M24")
    s.passes(3)
    other = Host(s)
    s.host.send("M92 E100")
    s.passes(0.2)
    s.host.silent(0.1, "^ok")
    other.send("M25")
    s.host.expect("M92 would change steps per mm", 5)
    s.passes(5)
    other.ok("M24")
    s.host.expect("^Done printing file$", 120)
    assert s.positions()["e"] - s.begin["e"] == pytest.approx(10, abs=0.02)
