"""The path of a planned file as one binary, for a viewer: docs/reference/toolpath.md."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from passo import _core

_MAGIC = b"PASSOTP1"
# Name, type, numbers per row, unit of the values.
_COLUMNS = (
    ("at", "u2", 4, 1.0),
    ("time", "f4", 1, 1.0),  # s
    ("line", "u4", 1, 1.0),
    ("speed", "u2", 1, 0.02),  # mm/s, cruising speed
    ("flow", "u2", 1, 0.001),  # mm of filament per second, mean
    ("acceleration", "u2", 1, 1.0),  # mm/s²
    ("feature", "u1", 1, 1.0),
    ("speed_limit", "u1", 1, 1.0),
    ("acceleration_limit", "u1", 1, 1.0),
)


def encoded_toolpath(job: _core.Job, targets: Sequence[tuple[float, str, float]]) -> bytes:
    """The path of a completely planned job with `keep_toolpath`, with the `targets` of its heaters
    in the form of `Heating.targets`."""
    taken = job.results.take_toolpath()
    if taken is None:
        raise ValueError("the job does not keep its path")
    rows, origin_mm, unit_mm, end_s, layers, data = taken
    header = {
        "rows": rows,
        "origin_mm": origin_mm,
        "unit_mm": unit_mm,
        "end_s": end_s,
        "layers": [
            {"number": number, "row": row, "z_mm": round(z_mm, 4), "start_s": start_s}
            for row, z_mm, start_s, number in layers
        ],
        "features": [name or "other" for name in job.program.feature_names],
        "limits": job.limits.names,
        "targets": [
            {"time_s": round(time_s, 3), "heater": heater, "celsius": celsius}
            for time_s, heater, celsius in targets
        ],
        "columns": [
            {"name": name, "type": kind, "numbers": numbers, "unit": unit}
            for name, kind, numbers, unit in _COLUMNS
        ],
    }
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-(len(_MAGIC) + 4 + len(text)) % 8)
    return b"".join((_MAGIC, len(text).to_bytes(4, "little"), text, data))
