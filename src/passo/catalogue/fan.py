"""Errors of fans."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus

FAN: Mapping[str, Entry] = {
    "fan.slow": Entry(
        "fan",
        "fan {axis} has power and turns at {value:.0f} rpm, below its minimum of {limit:.0f} rpm",
        "Check that the fan turns, and the plug and the wire of its tachometer",
        ExitStatus.MACHINE_FAULT,
    ),
}
