"""A quantity over time in bounded memory."""

from __future__ import annotations

import math
import sys
from array import array
from base64 import b64encode
from collections.abc import Iterator

MAX_CORNERS = 16_384
MAX_COLUMNS = 16_384
_EMPTY = -32_768  # 16-bit mark of a column without values
_LARGEST = 32_767


class Columns:
    """Columns of equal width from time 0 on, each with the range and the integral of a quantity."""

    def __init__(self, width_s: float) -> None:
        self.width_s = width_s
        self.lows, self.highs = array("d"), array("d")
        self.areas, self.spans_s = array("d"), array("d")  # integral and time of the known values

    def put(self, i: int, low: float, high: float, area: float, span_s: float) -> None:
        """Adds values to column `i`: their range, their integral `area`, and their duration."""
        while len(self.lows) <= i:
            self.lows.append(math.inf)
            self.highs.append(-math.inf)
            self.areas.append(0.0)
            self.spans_s.append(0.0)
        if low < self.lows[i]:
            self.lows[i] = low
        if high > self.highs[i]:
            self.highs[i] = high
        self.areas[i] += area
        self.spans_s[i] += span_s

    def add(self, start_s: float, start: float, end_s: float, end: float) -> None:
        """Adds a linear part from one time and value to another."""
        width = self.width_s
        first, last = int(start_s / width), math.ceil(end_s / width) - 1
        if last <= first:
            low, high = (start, end) if start < end else (end, start)
            if first >= len(self.lows):
                self.put(first, low, high, 0.0, 0.0)
            if low < self.lows[first]:  # `put` inlined for speed: most parts are within one column
                self.lows[first] = low
            if high > self.highs[first]:
                self.highs[first] = high
            self.areas[first] += (start + end) / 2 * (end_s - start_s)
            self.spans_s[first] += end_s - start_s
            return
        slope = (end - start) / (end_s - start_s)
        before, value = start_s, start
        for i in range(first, last + 1):
            after = min(end_s, (i + 1) * width)
            if after <= before:
                continue
            then = start + slope * (after - start_s)
            low, high = (value, then) if value < then else (then, value)
            self.put(i, low, high, (value + then) / 2 * (after - before), after - before)
            before, value = after, then

    def known(self) -> Iterator[tuple[int, float, float, float, float]]:
        """Index, lowest, highest, integral and time of each column with values."""
        for i, span_s in enumerate(self.spans_s):
            if span_s > 0:
                yield i, self.lows[i], self.highs[i], self.areas[i], span_s

    def joined(self, width_s: float) -> Columns:
        """A copy with wider columns."""
        wide = Columns(width_s)
        for i, low, high, area, span_s in self.known():
            wide.put(int((i + 0.5) * self.width_s / width_s), low, high, area, span_s)
        return wide


class Series:
    """Linear parts in the order of time. They are stored exactly up to MAX_CORNERS corners. After
    that they become at most MAX_COLUMNS columns of equal width, each with the minimum, the maximum
    and the mean. If there are too many columns, pairs of them are joined, so that the memory is
    bounded for a job of any length."""

    def __init__(self) -> None:
        self.times_s, self.values = array("d"), array("d")  # times and values of the corners
        self.columns: Columns | None = None  # None: the series is exact
        self.end_s = 0.0
        self._last = 0.0

    def __bool__(self) -> bool:
        """False while the series is empty."""
        return self.end_s > 0

    @property
    def width_s(self) -> float:
        """Width of a column; 0: the series is exact."""
        return self.columns.width_s if self.columns else 0.0

    def add(self, start_s: float, start: float, end_s: float, end: float) -> None:
        """Adds a part that begins at the end time of the previous one; the value may jump."""
        if end_s <= start_s:
            return
        self.end_s, self._last = end_s, end
        if self.columns is not None:
            if end_s > self.columns.width_s * MAX_COLUMNS:
                self.columns = self.columns.joined(_width_s(end_s))
            self.columns.add(start_s, start, end_s, end)
            return
        times, values = self.times_s, self.values
        flat = len(times) > 1 and values[-2] == values[-1] == start == end
        if flat and times[-2] < times[-1]:
            times[-1] = end_s
            return
        if not times or values[-1] != start:
            times.append(start_s)
            values.append(start)
        times.append(end_s)
        values.append(end)
        if len(times) > MAX_CORNERS:
            self.columns = self._columns(_width_s(end_s), end_s)
            self.times_s, self.values = array("d"), array("d")

    def hold(self, end_s: float) -> None:
        """Extends the last value to `end_s`."""
        self.add(self.end_s, self._last, end_s, self._last)

    def range(self) -> tuple[float, float]:
        """The minimum and the maximum; 0 and 0 for an empty series."""
        if self.columns is None:
            return min(self.values, default=0.0), max(self.values, default=0.0)
        return (
            min(low for _, low, _, _, _ in self.columns.known()),
            max(high for _, _, high, _, _ in self.columns.known()),
        )

    def encoded(self) -> dict[str, object]:
        """The series for a page. An exact series has `s`, the time differences of its corners, and
        `v`, their values, as float32 in base64. Columns have their width `w`, and `low`, `high`,
        `mean` as int16 in base64, in units of `scale`; -32768 means no values."""
        if self.columns is None:
            times = self.times_s
            steps = [t - (times[i - 1] if i else 0.0) for i, t in enumerate(times)]
            return {"s": packed(array("f", steps)), "v": packed(array("f", self.values))}
        low, high = self.range()
        scale = max(abs(low), abs(high)) / _LARGEST or 1.0
        size = len(self.columns.lows)
        lows, highs, means = (array("h", [_EMPTY]) * size for _ in range(3))
        for i, low, high, area, span_s in self.columns.known():
            lows[i], highs[i] = round(low / scale), round(high / scale)
            means[i] = round(area / span_s / scale)
        rows = {"low": packed(lows), "high": packed(highs), "mean": packed(means)}
        return {"w": self.columns.width_s, "scale": scale, **rows}

    def _columns(self, width_s: float, end_s: float) -> Columns:
        """Converts the exact parts up to `end_s` to columns."""
        columns, t, v = Columns(width_s), self.times_s, self.values
        for i in range(1, len(t)):
            if t[i - 1] < t[i] <= end_s:
                columns.add(t[i - 1], v[i - 1], t[i], v[i])
            elif t[i - 1] < end_s < t[i]:
                part = (end_s - t[i - 1]) / (t[i] - t[i - 1])
                columns.add(t[i - 1], v[i - 1], end_s, v[i - 1] + part * (v[i] - v[i - 1]))
        return columns


def _width_s(end_s: float) -> float:
    """The width of columns for a time up to `end_s`: a power of two, so that columns can be joined
    in pairs."""
    return 2.0 ** math.ceil(math.log2(end_s / MAX_COLUMNS))


def packed(numbers: array[float] | array[int]) -> str:
    """Numbers for a page: little-endian in base64."""
    if sys.byteorder == "big":
        numbers = numbers[:]
        numbers.byteswap()
    return b64encode(numbers.tobytes()).decode("ascii")
