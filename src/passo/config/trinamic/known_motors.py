"""Motors whose constants are known by their names."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

Constants = dict[str, float]
"""The keys of `MotorConstants` with their values."""


@cache
def known_motors() -> dict[str, Constants]:
    """The constants of the motors of motors.toml, by their names in lower case."""
    return tomllib.loads(Path(__file__).with_name("motors.toml").read_text(encoding="utf-8"))
