"""SCARA machines. Marlin counts and limits their arms in degrees, under the letters X and Y."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, radians, sin
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job

ARMS = {"x": "a", "y": "b"}  # by the letter of the axis whose options an arm has
FULL_TURN_DEG = 360.0


def put_arms(job: Job, external: bool) -> None:
    """Converts the lengths of the arms. With `external`, the motor of the forearm is on the base,
    as in a Morgan. Raises ConfigError."""
    job.put(("geometry", "arm1"), job.needed("SCARA_LINKAGE_1"))
    job.put(("geometry", "arm2"), job.needed("SCARA_LINKAGE_2"))
    job.draft.put(("geometry", "external_motor"), external, None)
    job.put(("geometry", "x_offset"), job.defines.number("SCARA_OFFSET_X"))
    job.put(("geometry", "y_offset"), job.defines.number("SCARA_OFFSET_Y"))
    text = "Marlin has no limits for arms: give min_deg and max_deg of steppers.a and steppers.b"
    job.decide("SCARA_LINKAGE_1", text)


def put_end_limits(job: Job) -> None:
    """Sets speed and acceleration of X and Y: those of the end of the stretched arms, so that the
    limits of the arms are the ones that count."""
    reach = job.draft.number(("geometry", "arm1")) + job.draft.number(("geometry", "arm2"))
    for define, key in (
        ("DEFAULT_MAX_FEEDRATE", "speed_mm_s"),
        ("DEFAULT_MAX_ACCELERATION", "accel_mm_s2"),
    ):
        limits = job.needed_list(define)
        for found, axis in zip(limits, ARMS, strict=False):
            value = float(f"{radians(found.value) * reach:.6g}")
            job.draft.put(("axes", axis, key), value, found.place)
        text = "it limits the arms; X and Y have the value of the end of the stretched arms"
        job.changed(define, text)


def put_home(job: Job, path: KeyPath, letter: str) -> None:
    """Sets the angle of an arm at its endstop. Marlin gives the angles of both arms, or X and Y of
    the nozzle when both are at their endstops. Raises ConfigError."""
    external = bool(job.draft.keys["geometry", "external_motor"][0])
    if external and job.defines.first("SCARA_OFFSET_THETA1"):
        job.put((*path, "position"), job.needed(f"SCARA_OFFSET_THETA{'xy'.index(letter) + 1}"))
        return
    place: list[float] = []
    for axis in "XY":
        shoulder = job.defines.number(f"SCARA_OFFSET_{axis}")
        home = job.needed(f"MANUAL_{axis}_HOME_POS")
        place.append(home.value - (shoulder.value if shoulder else 0.0))
    angle = _angles(job, place[0], place[1], external)["xy".index(letter)]
    job.draft.put((*path, "position"), angle, job.place(f"MANUAL_{letter.upper()}_HOME_POS"))


def _angles(job: Job, x: float, y: float, external: bool) -> tuple[float, float]:
    """The angles of both arms for a place of the nozzle, seen from the shoulder. The law of cosines
    gives the elbow; a place out of reach counts as one at the limit of the reach, as in Marlin."""
    one, two = (job.draft.number(("geometry", key)) for key in ("arm1", "arm2"))
    bend = (x * x + y * y - one * one - two * two) / (2 * one * two)
    elbow = acos(min(max(bend, -1.0), 1.0))
    shoulder = atan2(y, x) - atan2(two * sin(elbow), one + two * cos(elbow))
    second = elbow + shoulder if external else elbow
    return round(degrees(shoulder), 4), round(degrees(second), 4)
