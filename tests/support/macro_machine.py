"""The machine i3 with macros."""

from __future__ import annotations

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig


def with_macros(text: str, machine: str = "i3") -> MachineConfig:
    """A shipped machine with these further tables in its file."""
    return load_text(shipped_text(machine) + "\n" + text, "macros.toml")


def macro(name: str, gcode: str, **keys: str) -> str:
    """A table of one macro; keys are TOML."""
    further = "".join(f"{key} = {value}\n" for key, value in keys.items())
    return f"[macros.{name}]\ngcode = '''\n{gcode}\n'''\n{further}"
