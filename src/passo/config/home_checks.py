"""What only a machine whose parts are all sound can tell about its home."""

from __future__ import annotations

from collections.abc import Iterator

from passo.config.findings import Finding
from passo.config.machine import MachineConfig
from passo.geometry.base import Unreachable


def check_home(machine: MachineConfig) -> Iterator[Finding]:
    """With all arms at their switches the nozzle is somewhere."""
    arms = [name for name in machine.geometry.arms if name in machine.homing]
    if len(arms) < len(machine.geometry.arms) or not arms:
        return
    a, b, c = (
        machine.homing[name].position if name in machine.homing else 0.0
        for name in machine.geometry.actuators
    )
    try:
        machine.geometry.forward((a, b, c))
    except Unreachable as error:
        limit = f"a place where the nozzle can be: {error}"
        value = machine.homing[arms[0]].position
        yield Finding("config.value", ("homing", arms[0], "position"), value, limit)
