"""Errors of lights."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus

LIGHT: Mapping[str, Entry] = {
    "light.late": Entry(
        "board",
        "light {axis}: the board could not send a frame in 8 attempts, because of its other work",
        "Put the light on a board with fewer motors, or shorten its chain",
        ExitStatus.MACHINE_FAULT,
    ),
}
