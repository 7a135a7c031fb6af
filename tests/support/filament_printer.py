"""An i3 with filament sensors or buttons on free pins, and files that it prints."""

from __future__ import annotations

from pathlib import Path

from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig

PARK = (5.0, 180.0)
INPUT = "filament-roll"
ENDED = "filament has ended"


def with_inputs(text: str, machine: str = "i3") -> MachineConfig:
    """A shipped machine that parks, with these further tables."""
    shipped = f"{shipped_text(machine)}\n[park]\nposition_mm = {list(PARK)}\n"
    return load_text(shipped + text, "inputs.toml")


def with_sensor(keys: str = "", *, length_mm: float | None = None) -> MachineConfig:
    """One filament sensor; its filament has this length."""
    table = f'[filament_sensors.roll]\npin = "^D32"\n{keys}\n'
    length = "" if length_mm is None else f"[simulated]\nfilament_mm = {{ roll = {length_mm} }}\n"
    return with_inputs(table + length)


def printing(s: Scenario, folder: Path, *lines: str, name: str = "a.g") -> None:
    """Starts to print a file of these lines, with cold filament, at X 20 Y 20 Z 20 mm."""
    head = ["G92 X20 Y20 Z20", "M83", "M302 P1", "G1 X50 Y40 F6000"]
    (folder / name).write_text("\n".join([*head, *lines]) + "\n")
    s.host.ok(f"M32 {name}")


def turns(count: int = 40, line: str = "G1 X{x} Y{y} E0.1 F1500") -> list[str]:
    """Moves of 20 mm each that print."""
    return [line.format(x=50 + 20 * (i % 2), y=40 + i) for i in range(count)]
