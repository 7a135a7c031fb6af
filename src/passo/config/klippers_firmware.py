"""Boards with Klipper's firmware."""

from __future__ import annotations

from collections.abc import Mapping

NAME = "klipper"
# Until the firmware has reported its clock: that of the slowest boards, which plans for all.
ASSUMED_CLOCK_HZ = 16_000_000


def runs_klippers(board: Mapping[str, object]) -> bool:
    """Whether the board of a table of a machine file, or of a board file, runs Klipper's firmware.
    The keys of its shipped board must be in the table."""
    return NAME in (board.get("base"), board.get("mcu"), board.get("firmware"))
