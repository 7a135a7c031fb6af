"""The motion that excites an axis for a measurement: a vibration whose frequency rises, on top of a
slow sweep. Its constants and its form are those of Klipper's resonance tester, so that the results
of both can be compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, sqrt
from typing import NamedTuple

from passo.config.shapers import Impulses

_FIRST_SWEEP = sqrt(2) / 8  # of its period, from rest; the second swing is 1/4 longer
_SAME_HZ = 1e-6


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of the motion with constant acceleration, mm/s², for `seconds`, at `hz`."""

    seconds: float
    accel_mm_s2: float
    hz: float


@dataclass(frozen=True, slots=True)
class Excitation:
    """A vibration from `start_hz` to `end_hz`, which rises by `hz_per_s`. Its acceleration is
    `accel_per_hz` times the frequency. The sweep accelerates by ± `sweep_accel_mm_s2`, with a
    period of `sweep_s`; 0 turns it off."""

    start_hz: float = 5.0
    end_hz: float = 135.0
    hz_per_s: float = 1.0
    accel_per_hz: float = 60.0
    sweep_accel_mm_s2: float = 400.0
    sweep_s: float = 1.2

    def segments(self) -> Iterator[Segment]:
        """The segments of the motion, in their order; the head starts at rest."""
        if not self.sweep_s:
            yield from self._vibration()
            return
        left = self.sweep_s * _FIRST_SWEEP  # s of the present swing of the sweep
        share, sweep = _FIRST_SWEEP + 0.25, self.sweep_accel_mm_s2
        for part in self._vibration():
            seconds = part.seconds
            while left <= seconds:
                yield Segment(left, part.accel_mm_s2 + sweep, part.hz)
                seconds -= left
                left = self.sweep_s * share
                share, sweep = 0.5, -sweep
            left -= seconds
            yield Segment(seconds, part.accel_mm_s2 + sweep, part.hz)

    def _vibration(self) -> Iterator[Segment]:
        hz, sign = self.start_hz, 1
        while hz <= self.end_hz + _SAME_HZ:
            quarter = 0.25 / hz
            accel = sign * self.accel_per_hz * hz
            yield Segment(quarter, accel, hz)
            yield Segment(quarter, -accel, hz)
            hz += 2 * quarter * self.hz_per_s
            sign = -sign

    @property
    def seconds(self) -> float:
        """The duration without the stop at its end."""
        return sum(part.seconds for part in self.segments())

    @property
    def rms_mm_s2(self) -> float:
        """The root mean square of the acceleration."""
        squares = sum(part.seconds * part.accel_mm_s2**2 for part in self.segments())
        return sqrt(squares / self.seconds)

    @property
    def reach_mm(self) -> float:
        """The greatest distance from the start in either direction, including the stop at the
        end."""
        far = position = speed = 0.0
        for part in self.segments():
            position, speed, turn = _moved(position, speed, part)
            far = max(far, abs(position), abs(turn))
        return max(far, abs(position + speed * abs(speed) / (2 * self.stop_accel_mm_s2)))

    @property
    def stop_accel_mm_s2(self) -> float:
        """The acceleration with which the head stops at the end: half of the acceleration of the
        vibration at its end."""
        return 0.5 * self.accel_per_hz * self.end_hz


class Swing(NamedTuple):
    """A part of the motion along its line: seconds, and at its start the distance from the rest
    position in mm and the speed in mm/s; the acceleration is constant, in mm/s²."""

    seconds: float
    mm: float
    mm_s: float
    mm_s2: float


def swings(excitation: Excitation) -> Iterator[Swing]:
    """The whole motion, with the stop at its end. Swings join each other."""
    position = speed = 0.0
    for part in excitation.segments():
        yield Swing(part.seconds, position, speed, part.accel_mm_s2)
        position += part.seconds * (speed + 0.5 * part.seconds * part.accel_mm_s2)
        speed += part.seconds * part.accel_mm_s2
    if speed:
        brake = excitation.stop_accel_mm_s2
        yield Swing(abs(speed) / brake, position, speed, -brake if speed > 0 else brake)


Law = tuple[float, float, float]
"""Coefficients of the position, mm, as a quadratic of the time in s from the start of a piece."""


def shaped(
    motion: Sequence[Swing], shapers: Sequence[Impulses]
) -> Iterator[tuple[float, tuple[Law, ...]]]:
    """The motion after each of the shapers: pairs of seconds and one law for each shaper. A shaper
    of one impulse at time 0 leaves it as it is. The sum of delayed copies of quadratics is a
    quadratic, between the times at which any copy changes."""
    copies = [
        (which, weight, _Copy(motion, delay))
        for which, shaper in enumerate(shapers)
        for weight, delay in shaper
    ]
    now = 0.0
    while (until := min(copy.end_s for _, _, copy in copies)) < inf:
        sums = [[0.0, 0.0, 0.0] for _ in shapers]
        for which, weight, copy in copies:
            for power, value in enumerate(copy.law(now)):
                sums[which][power] += weight * value
        if until > now:
            yield until - now, tuple((a, b, c) for a, b, c in sums)
        now = until
        for _, _, copy in copies:
            if copy.end_s <= now:
                copy.advance()


class _Copy:
    """A delayed copy of a motion. `end_s` is the time at which its law changes next."""

    def __init__(self, motion: Sequence[Swing], delay_s: float) -> None:
        self._swings = iter(motion)
        self._start_s, self.end_s = 0.0, delay_s
        self._law: Law = (0.0, 0.0, 0.0)

    def advance(self) -> None:
        """Goes on to the next law."""
        swing = next(self._swings, None)
        if swing is None:
            self._law = (self.law(self.end_s)[0], 0.0, 0.0)
            self._start_s, self.end_s = self.end_s, inf
            return
        self._law = (swing.mm, swing.mm_s, 0.5 * swing.mm_s2)
        self._start_s, self.end_s = self.end_s, self.end_s + swing.seconds

    def law(self, at_s: float) -> Law:
        """The law from this time on."""
        t = at_s - self._start_s
        mm, mm_s, half = self._law
        return mm + t * (mm_s + t * half), mm_s + 2 * t * half, half


def _moved(position: float, speed: float, part: Segment) -> tuple[float, float, float]:
    """Position and speed after a segment, and the place where the direction changes in it, or its
    end."""
    end = speed + part.seconds * part.accel_mm_s2
    after = position + 0.5 * (speed + end) * part.seconds
    turns = speed * end < 0
    return after, end, position - speed * speed / (2 * part.accel_mm_s2) if turns else after
