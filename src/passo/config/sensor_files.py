"""Reads tables of sensors from files that the machine file names."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from passo.config.companion_files import read_companion
from passo.config.findings import Finding, parts_with_sensors, table

# a substitute, so that the models do not report the same error again
_ANY_POINTS = [[0.0, 1.0], [300.0, 0.0]]


def with_sensor_files(data: dict[str, Any], folder: Path) -> Iterator[Finding]:
    """Replaces each `file` of a sensor in `data` by its points; paths are relative to `folder`."""
    for part, name, content in parts_with_sensors(data):
        sensor = table(content, "sensor")
        file = sensor.get("file")
        if sensor.get("kind") != "table" or not isinstance(file, str):
            continue
        path = (part, name, "sensor", "file")
        if "points" in sensor:
            yield Finding("config.conflict", path, file, "either file or points")
            continue
        points = _ANY_POINTS
        try:
            points = _points(read_companion(folder, file).decode())
        except (OSError, ValueError) as error:
            reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
            yield Finding("config.value", path, file, f"a table that can be read ({reason})")
        data[part][name] = {**content, "sensor": {**sensor, "points": points}}


def _points(text: str) -> list[list[float]]:
    """Parses lines `°C, fraction`; ignores empty lines and text after a #. Raises ValueError."""
    points: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].split(",")
        if words == [""] or not line.strip():
            continue
        try:
            celsius, share = (float(word) for word in words)
        except ValueError:
            raise ValueError(f"line {number} is no `°C, share`") from None
        points.append([celsius, share])
    return points
