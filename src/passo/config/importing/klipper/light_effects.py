"""Effects of lights, of the plug-in led_effect: the first layer that Passo has as an effect."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

# The effects of the plug-in and those of Passo.
_KINDS = {
    "static": "steady",
    "breathing": "breathing",
    "blink": "blink",
    "strobe": "blink",
    "gradient": "gradient",
    "comet": "chase",
    "chase": "chase",
    "fire": "fire",
    "heater": "heater",
    "temperature": "heater",
    "progress": "progress",
}
_PER_SECOND = ("strobe", "gradient", "comet", "chase")  # the rate is not a duration
_LAYER = re.compile(r"^(\w+)\s+([-\d.]+)\s+([-\d.]+)\s+\w+\s+(\(.*\))$")
_COLOR = re.compile(r"\(([^()]*)\)")
_LEDS = re.compile(r"^(\w+):\s*(\S+)\s*(?:\(([\d,\s-]+)\))?$")
_SHORTEST_S, _LONGEST_S = 0.2, 3600.0
_OWN = ("frame_rate", "autostart", "leds", "layers", "heater", "run_on_error", "recalculate")


def put_light_effects(job: Import, lights: dict[str, str]) -> None:
    """Imports the effects. `lights` has the names of the imported lights by their sections."""
    for section in job.config.of("led_effect"):
        section.used.update(_OWN)
        job.part(section, lambda job, section: _put(job, section, lights), "the effect")


def _put(job: Import, section: Section, lights: dict[str, str]) -> None:
    layers = [_LAYER.match(line) for line in _lines(section, "layers")]
    chosen = next((layer for layer in layers if layer and layer[1] in _KINDS), None)
    if chosen is None:
        raise section.wrong("layers", f"an effect that Passo has: {', '.join(_KINDS)}")
    entry = _LEDS.match(next(iter(_lines(section, "leds")), ""))
    light = lights.get(f"{entry[1]} {entry[2]}".lower()) if entry else None
    if entry is None or light is None:
        raise section.wrong("leds", "one of the lights that Passo has")
    kind, place = chosen[1], section.at("layers")
    path, put = ("light_effects", part_name(section.rest)), job.draft.put
    colors: list[Any] = [_numbers(one) for one in _COLOR.findall(chosen[4])]
    put((*path, "light"), light, section.at("leds"))
    put((*path, "leds"), _indices(entry[3]) if entry[3] else None, section.at("leds"))
    put((*path, "kind"), _KINDS[kind], place)
    put((*path, "colors"), colors, place)
    rate, cutoff = float(chosen[2]), float(chosen[3])
    if _KINDS[kind] == "heater":
        heater = job.heater(section, "heater", section.text("heater", "extruder"))
        put((*path, "heater"), heater, section.at("heater"))
        put((*path, "low_c"), rate, place)
        put((*path, "high_c"), cutoff if kind == "temperature" else None, place)
    elif rate > 0 and kind != "static":
        period_s = 1 / rate if kind in _PER_SECOND else rate
        put((*path, "period_s"), min(max(period_s, _SHORTEST_S), _LONGEST_S), place)
    starts = section.text("autostart").lower() in ("true", "1", "yes")
    put((*path, "starts"), True if starts else None, section.at("autostart"))
    text = f"it becomes an effect of the kind {_KINDS[kind]}, of {kind} alone"
    if len(layers) > 1 or kind not in ("static", "breathing"):
        job.draft.changed(place, f"[{section.name}] layers", text)


def _lines(section: Section, option: str) -> list[str]:
    lines = (line.strip() for line in section.text(option).splitlines())
    return [line for line in lines if line and not line.startswith("#")]


def _numbers(text: str) -> list[float]:
    """The numbers of a colour, at least three of them, from 0 to 1."""
    found = [min(max(float(word), 0.0), 1.0) for word in text.replace(",", " ").split()]
    return [*found, 0.0, 0.0, 0.0][: max(3, min(len(found), 4))]


def _indices(text: str) -> list[Any]:
    found: list[Any] = []
    for part in text.replace(" ", "").split(","):
        first, dash, last = part.partition("-")
        found += range(int(first), int(last) + 1) if dash else [int(first)]
    return found
