"""Shipped machines with lines of their own, at home, and their answers."""

from __future__ import annotations

from typing import Any

from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig

Change = tuple[str, str]
STILL = ("noise_mm = 0.002\n", "")
"""The change that takes the noise off the probe of i3-probe and i3-two-z."""


def edited(name: str, *changes: Change, more: str = "") -> MachineConfig:
    """A shipped machine whose file has a text in place of another for each change, and `more` at
    its end."""
    text = shipped_text(name)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return load_text(f"{text}\n{more}")


def at_home(machine: MachineConfig, **options: Any) -> Scenario:
    """A printer whose axes are homed."""
    s = Scenario(machine, **options)
    s.host.ok("G28", 60)
    return s


def answers(s: Scenario, line: str, within: float = 900) -> list[str]:
    """What a command answers before its ok."""
    return [x for x in s.host.ok(line, within) if x not in ("ok", "echo:busy: processing")]
