"""The JSON schema of the machine file, with the texts that editors show for each key."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from passo.config.board import Board
from passo.config.electronics import Fan
from passo.config.heat import Heater
from passo.config.key_settings import setting_of
from passo.config.machine import MachineConfig
from passo.config.machine_keys import field_help, models_of, unit_of

if TYPE_CHECKING:
    from pydantic import BaseModel

# The paths of tables with keys that `setting_of` knows; changes of other keys take effect after a
# restart.
_PATHS = {
    "Axis": "axes.x",
    "Backlash": "backlash",
    "Extruder": "extruders.e",
    "Limits": "limits",
    "Shaping": "shaping.x",
}
# Required keys that the board's file may give.
_OF_THE_BOARD = ((Heater, ("pin", "sensor_pin")), (Fan, ("pin",)))


@cache
def schema() -> dict[str, Any]:
    """The schema (JSON Schema 2020-12) of a machine file as a user writes it. Beyond types, ranges
    and defaults each key has its help as `description`, its unit as `x-unit` if it has one, and
    `x-acts`: `live` if a change can take effect at once, `restart` if the printer has to be
    restarted."""
    described = MachineConfig.model_json_schema()
    described["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    described["title"] = "Machine file of Passo"
    tables: dict[str, Any] = described["$defs"]
    for model in _models(MachineConfig, {}).values():
        table = described if model is MachineConfig else tables[model.__name__]
        for name, text in field_help(model).items():
            key: dict[str, Any] = table["properties"][name]
            key["description"] = text
            if unit := unit_of(name, text):
                key["x-unit"] = unit
            live = setting_of(f"{_PATHS.get(model.__name__, '')}.{name}")
            key["x-acts"] = "restart" if live is None else "live"
    _relax(tables)
    return described


def _relax(tables: dict[str, Any]) -> None:
    """Leaves out what the loader fills in: a board's keys from its `base`, pins of heaters and fans
    from the board, limits of an axis that is an extruder, and a sensor's values from its name."""
    required = tables["Board"]["required"]
    for name in _models(Board, {}):
        tables[name].pop("required", None)
    tables["Board"] |= {"if": {"not": {"required": ["base"]}}, "then": {"required": required}}
    axis = tables["Axis"]
    axis["required"].remove("max_mm")
    extruder = {"properties": {"extruder": {"const": True}}, "required": ["extruder"]}
    axis |= {"if": {"not": extruder}, "then": {"required": ["max_mm"]}}
    for model, given in _OF_THE_BOARD:
        table = tables[model.__name__]
        table["required"] = [name for name in table["required"] if name not in given]
    for owner in ("Heater", "ShownSensor"):
        _name_sensor(tables[owner]["properties"]["sensor"])


def _name_sensor(sensor: dict[str, Any]) -> None:
    """Allows a name in place of a sensor's values."""
    table = {key: sensor.pop(key) for key in ("anyOf", "oneOf", "discriminator") if key in sensor}
    named = {"type": "object", "properties": {"kind": {"type": "string"}}, "required": ["kind"]}
    sensor["anyOf"] = [table, named, {"type": "string"}, {"type": "integer"}]


def _models(
    model: type[BaseModel], found: dict[str, type[BaseModel]]
) -> dict[str, type[BaseModel]]:
    """Collects a model and all models within it, by name."""
    if model.__name__ not in found:
        found[model.__name__] = model
        for field in model.model_fields.values():
            for inner in models_of(field.annotation):
                _models(inner, found)
    return found
