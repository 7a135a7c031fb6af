"""The card while a host's print stands aside, or the machine is halted."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario


@pytest.fixture
def s(tmp_path):
    (tmp_path / "a.g").write_text("G1 X60 F1200\nG1 X40\n")
    with Scenario(card=str(tmp_path)) as scenario:
        for line in ("G92 X0 Y0 Z0", "G1 X10 F6000", "M400", "M23 a.g"):
            scenario.host.ok(line, 20)
        yield scenario


def test_m24_ends_a_hosts_pause_and_starts_no_file_in_its_midst(s):
    s.host.send("M601", "G1 X12", "M400")
    s.passes(5)
    other = Host(s)
    assert other.ok("M24") == ["ok"]
    s.host.expect("// action:resume", 5)
    s.passes(10)
    assert other.ok("M27")[0] == "Not SD printing"
    assert s.host.ok("M114")[0].startswith("X:12.000")
    other.ok("M24")
    s.host.expect("Done printing", 20)
    assert s.host.ok("M114")[0].startswith("X:40.000")


def test_a_halted_printer_prints_nothing_from_the_card(s):
    s.host.ok("M24")
    s.passes(1)
    s.host.ok("M25")
    s.passes(5)
    assert s.host.ok("M27")[0].startswith("SD printing")
    s.host.send("M112")
    s.passes(1)
    assert s.host.ok("M27")[0] == "Not SD printing"
