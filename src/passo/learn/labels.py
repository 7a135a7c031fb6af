"""Times as text."""

from __future__ import annotations


def duration(seconds: float) -> str:
    """A duration as `1 h 02 min 03 s`, without leading zero parts; with tenths below a minute."""
    if round(seconds, 1) < 60:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min {rest:02} s" if hours else f"{minutes} min {rest:02} s"
