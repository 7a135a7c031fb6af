"""Sections of Klipper that a machine file only keeps for macros, because Passo drives no such part:
the state that macros read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from copy import deepcopy
from typing import TYPE_CHECKING, Any, NamedTuple

from passo.config.klipper_options import OPTIONS, kind_of

if TYPE_CHECKING:
    from passo.config.klipper_options.option import Settings

State = dict[str, Any]


class StandIn(NamedTuple):
    """The state of a part that Passo does not drive. `says` completes the sentence "macros read";
    `options` are the options whose values the state begins with, by the names of these values."""

    state: State
    says: str
    options: Mapping[str, str] = {}

    def begun(self, settings: Settings) -> State:
        """The state at the start, with the settings of the section."""
        known = {key: name for key, name in self.options.items() if name in settings}
        return deepcopy(self.state) | {key: settings[name] for key, name in known.items()}


_COLD = "0 °C, because nothing is measured"
_FAN = StandIn({"speed": 0.0, "rpm": None}, "that the fan is off")
_LIGHT = StandIn({"color_data": [[0.0, 0.0, 0.0, 0.0]]}, "that the light is off")
_LEVELLED = StandIn({"applied": False}, "that it is not levelled")
_PIN = StandIn({"value": 0.0}, "the value that SET_PIN has given it", {"value": "value"})
_FILAMENT = StandIn({"filament_detected": True, "enabled": True}, "that there is filament")
_NO_MESH: State = {
    "profile_name": "",
    "mesh_min": [0.0, 0.0],
    "mesh_max": [0.0, 0.0],
    "probed_matrix": [[]],
    "mesh_matrix": [[]],
    "profiles": {},
}
_PLUG_IN = StandIn({}, "its settings and no state")
_KINDS: Mapping[str, StandIn] = {
    "output_pin": _PIN,
    "pwm_tool": _PIN,
    "pwm_cycle_time": _PIN,
    "servo": StandIn({"value": 0.0}, "that the servo is at rest"),
    "neopixel": _LIGHT,
    "dotstar": _LIGHT,
    "led": _LIGHT,
    "pca9533": _LIGHT,
    "pca9632": _LIGHT,
    "gcode_button": StandIn({"state": "RELEASED"}, "that the button is released"),
    "filament_switch_sensor": _FILAMENT,
    "filament_motion_sensor": _FILAMENT,
    "temperature_sensor": StandIn(
        {"temperature": 0.0, "measured_min_temp": 0.0, "measured_max_temp": 0.0}, _COLD
    ),
    "temperature_fan": StandIn(
        {"speed": 0.0, "rpm": None, "temperature": 0.0, "target": 0.0}, _COLD
    ),
    "heater_generic": StandIn({"temperature": 0.0, "target": 0.0, "power": 0.0}, _COLD),
    "fan": _FAN,
    "fan_generic": _FAN,
    "heater_fan": _FAN,
    "controller_fan": _FAN,
    "quad_gantry_level": _LEVELLED,
    "z_tilt": _LEVELLED,
    "probe": StandIn(
        {"name": "probe", "last_query": False, "last_z_result": 0.0},
        "that the probe is not triggered",
    ),
    "bed_mesh": StandIn(_NO_MESH, "that there is no mesh"),
}


def stand_in(section: str) -> StandIn | None:
    """What stands in for the part of a section, by its name. None for a section that has no state
    in Klipper: its settings alone."""
    kind = kind_of(section)
    return _KINDS.get(kind) or (None if kind in OPTIONS else _PLUG_IN)


def sentences(sections: Iterable[str]) -> list[str]:
    """What macros read of the parts that these sections name: one sentence for each state."""
    found: dict[str, list[str]] = {}
    for section in sections:
        if part := stand_in(section):
            found.setdefault(part.says, []).append(section)
    return [f"of {', '.join(_by_kind(names))} macros read {says}" for says, names in found.items()]


def _by_kind(names: Iterable[str]) -> Iterator[str]:
    """The names; more than three of one kind are counted."""
    kinds: dict[str, list[str]] = {}
    for name in names:
        kinds.setdefault(kind_of(name), []).append(name)
    for kind, same in kinds.items():
        yield from same if len(same) <= 3 else [f"{len(same)} sections [{kind} …]"]
