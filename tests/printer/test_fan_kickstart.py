"""How fans are started: fully on for a while, then as asked."""

from __future__ import annotations

import pytest
from tests.job.test_lost_link import break_link
from tests.support.scenario import Scenario
from tests.support.two_boards import printed as printed_on
from tests.support.two_boards import two_boards

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError
from passo.job.batch.simulated_print import Print

HZ = 16_000_000
FULL = HZ // 10  # at 10 Hz
KICK = "kick_start_s = 0.5"


def machine(fan: str = KICK, board: str = ""):
    text = shipped_text("i3").replace("[fans.part]", f"[fans.part]\n{fan}")
    return config.load_text(text.replace("[board]", f"[board]\n{board}"))


def changes(s) -> list[tuple[int, int]]:
    """Clocks from the first one on, and values in 255ths."""
    found = s.board.take_changes("part")
    return [(clock - found[0][0], round(value / FULL * 255)) for clock, value in found]


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.board.trace_output("part")
        yield s


def test_a_stopped_fan_starts_with_full_power(s):
    s.host.ok("M106 S51")
    s.passes(2)
    assert changes(s) == [(0, 255), (HZ // 2, 51)]
    s.host.ok("M107")
    s.host.ok("M106 S51")
    s.passes(2)
    (_, off), (begin, full), (end, asked) = changes(s)
    assert (off, full, asked) == (0, 255, 51)
    assert end - begin == HZ // 2


@pytest.mark.parametrize(("rise", "kicked"), [("", True), ("kick_start_rise = 1.0", False)])
def test_kickstart_acts_on_large_rise(rise, kicked):
    with Scenario(machine(f"{KICK}\n{rise}")) as s:
        s.host.ok("M106 S51")
        s.passes(1)
        s.board.trace_output("part")
        for speed in (102, 229, 30, 200):
            s.host.ok(f"M106 S{speed}")
            s.passes(1)
        last = [255, 200] if kicked else [200]
        assert [v for _, v in changes(s)] == [102, 229, 30, *last]


def test_fan_at_full_power_has_no_kickstart(s):
    s.host.ok("M106")
    s.passes(2)
    assert changes(s) == [(0, 255)]


def test_value_during_kickstart_acts_after_it(s):
    s.host.ok("M106 S51 F")
    s.passes(0.1)
    s.host.ok("M106 S100 F")
    s.passes(2)
    assert [c for c in changes(s) if c[1] != 255] == [(HZ // 2, 100)]


def test_fan_off_during_kickstart_acts_at_once(s):
    s.host.ok("M106 S51 F")
    s.passes(0.2)
    s.host.ok("M107 F")
    s.passes(2)
    (_, full), (end, off) = changes(s)
    assert (full, off) == (255, 0)
    assert 0.1 < end / HZ < 0.21


def test_kickstart_uses_the_fans_maximum_power():
    with Scenario(machine(f"{KICK}\nmax_power = 0.8\noff_below = 0.1")) as s:
        s.board.trace_output("part")
        s.host.ok("M106 S25")  # less than a tenth
        s.host.ok("M106 S51")
        s.passes(2)
        (begin, most), (end, asked) = s.board.take_changes("part")
        assert (most, asked) == (round(0.8 * FULL), round(0.16 * FULL))
        assert end - begin == HZ // 2
        s.host.ok("M106 S300")
        s.passes(2)
        assert [v for _, v in s.board.take_changes("part")] == [most]


PROGRAM = "G28\nG1 X10 F600\nM106 S51\nG1 X20\nM107\nG1 X30\nM106 S51\nG1 X31\nM106 S80\n"


def printed(path, fan: str):
    done = Print(machine(fan))
    done.board.trace_output("part")
    result = done.run(path)
    return result, [(c - done.base, v) for c, v in done.board.take_changes("part")]


def test_kickstart_of_file_has_same_stream(tmp_path):
    path = tmp_path / "a.g"
    path.write_text(PROGRAM)
    plain, asked = printed(path, "")
    kicked, got = printed(path, KICK)
    assert plain.stream_hash == kicked.stream_hash
    (t1, _), (t2, _), (t3, _), (t4, _) = asked
    levels = [round(v / FULL * 255) for _, v in got]
    assert t4 - t3 < HZ // 2  # the last word comes in the midst of the second start
    assert [(c, v) for (c, _), v in zip(got, levels, strict=True)] == [
        (t1, 255),
        (t1 + HZ // 2, 51),
        (t2, 0),
        (t3, 255),
        (t3 + HZ // 2, 80),
    ]


def test_a_pause_leaves_no_fan_at_full_power(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X10 F600\nM106 S51\nG1 X80\n")
    with Scenario(machine(), card=str(tmp_path)) as s:
        s.board.trace_output("part")
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.board.output_value("part") > 0, 10)
        s.host.ok("M25")
        s.passes(2)
        assert changes(s) == [(0, 255), (HZ // 2, 51)]


@pytest.mark.parametrize("after_s", [0.1, 0.4, 0.7])
def test_link_loss_does_not_prolong_kickstart(tmp_path, after_s):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X10 F600\nM106 S51\nG1 X80\n")
    with Scenario(machine(board='firmware = "passo"'), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.board.output_value("part") > 0, 10)
        s.passes(after_s)
        break_link(s, 1.0)
        s.host.expect("The board is back", 10)
        s.passes(1)
        assert s.board.output_value("part") == round(0.2 * FULL)


@pytest.mark.parametrize(
    "wrong", ["kick_start_s = -0.1", "kick_start_s = 11", "kick_start_rise = 2.0", "off_below = 5"]
)
def test_wrong_kickstart_keys_are_named(wrong):
    with pytest.raises(ConfigError, match=wrong.partition(" ")[0]):
        machine(wrong)


def test_following_fan_has_no_kickstart():
    with pytest.raises(
        ConfigError, match=r"part\.kick_start_s is 0\.5: expected 0 where a fan follows"
    ):
        machine(f"{KICK}\nfollows = 'hotend'")
    assert machine("kick_start_s = 0.0\nfollows = 'hotend'").fans["part"].follows == "hotend"


def test_a_fan_on_a_further_board_starts_at_the_same_clock(tmp_path, monkeypatch):
    path = tmp_path / "a.g"
    path.write_text(PROGRAM)
    fan = {"[fans.part]": f"[fans.part]\n{KICK}", 'fan = "part"\n': ""}
    own = printed_on(monkeypatch, two_boards(**fan), path).outputs["part"]
    keys = ("start_s = 3.0", "drift_ppm = 40.0")
    away = two_boards(*keys, **fan, **{'pin = "D9"': 'pin = "tool:D9"'})
    assert away.fans["part"].pin == "tool:D9"
    other = printed_on(monkeypatch, away, path).outputs["part"]
    assert [v for _, v in own] == [v for _, v in other]
    assert len(own) == 5
    for (here, _), (there, _) in zip(own, other, strict=True):
        assert abs(here - there) < 400  # 25 us, and the kick is of the other board's seconds
