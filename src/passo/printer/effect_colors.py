"""The colours of an effect at a time: pure calculations."""

from __future__ import annotations

from math import cos, pi
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from passo.config.light_effects import LightEffect
    from passo.config.lights import Color

_DARK: Color = (0.0, 0.0, 0.0, 0.0)
_TAIL = 4  # LEDs of a chase
_FLICKERS_S = 8.0  # changes of a fire per second


class Seen(NamedTuple):
    """What an effect depends on: the time since its start, s; the temperature and the target of its
    heater, °C; the fraction of the print that is done. None: it is not known."""

    time_s: float
    celsius: float | None = None
    target_c: float | None = None
    progress: float | None = None


def effect_colors(effect: LightEffect, count: int, seen: Seen) -> list[Color]:
    """The colours of `count` LEDs."""
    colors = [_color(one) for one in effect.colors]
    rounds = seen.time_s / effect.period_s
    if effect.kind == "breathing":
        bright = (1 - cos(2 * pi * rounds)) / 2
        return [_scaled(colors[int(rounds) % len(colors)], bright)] * count
    if effect.kind == "blink":
        turns = colors if len(colors) > 1 else [*colors, _DARK]
        return [turns[int(rounds * len(turns)) % len(turns)]] * count
    if effect.kind == "gradient":
        return [_around(colors, i / count + rounds) for i in range(count)]
    if effect.kind == "chase":
        return [_chased(colors, int(rounds * count) - i, count) for i in range(count)]
    if effect.kind == "fire":
        moment = int(seen.time_s * _FLICKERS_S)
        return [_between(colors, _random(moment * 977 + i)) for i in range(count)]
    if effect.kind == "heater":
        return [_between(colors, _warmth(effect, seen))] * count
    if effect.kind == "progress":
        lit = round((seen.progress or 0.0) * count)
        rest = colors[1] if len(colors) > 1 else _DARK
        return [colors[0]] * lit + [rest] * (count - lit)
    return [colors[0]] * count


def _color(values: Sequence[float]) -> Color:
    red, green, blue, white = (*values, 0.0)[:4]
    return red, green, blue, white


def _scaled(color: Color, share: float) -> Color:
    red, green, blue, white = (value * share for value in color)
    return red, green, blue, white


def _mixed(a: Color, b: Color, share: float) -> Color:
    red, green, blue, white = (x + (y - x) * share for x, y in zip(a, b, strict=True))
    return red, green, blue, white


def _between(colors: Sequence[Color], share: float) -> Color:
    """From the first colour at 0 to the last at 1."""
    at = min(max(share, 0.0), 1.0) * (len(colors) - 1)
    first = min(int(at), len(colors) - 1)
    return _mixed(colors[first], colors[min(first + 1, len(colors) - 1)], at - first)


def _around(colors: Sequence[Color], turns: float) -> Color:
    """Like `_between`, and back to the first colour."""
    return _between([*colors, colors[0]], turns % 1.0)


def _chased(colors: Sequence[Color], behind: int, count: int) -> Color:
    behind %= count
    if behind >= min(_TAIL, count):
        return _DARK
    return _scaled(colors[behind % len(colors)], 1 - behind / _TAIL)


def _warmth(effect: LightEffect, seen: Seen) -> float:
    high_c = effect.high_c if effect.high_c is not None else seen.target_c
    if seen.celsius is None or not high_c or high_c <= effect.low_c:
        return 0.0
    return (seen.celsius - effect.low_c) / (high_c - effect.low_c)


def _random(number: int) -> float:
    """0 to 1, the same for the same number."""
    number = (number * 1664525 + 1013904223) & 0xFFFFFFFF
    number = (number ^ number >> 15) * 2246822519 & 0xFFFFFFFF
    return (number >> 8) / (1 << 24)
