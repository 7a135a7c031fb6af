"""Times as text, and round values for the axes of charts. `page.js` has the same rules for the
visible part of a chart."""

from __future__ import annotations

import math

_SECONDS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14_400, 28_800, 86_400)
_CLOCK_S = 120.0  # longer times are shown in clock form
_HOUR_S = 3600.0


def round_step(span: float, most: int) -> float:
    """The smallest of 1, 2 and 5 times a power of ten that divides `span` into at most `most`
    parts."""
    if not span > 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(
        step * power for step in (1, 2, 5, 10, 20) if step * power * most >= span * 0.999999
    )


def time_step(span_s: float, most: int) -> float:
    """Like `round_step`, for times: a step of at least a second divides a minute, an hour or a
    day."""
    if span_s <= _SECONDS[0] * most:
        return round_step(span_s, most)
    return next(
        (float(s) for s in _SECONDS if s * most >= span_s),
        86_400.0 * math.ceil(span_s / most / 86_400),
    )


def ticks(low: float, high: float, step: float) -> list[float]:
    """The multiples of `step` from `low` to `high`."""
    first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    return [i * step for i in range(first, last + 1)]


def label(value: float, step: float) -> str:
    """A number with as many decimals as the step between labels needs."""
    text = f"{value:,.{max(0, -math.floor(math.log10(step) + 1e-9))}f}"
    return text.replace("-", "\N{MINUS SIGN}") if float(text.replace(",", "")) else text.lstrip("-")


def clock_label(seconds: float, step: float, longest_s: float) -> str:
    """A time as text: in seconds up to two minutes, otherwise as min:s, h:min or h:min:s (see
    `clock_unit`)."""
    if longest_s <= _CLOCK_S:
        return label(seconds, step)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9)) if step < 1 else 0
    whole = round(seconds, decimals)
    minutes, rest = int(whole // 60), whole % 60
    tail = f":{rest:0{decimals + 3 if decimals else 2}.{decimals}f}"
    if longest_s <= _HOUR_S:
        return f"{minutes}{tail}"
    return f"{minutes // 60}:{minutes % 60:02}{tail if step < 60 else ''}"


def clock_unit(step: float, longest_s: float) -> str:
    """The unit of `clock_label`."""
    if longest_s <= _CLOCK_S:
        return "s"
    if longest_s <= _HOUR_S:
        return "min:s"
    return "h:min" if step >= 60 else "h:min:s"


def duration(seconds: float) -> str:
    """A duration as `1 h 02 min 03 s`, without leading zero parts; with tenths below a minute."""
    if round(seconds, 1) < 60:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min {rest:02} s" if hours else f"{minutes} min {rest:02} s"
