"""A picture of a spectrum, as SVG: the measured density, what each shaper leaves of it, and
the shapers themselves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from math import ceil, floor, log10

_WIDTH, _HEIGHT = 860, 480
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 60, 46, 150
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#ff7f0e", "#9467bd", "#17becf")
_STYLE = (
    "text{font:12px sans-serif;fill:#222}.title{font-size:15px;font-weight:bold}"
    ".grid{stroke:#ddd;fill:none}.line{fill:none;stroke-width:1.6}"
    ".thin{stroke-width:1;stroke-dasharray:4 3}.end{text-anchor:end}.mid{text-anchor:middle}"
)

Curve = tuple[str, Sequence[float], bool]
"""The name of a curve, its values, and whether it is a share of 0 to 1 on the right-hand scale."""


def picture(title: str, hz: Sequence[float], curves: Sequence[Curve], notes: Iterable[str]) -> str:
    """The picture. The frequencies `hz` ascend; a curve has a value for each of them. `notes` are
    lines below it."""
    high_hz = _round_up(max(hz))
    largest = max((max(values) for _, values, share in curves if not share), default=1.0) or 1.0
    shares = any(share for _, _, share in curves)
    exponent = floor(log10(largest))
    high = ceil(largest / 10**exponent * 2) / 2 * 10**exponent
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img"'
        f' aria-label="{escape(title, quote=True)}"><style>{_STYLE}</style>',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="#fff"/>',
        f'<text class="title" x="{_LEFT}" y="24">{escape(title)}</text>',
    ]
    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    for k in range(6):
        y = _y(k / 5)
        parts.append(f'<path class="grid" d="M{_LEFT} {y:.1f}H{right}"/>')
        value = f"{k / 5 * high / 10**exponent:.1f}"
        parts.append(f'<text class="end" x="{_LEFT - 6}" y="{y + 4:.1f}">{value}</text>')
        if shares:
            parts.append(f'<text x="{right + 6}" y="{y + 4:.1f}">{k * 20} %</text>')
    step = _round_up(high_hz / 10)
    for k in range(int(high_hz / step + 1e-9) + 1):
        x = _x(k * step, high_hz)
        parts.append(f'<path class="grid" d="M{x:.1f} {_TOP}V{bottom}"/>')
        parts.append(f'<text class="mid" x="{x:.1f}" y="{bottom + 16}">{k * step:g}</text>')
    parts.append(f'<text class="mid" x="{(_LEFT + right) / 2}" y="{bottom + 32}">Hz</text>')
    unit = f"density, 10^{exponent} (mm/s²)²/Hz²"
    parts.append(f'<text x="{_LEFT}" y="{_TOP - 6}">{unit}</text>')
    for number, (name, values, share) in enumerate(curves):
        colour = _COLOURS[number % len(_COLOURS)]
        scale = 1.0 if share else high
        points = "L".join(
            f"{_x(f, high_hz):.1f} {_y(value / scale):.1f}"
            for f, value in zip(hz, values, strict=True)
        )
        thin = " thin" if share else ""
        parts.append(f'<path class="line{thin}" stroke="{colour}" d="M{points}"/>')
        x, y = _LEFT + number % 3 * 240, bottom + 54 + number // 3 * 18
        parts.append(f'<path class="line{thin}" stroke="{colour}" d="M{x} {y - 4}h22"/>')
        parts.append(f'<text x="{x + 28}" y="{y}">{escape(name)}</text>')
    for number, note in enumerate(notes):
        parts.append(f'<text x="{_LEFT}" y="{bottom + 96 + 18 * number}">{escape(note)}</text>')
    return "\n".join([*parts, "</svg>", ""])


def _x(hz: float, high_hz: float) -> float:
    return _LEFT + (_WIDTH - _RIGHT - _LEFT) * hz / high_hz


def _y(share: float) -> float:
    return _HEIGHT - _BOTTOM - (_HEIGHT - _BOTTOM - _TOP) * share


def _round_up(value: float) -> float:
    """The next 1, 2 or 5 times a power of 10."""
    power = 10.0 ** floor(log10(value))
    return next(n * power for n in (1, 2, 5, 10) if n * power >= value * (1 - 1e-9))
