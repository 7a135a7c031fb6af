"""The motion of a measurement: it joins, stays near its place, and can be shaped exactly."""

from __future__ import annotations

from itertools import accumulate, pairwise

import pytest

from passo.config.shapers import impulses
from passo.resonance.excitation import Excitation, Law, Swing, shaped, swings


def place(pieces: list[tuple[float, tuple[Law, ...]]], which: int, at_s: float) -> float:
    """The position of one of the laws at a time, mm."""
    for (seconds, laws), end in zip(pieces, accumulate(s for s, _ in pieces), strict=True):
        if at_s <= end:
            a, b, c = laws[which]
            t = at_s - end + seconds
            return a + t * (b + t * c)
    raise AssertionError("after the end")


def test_the_motion_joins_ends_at_rest_and_stays_in_reach() -> None:
    excitation = Excitation(start_hz=10, end_hz=30, hz_per_s=2)
    motion = list(swings(excitation))
    for before, after in pairwise(motion):
        t, x, v, a = before
        assert (after.mm, after.mm_s) == pytest.approx((x + t * (v + t * a / 2), v + t * a))
    t, x, v, a = motion[-1]
    assert v + t * a == pytest.approx(0, abs=1e-9)
    farthest = max(abs(swing.mm) for swing in motion)
    assert farthest <= excitation.reach_mm < 1.05 * farthest < 40
    assert sum(swing.seconds for swing in motion) > excitation.seconds == pytest.approx(10, abs=0.2)
    still = Excitation(sweep_s=0)
    assert still.reach_mm < 2
    assert still.rms_mm_s2 == pytest.approx(60 * 81, rel=0.03)  # of 5 to 135 Hz


def test_a_shaped_motion_is_the_golden_one() -> None:
    """20 mm at 100 mm/s and 3000 mm/s2 after mzv and ei; a shaper at rest 40 ms later."""
    ramp = 1 / 30
    motion = [
        Swing(ramp, 0, 0, 3000),
        Swing(0.2 - ramp, 5 / 3, 100, 0),
        Swing(ramp, 20 - 5 / 3, 100, -3000),
    ]
    mzv, ei = impulses("mzv", 50, 0.1), impulses("ei", 50, 0.1)
    pieces = list(shaped(motion, [mzv, ei, [(1.0, 0.0)]]))
    for which, shaper, golden in (
        (0, mzv, {-0.005: 0.001231470, 0.01: 0.198880988, 0.05: 3.333333333, 0.23: 19.939942711}),
        (1, ei, {0: 0.038075227, 0.01: 0.228300181, 0.2: 18.295258107, 0.24: 19.992862340}),
    ):
        mean = sum(weight * at for weight, at in shaper)
        for at_s, mm in golden.items():
            assert place(pieces, which, at_s + mean) == pytest.approx(mm, abs=2e-8)
    assert place(pieces, 2, 0.1) == pytest.approx(5 / 3 + 100 * (0.1 - ramp))
    end = sum(seconds for seconds, _ in pieces)
    assert [place(pieces, which, end) for which in range(3)] == pytest.approx([20, 20, 20])
    assert end == pytest.approx(motion[0].seconds + 0.2 + ei[-1][1])
