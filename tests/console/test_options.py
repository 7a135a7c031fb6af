"""APrinter's options by name: noted, then applied."""

import json

import pytest
from tests.console.scenario import Scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


def test_options_are_told(s):
    for name, value in {
        "XStepsPerUnit": "80",
        "ZMaxSpeed": "12",
        "EMaxAccel": "5000",
        "xmaxpos": "250",
        "ExtruderHeater0MaxSafeTemp": "285",
        "BedHeater0TempBeta": "3950",
        "YHomeDir": "0",
        "InactiveTime": "600",
    }.items():
        assert s.host.ok(f"M925 I{name}") == [value, "ok"], name
    assert "UnknownOption" in s.host.ok("M925 IFooBar")[0]


def test_a_new_value_is_pending_until_m930(s):
    assert s.host.ok("M926 IXStepsPerUnit V100") == ["ok"]
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "80"
    assert "; pending until M930: M926 IXStepsPerUnit V100" in s.host.ok("M503")
    s.host.ok("M926 IExtruderHeater0PidP V0.125")
    assert s.host.ok("M930") == ["ok"]
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "100"
    assert s.host.ok("M925 IExtruderHeater0PidP")[0] == "0.125"
    assert not any("pending" in line for line in s.host.ok("M503"))
    s.host.ok("M926 IXStepsPerUnit")
    s.host.ok("M930")
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "80"  # as at the start


def test_m408_tells_what_is_pending(s):
    def pending(form=0):
        return json.loads(s.host.ok(f"M408 S{form}")[0])["pending"]

    assert pending() == {}
    s.host.ok("M926 Ixstepsperunit V100")
    s.host.ok("M926 IExtruderHeater0PidP V0.125")
    wanted = {"XStepsPerUnit": 100.0, "ExtruderHeater0PidP": 0.125}
    assert [pending(form) for form in range(4)] == [wanted] * 4
    s.host.ok("M930")
    assert pending() == {}


def test_what_cannot_be_set_says_so(s):
    assert "fixed while the printer runs" in s.host.ok("M926 IXMaxPos V300")[0]
    assert "V is abc: expected a number" in s.host.ok("M926 IXMaxSpeed Vabc")[0]
    s.host.ok("M926 IXMaxSpeed V999")  # beyond the machine file's
    assert s.host.ok("M930")[0] == "echo:XMaxSpeed stays at 300; M203 X999 was not taken"


def test_m92_acts_at_once(s):
    s.host.ok("M92 X90")
    assert s.host.ok("M925 IXStepsPerUnit")[0] == "90"
