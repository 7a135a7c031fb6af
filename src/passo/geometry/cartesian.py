"""Cartesian: one motor for each axis."""

from __future__ import annotations

from typing import Literal

from passo.geometry.skewable import SkewableModel


class Cartesian(SkewableModel):
    """Every axis has its own motor."""

    motors = ("x", "y", "z")
    kind: Literal["cartesian"]
    """A motor for each axis."""
