"""What the densest place of a file takes of board and link is told before it is printed."""

from __future__ import annotations

import re
from importlib.resources import files

import pytest
from tests.console.scenario import Scenario

from passo import config
from passo.cli.main import main
from passo.job.budget_use import BudgetUse, Place
from passo.job.estimate import estimate

TEXT = files("passo.config").joinpath("machines", "i3.toml").read_text()
LINK = 'link = "serial"\nport = "/dev/x"\n'
FIRST = 203  # line of the dense place


@pytest.fixture
def dense(tmp_path):
    """Long moves, then a zigzag of 0.05 mm a move at 30 mm/s, then long moves again."""
    lines = ["G92 X0 Y0 Z0 E0", "M302 P1"]
    lines += [f"G1 X{50 * (i % 2)} F3000" for i in range(FIRST - 3)]
    lines += [f"G1 X{0.05 * i:.3f} Y{0.04 * (i % 2) + 0.05 * i:.3f} F1800" for i in range(600)]
    lines += [f"G1 X{50 * (i % 2)} F3000" for i in range(20)]
    path = tmp_path / "dense.g"
    path.write_text("\n".join(lines) + "\n")
    return path


def use(path, board):
    return estimate(config.load_text(TEXT + board), path).budget


def test_shares_and_places(dense):
    found = use(dense, LINK)
    assert found.densest.keys() == {"steps", "commands", "slots", "link"}
    link, commands, slots = (found.densest[n] for n in ("link", "commands", "slots"))
    assert FIRST <= link.line < FIRST + 600
    assert link.line == commands.line == slots.line
    per_s = commands.load * 16e6 / 1950
    assert link.load == pytest.approx((8.3 * per_s + 1200) / 23_750)
    assert slots.load == pytest.approx(0.2 * per_s / 401)
    assert found.commits == pytest.approx(1200 / 23_750)
    fastest = 50 * 80 * 164 / 16e6  # on the long moves
    assert found.densest["steps"].load == pytest.approx(fastest)
    assert found.densest["steps"].line == 4


def test_without_a_bound_link_there_is_no_share_of_it(dense):
    assert use(dense, "").densest.keys() == {"steps", "commands", "slots"}
    assert use(dense, "").commits == 0


def test_an_estimate_shows_them(dense, tmp_path, capsys):
    machine = tmp_path / "mine.toml"
    machine.write_text(TEXT + LINK)
    assert main(["estimate", str(dense), "--machine", str(machine)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^  link +\d+% at line \d+$", out, re.MULTILINE)
    assert re.search(r"^  link, for brake tails +5% in all moves$", out, re.MULTILINE)


def test_more_than_all_is_a_burst():
    told = BudgetUse(densest={"link": Place(7, 1.1), "slots": Place(8, 1.0)})
    assert told.shares() == [
        ("link", "110% at line 7, in a burst that is sent ahead"),
        ("move slots", "100% at line 8"),
    ]


def test_a_print_is_told_them_when_it_begins(dense):
    with Scenario("i3", card=str(dense.parent)) as s:
        s.host.ok("M32 dense.g")
        told = s.host.expect("At its densest the file takes", 5)
        shown = re.fullmatch(r".* move slots (\d+)% at line (\d+)", told)
        assert shown
        assert int(shown[1]) > 20
        assert FIRST <= int(shown[2]) < FIRST + 600
