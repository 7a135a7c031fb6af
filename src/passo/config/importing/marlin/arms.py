"""SCARA machines. Marlin counts and limits their arms in degrees, under the letters X and Y."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from pydantic import ValidationError

from passo.config.importing.draft import bad
from passo.geometry.base import Unreachable
from passo.geometry.scara import Scara

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job

ARMS = {"x": "a", "y": "b"}  # by the letter of the axis whose options an arm has
FULL_TURN_DEG = 360.0


def put_arms(job: Job, external: bool) -> None:
    """Converts the lengths of the arms. With `external`, the motor of the forearm is on the base,
    as in a Morgan. Raises ConfigError."""
    job.rows("arms")
    job.draft.put(("geometry", "external_motor"), external, None)
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
    homes = [job.needed(f"MANUAL_{axis}_HOME_POS") for axis in "XY"]
    try:
        arms = Scara.model_validate(job.draft.table("geometry"))
        angles = arms.inverse((homes[0].value, homes[1].value, 0.0))
    except (Unreachable, ValidationError) as error:
        value = ", ".join(f"{home.value:g}" for home in homes)
        why = f": {error}" if isinstance(error, Unreachable) else ""
        raise bad(homes[0].place, homes[0].name, value, f"a place in reach{why}") from None
    at = round(angles["xy".index(letter)], 4)
    job.draft.put((*path, "position"), at, homes["xy".index(letter)].place)
