"""How fast and how hard each axis, motor and extruder moves at each millisecond, and what the
machine allows: the planned positions on a grid of 1/32 ms, filtered as discrete signals.

At a corner the junction law lets an axis change its speed at once. The mean over w of a limit of
jerk makes an acceleration of that change divided by w, which adds to the one of the moves.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, inf

import numpy as np
from tests.oracles.motion import HZ

from passo.config.motion import Shaping
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print

_KEPT = {"G0", "G1", "G2", "G3", "G90", "G91", "M82", "M83", "M204", "M205", "M900"}
PER_MS = 32
DT_S = 0.001 / PER_MS
MARGIN_S = 0.3


@dataclass
class Peak:
    """The highest speed and acceleration of a part, the limits of the machine, and the greatest
    change of its speed at one corner."""

    speed: float
    accel: float
    speed_limit: float
    accel_limit: float
    change: float = 0.0


class _Grid:
    """The planned positions, and what is advanced, at each time of the grid. The filament is
    divided into parts: with X, with Y, and with neither."""

    def __init__(self, moves):
        self.moves = [move for move in moves if move.kind != "dwell"]
        self.begin_s = self.moves[0].start_ticks / HZ - MARGIN_S
        n = int((self.moves[-1].end_ticks / HZ + MARGIN_S - self.begin_s) / DT_S)
        self.times = self.begin_s + DT_S * np.arange(n)
        self.axes, self.parts, self.advanced = np.zeros((3, n)), np.zeros((3, n)), np.zeros((3, n))
        filament, done = np.zeros(3), 0
        for m in self.moves:
            first, end = (
                ceil((t / HZ - self.begin_s) / DT_S) for t in (m.start_ticks, m.end_ticks)
            )
            start, way = np.array(m.start_mm[:3]), np.array(m.end_mm[:3]) - m.start_mm[:3]
            self.axes[:, done:first], self.parts[:, done:first] = start[:, None], filament[:, None]
            s, speed = self._along(m, self.times[first:end] - m.start_ticks / HZ)
            whole = float(way @ way)
            of = way[:2] ** 2 / whole if whole else np.zeros(2)
            e = (m.end_mm[3] - m.start_mm[3]) * np.array([*of, 1 - of.sum()])
            self.axes[:, first:end] = start[:, None] + np.outer(way, s)
            self.parts[:, first:end] = filament[:, None] + np.outer(e, s)
            self.advanced[:, first:end] = m.advance_s * np.outer(e, speed)
            filament, done = filament + e, end
        last = self.moves[-1].end_mm[:3]
        self.axes[:, done:], self.parts[:, done:] = np.array(last)[:, None], filament[:, None]

    @staticmethod
    def _along(m, t):
        """The share of the move that is done, and its speed, at times from its start."""
        t0, t1 = m.accelerate_ticks / HZ, m.cruise_ticks / HZ
        a, c, d = np.clip(t, 0, t0), np.clip(t - t0, 0, t1), np.clip(t - t0 - t1, 0, None)
        s = m.start_speed * a + 0.5 * m.acceleration * a * a + m.cruise_speed * (c + d)
        s -= 0.5 * m.deceleration * d * d
        speed = np.where(t < t0, m.start_speed + m.acceleration * t, m.cruise_speed)
        speed = speed - m.deceleration * d
        return s / m.length, speed / m.length

    def shaped(self, law, impulses):
        """The sum of copies, around their mean."""
        mean = sum(a * t for a, t in impulses)
        copies = (a * np.interp(self.times - t + mean, self.times, law) for a, t in impulses)
        return sum(copies)

    def boxed(self, law, width_s):
        """The mean over this time."""
        steps = 0.5 * DT_S * (law[1:] + law[:-1])
        whole = np.concatenate([[0.0], np.cumsum(steps)])
        low, high = (np.interp(self.times + x, self.times, whole) for x in _ends(width_s))
        return (high - low) / width_s

    def change(self, of):
        """The greatest change at once of the speed of what `of` gives for a move, by its way."""
        ways = [(m, of(m) / m.length) for m in self.moves]
        return max(abs(b[0].start_speed * b[1] - a[0].end_speed * a[1]) for a, b in pairwise(ways))


def _ends(width_s):
    return -0.5 * width_s, 0.5 * width_s


def _peak(law, speed_limit, accel_limit, change=0.0):
    law = law[int(0.2 * MARGIN_S / DT_S) : -int(0.2 * MARGIN_S / DT_S)][::PER_MS]
    speeds = np.diff(law) / 0.001
    accels = np.diff(speeds) / 0.001
    return Peak(np.abs(speeds).max(), np.abs(accels).max(), speed_limit, accel_limit, change)


def peaks(machine, moves):
    """By name, for X, Y, Z, the extruder, and motors of the geometry that have limits."""
    spec, grid = machine.core_spec()["filters"], _Grid(moves)
    box_s, shapers = spec["box_s"], [shaper or [(1.0, 0.0)] for shaper in spec["shapers"]]

    def filtered(law, shaper):
        return grid.shaped(grid.boxed(law, box_s) if box_s else law, shaper)

    axes = [filtered(law, shaper) for law, shaper in zip(grid.axes, shapers, strict=True)]
    found = {}
    for slot, name in enumerate("xyz"):
        axis = machine.axes[name]
        change = grid.change(lambda m, j=slot: m.end_mm[j] - m.start_mm[j])
        found[name] = _peak(axes[slot], axis.speed_mm_s, axis.accel_mm_s2, change)
    half, extruder, filament = spec["smooth_s"][0], machine.extruders["e"], 0.0
    for part, y, shaper in zip(grid.parts, grid.advanced, [*shapers[:2], [(1, 0)]], strict=True):
        one = shapers[0] if spec["shapers"][0] == spec["shapers"][1] else shaper
        one = one if spec["shaped"][0] else [(1, 0)]
        ahead = grid.shaped(grid.boxed(grid.boxed(y, max(half, box_s)), half), one) if half else 0
        filament = filament + filtered(part, one) + ahead
    change = grid.change(lambda m: m.end_mm[3] - m.start_mm[3])
    found["e"] = _peak(filament, extruder.speed_mm_s, extruder.accel_mm_s2, change)
    motors = [row for row in machine.core_spec()["steppers"] if row["drive"] == "actuator"]
    if all(row["speed"] < inf for row in motors):
        points = np.array(axes)[:, ::PER_MS].T
        places = np.array([machine.geometry.inverse(tuple(point)) for point in points])
        for row in motors:
            law = np.repeat(places[:, row["index"]], PER_MS)
            found[row["name"]] = _peak(law, row["speed"], row["accel"])
    return found


def exceeded(machine, found):
    """A sentence for each part that is faster than its limit, or harder than its limit and what the
    box makes of a corner allow. A delta's slopes are those beside the plan: 1 % more."""
    box_s = machine.core_spec()["filters"]["box_s"]
    sentences = []
    for name, peak in found.items():
        hardest = peak.accel_limit + (peak.change / box_s if box_s else 0)
        if peak.speed > 1.01 * peak.speed_limit:
            sentences.append(f"{name}: {peak.speed:.1f} mm/s of {peak.speed_limit:g}")
        if peak.accel > 1.01 * hardest:
            sentences.append(f"{name}: {peak.accel:.0f} mm/s² of {hardest:.0f}")
    return sentences


