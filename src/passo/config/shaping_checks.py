"""Checks the input shapers of a machine file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.config.findings import Finding
from passo.config.shapers import MAX_DAMPING

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def check_shaping(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the type allows the damping ratio, and that the machine has no laser whose power
    follows the motion."""
    for name, shaping in machine.shaping.items():
        most = MAX_DAMPING[shaping.type]
        if shaping.damping > most:
            limit = f"at most {most:g} for the type {shaping.type}"
            yield Finding("config.value", ("shaping", name, "damping"), shaping.damping, limit)
        if machine.laser is not None:
            limit = "no shaping on a machine with a laser, whose power follows the plan"
            yield Finding("config.conflict", ("shaping", name, "type"), shaping.type, limit)
