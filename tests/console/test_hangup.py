"""A host that goes away in the middle of something."""

import pytest
from tests.support.scenario import Host, Scenario


@pytest.fixture
def s():
    with Scenario() as scenario:
        yield scenario


def hang_up(s):
    async def close():
        s.host.session.close()

    s.run(close())


@pytest.mark.parametrize("after", [0.5, 1.0, 2.0, 3.0])
def test_homing_ends_at_rest_and_not_beyond_a_switch(s, after):
    s.host.send("G28")
    s.passes(after)
    hang_up(s)
    s.passes(1.0)
    at_rest = s.positions()
    assert all(at > -0.1 for at in at_rest.values())
    s.passes(5.0)
    assert s.positions() == at_rest
    other = Host(s)
    assert "is not homed" in other.ok("G1 X10")[0]
    other.ok("G28", within=20)
    assert s.positions() == {"x": 0.0, "y": 0.0, "z": 0.0, "e": 0.0}


def test_a_wait_for_a_temperature_ends(s):
    s.host.send("M109 S200")
    s.passes(1.0)
    hang_up(s)
    assert Host(s).ok("M400", within=1.0) == ["ok"]
