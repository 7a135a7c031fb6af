"""Input shapers: the impulses of each type for a frequency and a damping ratio.

Formulas: zv and zvd (Singer and Seering, 1990); mzv, ei, 2hump_ei and 3hump_ei as Klipper defines
them (Klipper's documentation of resonance compensation; ei by a fit for a vibration tolerance, 0.05
by default, the hump types by cubics of the damping ratio).
"""

from __future__ import annotations

import re
from itertools import accumulate
from math import exp, pi, sqrt
from typing import Literal, get_args

ShaperType = Literal["zv", "mzv", "zvd", "ei", "2hump_ei", "3hump_ei"]
SHAPER_TYPES: tuple[ShaperType, ...] = get_args(ShaperType)
MIN_HZ, MAX_HZ = 15.0, 500.0
_MAX_DAMPING: dict[ShaperType, float] = {
    "zv": 0.99,
    "mzv": 0.99,
    "zvd": 0.99,
    "ei": 0.4,
    "2hump_ei": 0.3,
    "3hump_ei": 0.2,
}
DEFAULT_TYPE: ShaperType = "mzv"
DEFAULT_DAMPING = 0.1
DEFAULT_TOLERANCE = 0.05  # residual vibration of `ei` at its frequency
MAX_TOLERANCE = 0.2  # above it the fit of `ei` is off by more than 5 %
SHAPER_FORMS = f"{', '.join(SHAPER_TYPES)}, or ei(v_tol=0.02) with at most {MAX_TOLERANCE:g}"
SHAPER_PATTERN = (  # forms as machine files write them
    rf"^(?:{'|'.join(SHAPER_TYPES)}|ei\(v_tol=0?\.(?:0\d*[1-9]\d*|1\d*|20*)\))$"
)
_WITH_TOLERANCE = re.compile(r"ei\s*\(\s*(?:v_tol\s*=\s*)?(\d*\.?\d+|\d+\.)\s*\)")

Impulses = list[tuple[float, float]]
_Cubic = tuple[float, float, float, float]  # by powers of the damping ratio, the lowest first
_HUMPS: dict[ShaperType, tuple[tuple[_Cubic, ...], tuple[_Cubic, ...]]] = {
    "2hump_ei": (
        (
            (0.16054, 0.76699, 2.2656, -1.2275),
            (0.33911, 0.45081, -2.5808, 1.7365),
            (0.34089, -0.61533, -0.68765, 0.42261),
            (0.15997, -0.60246, 1.0028, -0.93145),
        ),
        (
            (0.0, 0.0, 0.0, 0.0),
            (0.49890, 0.16270, -0.54262, 6.1618),
            (0.99748, 0.18382, -1.5827, 8.1712),
            (1.4992, -0.09297, -0.28338, 1.8571),
        ),
    ),
    "3hump_ei": (
        (
            (0.11275, 0.76632, 3.2916, -1.4438),
            (0.23698, 0.61164, -2.5785, 4.8522),
            (0.30008, -0.19062, -2.1456, 0.13744),
            (0.23775, -0.73297, 0.46885, -2.0865),
            (0.11244, -0.45439, 0.96382, -1.46),
        ),
        (
            (0.0, 0.0, 0.0, 0.0),
            (0.49974, 0.23834, 0.44559, 12.472),
            (0.99849, 0.29808, -2.3646, 23.399),
            (1.4987, 0.10306, -2.0139, 17.032),
            (1.9996, -0.28231, 0.61536, 5.4045),
        ),
    ),
}


def shaper_form(text: str) -> str:
    """A type in its shortest form: one of SHAPER_TYPES, or `ei(v_tol=0.02)` with the residual
    vibration at the frequency of the shaper, as Klipper writes it. Raises ValueError."""
    kind, tolerance = split_form(text)
    return kind if tolerance == DEFAULT_TOLERANCE else f"{kind}(v_tol={tolerance:g})"


def split_form(text: str) -> tuple[ShaperType, float]:
    """The type of a form, and its residual vibration. Raises ValueError."""
    lower = text.strip().lower()
    for kind in SHAPER_TYPES:
        if lower == kind:
            return kind, DEFAULT_TOLERANCE
    match = _WITH_TOLERANCE.fullmatch(lower)
    tolerance = float(match[1]) if match else 0.0
    if not 0 < tolerance <= MAX_TOLERANCE:
        raise ValueError(f"expected {SHAPER_FORMS}")
    return "ei", tolerance


def max_damping(form: str) -> float:
    """The largest damping ratio that this form allows."""
    return _MAX_DAMPING[split_form(form)[0]]


def impulses(form: str, frequency_hz: float, damping: float) -> Impulses:
    """The impulses as (weight, seconds from the first one). The weights add up to 1. Weights are
    rounded to 2^-40 and times to 1 ns, so that they are the same on every computer. `damping` is at
    most `max_damping`. Raises ValueError for an unknown form."""
    kind, tolerance = split_form(form)
    root = sqrt(1 - damping * damping)
    cycle = 1 / (frequency_hz * root)  # s, of the damped vibration
    decay = exp(-damping * pi / root)  # over half of it
    if kind == "zv":
        weights, times = [1.0, decay], [0.0, 0.5 * cycle]
    elif kind == "zvd":
        weights, times = [1.0, 2 * decay, decay**2], [0.0, 0.5 * cycle, cycle]
    elif kind == "mzv":
        k = exp(-0.75 * damping * pi / root)
        half = 1 - sqrt(0.5)
        weights = [half, (sqrt(2) - 1) * k, half * k * k]
        times = [0.0, 0.375 * cycle, 0.75 * cycle]
    elif kind == "ei":
        weights, times = _ei(damping, cycle, tolerance)
    else:
        of_weight, of_time = _HUMPS[kind]
        weights = [_cubic(c, damping) for c in of_weight]
        times = [_cubic(c, damping) / frequency_hz for c in of_time]
    total = sum(weights)
    rounded = [round(weight / total * 2**40) / 2**40 for weight in weights[:-1]]
    rounded.append(1 - sum(rounded))
    return list(zip(rounded, (round(t * 1e9) / 1e9 for t in times), strict=True))


def _ei(damping: float, cycle: float, tolerance: float) -> tuple[list[float], list[float]]:
    v, z = tolerance, damping
    first = 0.24968 + 0.24961 * v + ((0.80008 + 1.23328 * v) + (0.49599 + 3.17316 * v) * z) * z
    third = 0.25149 + 0.21474 * v + ((-0.83249 + 1.41498 * v) + (0.85181 - 4.90094 * v) * z) * z
    middle = 0.4999 + z * v * (
        (0.46159 + 8.57843 * v) + ((4.26169 - 108.644 * v) + (1.75601 + 336.989 * v) * z) * z
    )
    return [first, 1 - first - third, third], [0.0, middle * cycle, cycle]


def _cubic(coefficients: _Cubic, x: float) -> float:
    return sum(c * power for c, power in zip(coefficients, _powers(x), strict=True))


def _powers(x: float) -> list[float]:
    return list(accumulate([1.0, x, x, x], lambda a, b: a * b))
