"""How far the screws of the simulated bed must be turned."""

import re

import pytest
from tests.support.edited_machine import STILL, answers, edited
from tests.support.scenario import Scenario

from passo.config.exporting.settings import Sections
from passo.errors import ConfigError
from passo.printer.klipper.objects import objects
from passo.printer.setup.simulated_world import simulated_bed

STEP = 1 / 400
MINUTE_MM = 0.5 / 60  # of an M3 screw


def machine(*changes):
    return edited("i3-probe", STILL, *changes)


@pytest.fixture
def s():
    with Scenario(machine()) as scenario:
        scenario.host.ok("G28", 60)
        yield scenario


def bed_heights(s):
    shape = simulated_bed(s.machine).shape
    return {p.name: shape.height(p.x, p.y) for p in s.machine.levelling.screws.places}


def turned_mm(text):
    """How far a screw M3 cw lifts the bed when it is turned like that."""
    direction, turns, minutes = re.fullmatch(r".*adjust (C?CW) (\d\d):(\d\d)", text).groups()
    return (int(turns) * 60 + int(minutes)) * MINUTE_MM * (1 if direction == "CW" else -1)


def test_turns_bring_all_screws_to_the_height_of_the_first(s):
    said = answers(s, "SCREWS_TILT_CALCULATE")
    heights = bed_heights(s)
    base = heights["front left"]
    assert re.fullmatch(r"// front left \(base\) : x=15\.0, y=20\.0, z=-?\d\.\d{5}", said[1])
    for line in said[2:]:
        name = line.removeprefix("// ").split(" : ")[0]
        assert heights[name] + turned_mm(line) == pytest.approx(base, abs=MINUTE_MM / 2 + 2 * STEP)
    assert len(said) == 5


@pytest.mark.parametrize(("direction", "sign"), [("CW", 1), ("ccw", -1)])
def test_all_screws_turn_in_one_direction(s, direction, sign):
    said = answers(s, f"SCREWS_TILT_CALCULATE DIRECTION={direction}")
    moved = [turned_mm(line) for line in said[1:] if "adjust" in line]
    assert len(moved) == 3
    assert all(mm * sign >= 0 for mm in moved)


def test_g35_reports_turns_as_marlin_does(s):
    heights = bed_heights(s)
    said = answers(s, "G35")
    off = heights["front right"] - heights["front left"]
    turn = re.fullmatch(
        r"Turn front right CCW by 0 turns and (\d+) minutes \((0\.\d+)mm\)", said[0]
    )
    assert float(turn[2]) == pytest.approx(off, abs=2 * STEP)
    assert int(turn[1]) == pytest.approx(off / MINUTE_MM, abs=1)
    assert answers(s, "G35 S31")[0] == said[0].replace("CCW", "CW")
    assert "S is 32: expected 30, 31, 40, 41, 50, 51" in answers(s, "G35 S32")[0]


def test_bed_that_is_too_uneven_is_an_error_after_the_report(s):
    said = answers(s, "SCREWS_TILT_CALCULATE MAX_DEVIATION=0.1")
    assert len(said) == 6
    shown = objects(s.machine, Sections(s.machine), s.printer.status.read(), {})[
        "screws_tilt_adjust"
    ]()
    assert (shown["error"], shown["max_deviation"]) == (True, 0.1)
    first, second, *_ = shown["results"].values()
    assert (first["is_base"], first["adjust"]) == (True, "00:00")
    assert f"adjust {second['sign']} {second['adjust']}" in said[2]
    assert re.search(r"screws of the bed differ by 0\.\d+ mm: at most 0\.1 mm", said[-1])
    assert "expected CW or CCW" in answers(s, "SCREWS_TILT_CALCULATE DIRECTION=UP")[0]


def test_screws_are_adjusted_until_all_are_accepted_in_turn(s):
    names = [p.name for p in s.machine.levelling.screws.places]

    def shown(line):
        return answers(s, line)[0].removeprefix("// Screw ").partition(",")[0]

    assert shown("BED_SCREWS_ADJUST") == names[0]
    place = s.machine.levelling.screws.places[0]
    at = s.positions()
    assert (at["x"], at["y"], at["z"]) == (place.x, place.y, 0)
    assert shown("ACCEPT") == names[1]
    assert s.positions()["z"] == 0
    # A screw that was turned is shown again, after all others.
    assert [shown(line) for line in ("ADJUSTED", "ACCEPT", "ACCEPT", "ACCEPT")] == [
        names[2],
        names[3],
        names[0],
        names[1],
    ]
    assert "a paper test is under way" in answers(s, "BED_SCREWS_ADJUST")[0]
    assert answers(s, "ACCEPT") == ["// All screws are as high as the bed at Z 0"]
    assert s.positions()["z"] == 10
    assert "no paper test" in answers(s, "ADJUSTED")[0]


def test_abort_ends_the_adjustment_and_lifts_the_nozzle(s):
    answers(s, "BED_SCREWS_ADJUST")
    answers(s, "ABORT")
    assert s.positions()["z"] == 10
    assert "no paper test" in answers(s, "ACCEPT")[0]


def test_paper_test_has_no_screw_to_turn(s):
    answers(s, "G1 X100 Y100 Z5 F6000")
    answers(s, "MANUAL_PROBE")
    assert "no screw of the bed is being adjusted" in answers(s, "ADJUSTED")[0]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            'name = "back left", x = 15, y = 200',
            'name = "back left", x = 240, y = 200',
            "X240 Y200",
        ),
        ('name = "back left"', 'name = "back right"', "a name of its own"),
        ('"M3 cw"', '"M7 cw"', "thread"),
    ],
)
def test_screws_that_cannot_be_measured_are_refused(old, new, says):
    with pytest.raises(ConfigError, match=says):
        machine((old, new))
