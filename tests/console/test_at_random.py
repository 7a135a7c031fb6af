"""Two consoles that send anything at any time, come and go; then the printer homes and moves."""

import random

import pytest
from tests.support.scenario import Host, Scenario

COMMANDS = [
    "G28",
    "G28 X",
    "G1 X{n} F6000",
    "G1 Y{n}",
    "G4 P300",
    "M400",
    "M109 S200",
    "M109 S0",
    "M190 S50",
    "M104 S0",
    "M0",
    "M84",
    "M108",
    "M410",
    "M112",
    "M999",
    "M105",
    "M114",
    "M18",
    "G90",
    "G91",
    "M220 S{n}",
    "M116",
    "T0",
    "M82",
    "M600",
    "M25",
    "M24",
    "M17",
    "M303 E0 S200 C3",
]


def at_random(s, chance):
    hosts = [Host(s), Host(s)]
    for _ in range(40):
        which = chance.randrange(2)
        if chance.random() < 0.08:
            hosts[which].session.close()
            hosts[which] = Host(s)
        else:
            hosts[which].send(chance.choice(COMMANDS).format(n=chance.randrange(1, 180)))
        if chance.random() < 0.5:
            s.passes(chance.choice((0.01, 0.1, 0.5, 2)))
    for host in hosts:
        host.send("M118 done")
    return hosts


@pytest.mark.parametrize("seed", range(25))
def test_random_console_actions_never_block_the_printer(seed):
    with Scenario("i3") as s:
        hosts = at_random(s, random.Random(seed))
        for _ in range(300):  # waits end, one after another
            s.host.send("M108", "M999")
            s.passes(0.2)
            if s.host.heard.count("done") == len(hosts):
                break
        assert s.host.heard.count("done") == len(hosts)
        s.host.send("M410")
        s.passes(3)
        s.host.send("G28", "M118 homed")
        s.host.expect("^homed$", 100)
        s.host.send("G90", "M220 S100", "G1 X50 Y50 F6000", "M400", "M118 there")
        s.host.expect("^there$", 30)
        at = s.positions()
        assert (at["x"], at["y"]) == pytest.approx((50, 50), abs=0.02)