def filtered(machine):
    """The machine with different shapers of X, Y and Z, pressure advance and a limit of jerk."""
    return machine.model_copy(
        update={
            "shaping": {
                "x": Shaping(type="mzv", frequency_hz=40.0),
                "y": Shaping(type="3hump_ei", frequency_hz=30.0, damping=0.05),
                "z": Shaping(type="zv", frequency_hz=60.0),
            },
            "limits": machine.limits.model_copy(update={"jerk_mm_s3": 2e5}),
            "extruders": {
                name: extruder.model_copy(update={"advance_s": 0.05})
                for name, extruder in machine.extruders.items()
            },
        }
    )


def beginning(text, lines):
    """The first moves of a sliced file, around the place where a machine is after homing."""
    kept = [line.split(";")[0] for line in text.splitlines()]
    kept = [x for x in kept if x.startswith("G92 E") or (x.split() or [""])[0] in _KEPT][:lines]
    middle = []
    for axis in "XY":
        places = [float(n) for x in kept for n in re.findall(rf"{axis}(-?[0-9.]+)", x)]
        middle.append(f"{axis}{(min(places) + max(places)) / 2:.3f}")
    return "\n".join(["G28", "M302 S0", "G1 Z5 F600", f"G92 {' '.join(middle)}", *kept, ""])


def printed(machine, path):
    """The peaks of a print, and where its motors end, in steps."""
    job = Print(machine, Policy())
    job.job.results.keep_moves(True)
    job.run(str(path))
    return peaks(machine, job.job.results.take_moves()), [
        m["count"] for m in job.job.motors.statistics()
    ]
