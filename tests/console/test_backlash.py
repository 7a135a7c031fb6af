"""Backlash compensation from the machine file, M425, homing and the report of positions."""

from __future__ import annotations

import pytest
from tests.support.disturbed_prints import steps
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.config.motion import Backlash
from passo.errors import ConfigError

_I3 = config.load("i3")
GEARED = _I3.model_copy(update={"backlash": Backlash(x_mm=0.2, y_mm=0.1, smooth_mm=2.0)})
X_STEPS, Y_STEPS = 16, 8


def row(s):
    return next(line for line in s.host.ok("M503") if "M425" in line)


def test_machine_file_sets_backlash():
    with Scenario(GEARED) as s:
        assert row(s) == "M425 F1 S2 X0.2 Y0.1 Z0"


def test_m425_sets_and_reports_backlash(tmp_path):
    state = str(tmp_path / "state")
    with Scenario("i3", state=state) as s:
        assert s.host.ok("M425") == ["M425 F1 S3 X0 Y0 Z0", "ok"]
        assert s.host.ok("M425 X0.15 Z.02 S4") == ["ok"]
        assert s.host.ok("M425 F0.5") == ["ok"]
        assert row(s) == "M425 F0.5 S4 X0.15 Y0 Z0.02"
        s.host.ok("M500")
    with Scenario("i3", state=state) as s:
        assert row(s) == "M425 F0.5 S4 X0.15 Y0 Z0.02"
        s.host.ok("M502")
        assert row(s) == "M425 F1 S3 X0 Y0 Z0"


REFUSED = {
    "M425 X-1": "X is -1: expected 0 to 2 mm",
    "M425 X0.5 S0.2": "X is 0.5: expected 0 to 2 mm, and at most S, 0.2 mm",
    "M425 S0": "S is 0: expected 0.1 to 100 mm",
    "M425 F2": "F is 2: expected 0 to 1",
}


@pytest.mark.parametrize("line", REFUSED)
def test_backlash_beyond_its_range_is_refused(line):
    with Scenario("i3") as s:
        assert REFUSED[line] in s.host.ok(line)[0]
        assert row(s) == "M425 F1 S3 X0 Y0 Z0"


def test_only_axes_with_their_own_motors_have_backlash():
    with Scenario("corexy") as s:
        assert "X is 0.1: expected 0, as no motor moves X alone" in s.host.ok("M425 X0.1")[0]
        assert s.host.ok("M425 X0 Z0.05") == ["ok"]
        assert row(s) == "M425 F1 S3 Z0.05"
    with Scenario("delta") as s:
        assert s.host.ok("M425") == ["M425 F1 S3", "ok"]
        assert not any("M425" in line for line in s.host.ok("M503"))


def test_gap_is_taken_up_after_home_and_positions_do_not_show_it():
    """Home is at the minimum, so each motion away from it takes up the gap first."""

    def ends(s, line):
        s.host.ok(line, 60)
        s.host.ok("M400", 60)
        return s.host.ok("M114"), s.host.ok("M114 R"), steps(s)

    lines = ("G28", "G1 X50 Y50 F6000", "G1 X40", "G1 X39", "G1 X60 Y51", "G28 X", "G1 X10")
    with Scenario(_I3) as s:
        plain = [ends(s, line) for line in lines]
    with Scenario(GEARED) as s:
        geared = [ends(s, line) for line in lines]
    assert [x[:2] for x in geared] == [x[:2] for x in plain]
    more = [{n: a[2][n] - b[2][n] for n in "xyze"} for a, b in zip(geared, plain, strict=True)]
    assert [m["x"] for m in more] == [0, X_STEPS, 0, 0, X_STEPS, 0, X_STEPS]
    assert [m["y"] for m in more] == [0, *[Y_STEPS] * 6]
    assert {m["z"] for m in more} == {m["e"] for m in more} == {0}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("x_mm = 0.5\nsmooth_mm = 0.2", "at most backlash.smooth_mm, 0.2"),
        ("x_mm = 3.0", "2"),
    ],
)
def test_machine_file_with_impossible_backlash_is_refused(tmp_path, text, reason):
    path = tmp_path / "m.toml"
    path.write_text(f"{shipped_text('i3')}\n[backlash]\n{text}\n")
    with pytest.raises(ConfigError) as refused:
        config.load(str(path))
    assert reason in str(refused.value)


def test_machine_file_with_backlash_of_belts_is_refused(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text(f"{shipped_text('corexy')}\n[backlash]\ny_mm = 0.1\n")
    with pytest.raises(ConfigError, match="no motor moves Y alone"):
        config.load(str(path))
