"""What a heater's controller does, on the console that asks for it."""

import re

from tests.support.scenario import Host, Scenario


def test_a_trace_is_switched_on_for_one_console():
    with Scenario("i3") as s:
        other = Host(s)
        s.host.ok("M104 S100")
        s.host.ok("M921 S1")
        line = s.host.expect("^//trace hotend", 2)
        values = dict(re.findall(r"(error|p|i|d|out):(-?[\d.]+)", line))
        assert set(values) == {"error", "p", "i", "d", "out"}
        assert float(values["error"]) > 50
        assert float(values["out"]) == 1.0
        assert not any("trace" in x for x in other.heard)
        s.host.ok("M921 S0")
        s.host.silent(3, "trace")
        assert s.host.ok("M921")[1].startswith("//trace bed: ")


def test_a_machine_without_tools_moves_filament_as_an_axis():
    from passo import config
    from passo.config.load import shipped_text

    text = (
        shipped_text("i3")
        .replace("[steppers.e]", "[steppers.u]")
        .replace("[extruders.e]", "[axes.u]\nmin_mm = -1000.0\nhome_mm = 0.0\nmax_mm = 1000.0")
    )
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X10 U3 F600")
        s.host.ok("G91")
        s.host.ok("G1 U-1")
        s.host.ok("M400")
        assert round(s.positions()["u"], 1) == 2.0
        assert "U:2.000" in s.host.ok("M114")[0]
