"""What a console says of itself while its host is silent."""

from tests.support.scenario import Scenario


def test_wait_is_sent_a_second_after_last_ok():
    with Scenario() as s:
        s.passes(0.5)
        s.host.ok("M105")
        s.host.silent(0.95, "wait")
        s.host.expect("^wait$", within=0.1)
        s.host.silent(0.95, "wait")
        s.host.expect("^wait$", within=0.1)


def test_wait_is_not_sent_while_a_line_runs():
    with Scenario() as s:
        s.host.ok("G4 S5")
        s.host.send("M400")
        s.host.silent(4, "wait")
        s.host.expect("^ok$", within=2)
        s.host.silent(0.95, "wait")
        s.host.expect("^wait$", within=0.1)
