"""Number types and the base of all configuration models."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from passo.config.shapers import SHAPER_FORMS, SHAPER_PATTERN


class Model(BaseModel):
    """A table of a machine file: strict types, no unknown keys, no change after loading."""

    # Build the validators once for the whole machine, not for each table.
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True
    )


# Describes the expected text in words, because most users cannot read a pattern.
PATTERNS = {
    r"^[a-z][a-z0-9_-]*$": "a name of lower-case letters, digits, - and _",
    r"^[A-Za-z0-9_][A-Za-z0-9_-]*$": "a name of letters, digits, - and _",
    r"^[!^~]*([A-Za-z0-9_][A-Za-z0-9_-]*:)?[A-Za-z][A-Za-z0-9_./-]*$": "a pin such as PB4, !PD7,"
    " tool:PA1 or a name in board.pins",
    r"^[A-Z]$": "one capital letter",
    r"^[RGBW]{3,4}$": "a permutation of RGB or RGBW",
    r"^[xyzabcuvw]$": "an axis: x, y, z, a, b, c, u, v or w",
    r"^[xyz]$": "an axis: x, y or z",
    r"^e[0-9]*$": "an extruder: e, e1, e2, …",
    r"^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$": "a UUID such as `uuidgen` prints",
    r"^([A-Za-z_][A-Za-z_][A-Za-z0-9_.]*|[GMTgmt](0|[1-9][0-9]{0,4})(\.[1-9])?)$": "a command, such"
    " as START_PRINT, M600 or T0",
    r"^[a-z0-9_][a-z0-9_.-]*$": "a name of lower-case letters, digits, _, . and -",
    SHAPER_PATTERN: f"one of {SHAPER_FORMS}",
}
NAME, PART_NAME, PIN, LETTER, COLORS, *_others = PATTERNS
AXIS, SHAPED, EXTRUDER, UUID, COMMAND, VARIABLE, SHAPER = _others

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
# No machine exceeds these, in mm or degrees and s; beyond them doubles cannot resolve single steps.
MIN_SCALE, MAX_SCALE = 1e-3, 1e5
Scale = Annotated[float, Field(ge=MIN_SCALE, le=MAX_SCALE)]
MIN_SPEED, MIN_ACCEL = 1e-3, 0.1  # minima for machine files and for commands that set limits
Speed = Annotated[float, Field(ge=MIN_SPEED, le=1e6)]
Acceleration = Annotated[float, Field(ge=MIN_ACCEL, le=1e7)]
Jerk = Annotated[float, Field(ge=0, le=1e6)]
Position = Annotated[float, Field(ge=-1e6, le=1e6)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Name = Annotated[str, Field(pattern=NAME)]
PartName = Annotated[str, Field(pattern=PART_NAME)]
"""The name of a part. It keeps its case; commands find it in any case."""
Pin = Annotated[str, Field(pattern=PIN)]
ColorOrder = Annotated[str, Field(pattern=COLORS)]
Letter = Annotated[str, Field(pattern=LETTER)]
ShaperForm = Annotated[str, Field(pattern=SHAPER)]
AxisName = Annotated[str, Field(pattern=AXIS)]
ShapedAxis = Annotated[str, Field(pattern=SHAPED)]
ExtruderName = Annotated[str, Field(pattern=EXTRUDER)]
Uuid = Annotated[str, Field(pattern=UUID)]
CommandName = Annotated[str, Field(pattern=COMMAND)]
VariableName = Annotated[str, Field(pattern=VARIABLE)]
Point = Annotated[list[Position], Field(min_length=3, max_length=3)]
Pair = Annotated[list[Position], Field(min_length=2, max_length=2)]
