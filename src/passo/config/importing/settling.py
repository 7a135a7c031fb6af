"""Makes the machine file of an import valid: whatever Passo cannot take as it is gets the nearest
allowed value, or is left out, and is reported."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, cast

from passo.config.findings import Finding, as_written, key_text
from passo.config.load import findings_of_text
from passo.errors import ConfigError, Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from passo.config.importing.draft import Draft, KeyPath, Place, Value
    from passo.config.toml_lines import Path

_ANY = "*"
_Clamp = tuple[tuple[str, ...], float | None]


class _Part(NamedTuple):
    """Keys that are left out together if one of `keys` is wrong. `*` is any name. `keys` of None
    are all keys."""

    path: tuple[str, ...]
    keys: tuple[str, ...] | None = None


# The first row that fits applies. A wrong key without a row is left out alone, so that its default
# applies, unless it is in FIRM.
_PARTS = (
    _Part(("macros", _ANY)),
    _Part(("delayed_gcode", _ANY)),
    _Part(("heaters", _ANY), ("kind", "pin", "sensor_pin", "sensor", "min_c", "max_c")),
    _Part(("fans", _ANY, "tachometer")),
    _Part(
        ("fans", _ANY),
        (
            "pin",
            "follows",
            "follows_heaters",
            "follows_motors",
            "follows_targets",
            "thermostat",
            "number",
        ),
    ),
    _Part(("filament_sensors", _ANY), ("pin", "kind", "extruder", "width")),
    _Part(("buttons", _ANY), ("pin", "resistance_ohm", "pull_up_ohm")),
    _Part(("outputs", _ANY)),
    _Part(("lights", _ANY)),
    _Part(("light_effects", _ANY)),
    _Part(("light_templates", _ANY)),
    _Part(("servos", _ANY)),
    _Part(("sensors", _ANY), ("sensor", "sensor_pin", "min_c", "max_c")),
    _Part(("shaping", _ANY)),
    _Part(("steppers", _ANY, "tmc")),
    _Part(("homing", _ANY)),
    _Part(("levelling", "screws")),
    _Part(("levelling", "motors")),
    _Part(("levelling",)),
    _Part(("accelerometer",)),
    _Part(("probe",), ("kind", "pin", "control_pin", "offset_mm", "trigger_height_mm")),
    _Part(("laser",)),
    _Part(("mains",)),
    _Part(("park",)),
    _Part(("bed",)),
    _Part(("moves", _ANY)),
    _Part(("backlash",)),
)
_SCALES = (
    "steps_per_mm",
    "steps_per_degree",
    "rotation_distance_mm",
    "gear_ratio",
    "full_steps_per_rotation",
    "microsteps",
)
# Keys whose defaults would move the machine in another way, or not at all.
_FIRM = (
    ("geometry",),
    *(("axes", _ANY, key) for key in ("min_mm", "max_mm")),
    *(("steppers", _ANY, key) for key in (*_SCALES, "invert", "socket", "step_pin")),
    *(("steppers", _ANY, key) for key in ("direction_pin", "enable_pin")),
    ("board", "base"),
    ("boards", _ANY, "base"),
)
# A number in one of these tables may get the nearest allowed value, unless it is one of the keys:
# another number there means another thing. fmt: off
_CLAMPED = (
    "axes",
    "steppers",
    "extruders",
    "limits",
    "shaping",
    "homing",
    "probe",
    "levelling",
    "accelerometer",
    "heaters",
    "fans",
    "outputs",
    "lights",
    "light_effects",
    "servos",
    "sensors",
    "filament_sensors",
    "buttons",
    "delayed_gcode",
    "idle",
    "park",
)
_EXACT = (
    *_SCALES,
    "position",
    "position_mm",
    "home_mm",
    "offset_mm",
    "trigger_height_mm",
    "sensor",
    "address",
    "number",
    "point_mm",
)
# fmt: on


def settle(draft: Draft) -> None:
    """Changes the draft until it is a valid machine file, and reports what it changes. Raises
    ConfigError, with the places in the imported files, if a value is wrong without which the
    machine would move in another way, or not at all."""
    clamped: set[_Clamp] = set()
    while findings := findings_of_text(draft.text("")):
        changed = [_changed(draft, finding, clamped) for finding in findings]
        if not any(changed):
            raise _refusal(draft, findings)


def _changed(draft: Draft, finding: Finding, clamped: set[_Clamp]) -> bool:
    """Settles one finding. False if that is not possible, or was done with another one."""
    key = _key_of(draft, finding.path)
    if key is not None and finding.nearest is not None and _clamp(draft, key, finding, clamped):
        return True
    part = _part_of(finding.path)
    if part is not None:
        return _leave_out(draft, part, finding)
    if key is None or any(_fits(firm, finding.path) for firm in _FIRM):
        return False
    _, place = draft.keys.pop(key)
    draft.dropped(_place(draft, key, place), key_text(key), f"it is left out: {_reason(finding)}")
    return True


def _clamp(draft: Draft, key: KeyPath, finding: Finding, clamped: set[_Clamp]) -> bool:
    """Gives a number the nearest allowed value: each one once."""
    if (
        (key, finding.nearest) in clamped
        or key[0] not in _CLAMPED
        or not set(_EXACT).isdisjoint(key)
    ):
        return False
    value, place = draft.keys[key]
    new = _with(value, finding.path[len(key) :], cast("float", finding.nearest))
    if new is None:
        return False
    clamped.add((key, finding.nearest))
    draft.keys[key] = new, place
    text = f"{finding.value:g} became {finding.nearest:g}: expected {finding.limit}"
    draft.changed(_place(draft, key, place), key_text(key), text)
    return True


def _with(value: Value, rest: Sequence[str | int], nearest: float) -> Value | None:
    """The value with `nearest` at a place within it; None if no number is there."""
    if not rest:
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        return int(nearest) if isinstance(value, int) and nearest == int(nearest) else nearest
    first, *further = rest
    if isinstance(value, list) and isinstance(first, int) and first < len(value):
        inner = _with(value[first], further, nearest)
        return None if inner is None else [*value[:first], inner, *value[first + 1 :]]
    return None


def _leave_out(draft: Draft, part: KeyPath, finding: Finding) -> bool:
    """Takes a part out of the draft."""
    keys = [key for key in draft.keys if key[: len(part)] == part]
    if not keys:
        return False
    places = [place for _, place in map(draft.keys.pop, keys)]
    place = next((place for place in places if place), None)
    text = f"it is left out: {_reason(finding)}"
    draft.decide(_place(draft, part, place), key_text(part), text)
    if part[0] == "heaters":
        draft.simulate(f"{key_text(part)} is decided")
    return True


def _key_of(draft: Draft, path: Path) -> KeyPath | None:
    """The key of the draft whose value has the path, or is at it."""
    for length in range(len(path), 0, -1):
        if (key := path[:length]) in draft.keys:
            return cast("KeyPath", key)
    return None


def _part_of(path: Path) -> KeyPath | None:
    for part in _PARTS:
        length = len(part.path)
        if not _fits(part.path, path):
            continue
        if part.keys is None or len(path) == length or path[length] in part.keys:
            return cast("KeyPath", path[:length])
    return None


def _fits(pattern: tuple[str, ...], path: Path) -> bool:
    """Whether a path begins as the pattern says."""
    return len(path) >= len(pattern) and all(
        one in (_ANY, part) for one, part in zip(pattern, path, strict=False)
    )


def _place(draft: Draft, path: KeyPath, place: Place | None) -> Place:
    """A place for a report: that of the key, or that of the nearest key before it."""
    if place is not None:
        return place
    near = [p for key, (_, p) in draft.keys.items() if p is not None and key[0] == path[0]]
    every = [p for _, p in draft.keys.values() if p is not None]
    return (near or every)[0]


def _reason(finding: Finding) -> str:
    return _problem(finding).sentence.rstrip(".")


def _problem(finding: Finding, file: str = "", line: int | None = None) -> Problem:
    limit = finding.limit
    if finding.owner:
        limit += f" {key_text(finding.owner)}"
    value = None if finding.code == "config.missing-key" else as_written(finding.value)
    values = {"key": finding.key, "value": value, "limit": limit}
    return Problem(finding.code, file, line, values, finding.hint)


def _refusal(draft: Draft, findings: list[Finding]) -> ConfigError:
    problems: list[Problem] = []
    for finding in findings:
        key = _key_of(draft, finding.path) or cast("KeyPath", finding.path)
        place = _place(draft, key, draft.keys.get(key, (None, None))[1])
        problems.append(_problem(finding, place.file, place.line))
    return ConfigError(problems)
