"""Coloured lights: their kinds, orders of colours and start colours. Rows of the table have the
rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.draft import Value
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_KINDS = ("neopixel", "dotstar", "led", "pca9632", "pca9533")
_COLORS = ("red", "green", "blue", "white")


def put_lights(job: Import) -> dict[str, str]:
    """Imports all lights. Klipper has a name for each kind; the machine file has one for each
    light. Returns the names of the lights by the names of their sections, in lower case."""
    used: set[str] = set()
    found: dict[str, str] = {}
    for section in job.config.sections.values():
        if section.kind in _KINDS:
            name = part_name(section.rest or section.kind)
            name = f"{name}_{section.kind}" if name in used else name
            used.add(name)
            if job.part(
                section, lambda job, section, name=name: _put(job, section, name), "the light"
            ):
                found[section.name.lower()] = name
    return found


def _put(job: Import, section: Section, name: str) -> None:
    path, put = ("lights", name), job.put_value
    put((*path, "kind"), section, "pin", section.kind)
    job.put(section.kind, section, name=name)
    if section.flag("hardware_pwm", default=False):
        put((*path, "pwm"), section, "hardware_pwm", "hardware")
    default = "GRB" if section.kind == "neopixel" else "RGBW"
    text = section.text("color_order", default).upper().replace(" ", "")
    orders: list[Value] = [*text.split(",")]
    if section.kind == "neopixel" and len(set(orders)) > 1:
        put((*path, "orders"), section, "color_order", orders)
    elif section.kind in ("neopixel", "pca9632"):
        put((*path, "order"), section, "color_order", orders[0])
    start: list[Value] = [section.number(f"initial_{color}") or 0.0 for color in _COLORS]
    put((*path, "start"), section, "initial_red", start if any(start) else None)
