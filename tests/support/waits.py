"""Programs that wait for temperatures, one for each kind of wait, and what is warm after them."""

from __future__ import annotations

from typing import NamedTuple

from passo import config
from passo.config.machine import MachineConfig

NEAR_C = 1.6  # a wait ends this close to its target


class Waits(NamedTuple):
    """`lines` of a program; after them the heaters have the temperatures of `warm`, °C."""

    lines: tuple[str, ...]
    warm: dict[str, float]
    machine: str = "i3"


WAITS = {
    "M109 S": Waits(("M109 S60",), {"hotend": 60}),
    "M109 without S": Waits(("M104 S60", "M109"), {"hotend": 60}),
    "M109 R": Waits(("M109 S90", "M106 S255", "M109 R60"), {"hotend": 60}),
    "M190 S": Waits(("M140 S35", "M190 S35"), {"bed": 35}),
    "M191 S": Waits(("M191 S35",), {"bed": 35}, "chamber"),
    "M116": Waits(("M104 S60", "M140 S35", "M116"), {"hotend": 60, "bed": 35}),
    "M116 T": Waits(("M104 S60", "M116 T0"), {"hotend": 60}),
    "G10 P": Waits(("G10 P0 S60 R40", "M116"), {"hotend": 60}),
    "G10 P, T": Waits(("G10 P1 S60 R40", "T1", "M116 T1"), {"hotend1": 60}, "dual-extruder"),
    "a material": Waits(("M145 S2 H60 B35 F0", "M104 I2", "M190 I2", "M109"), {"hotend": 60}),
}


def machine(name: str) -> MachineConfig:
    """A machine of this name; `chamber` is one that heats its chamber in place of its bed."""
    if name != "chamber":
        return config.load(name)
    text = config.shipped_text("i3").replace('kind = "bed"', 'kind = "chamber"', 1)
    return config.load_text(text)
