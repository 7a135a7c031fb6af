"""Machines with arms: SCARA, dual SCARA and the rotational delta. APrinter limits their motors, in
degrees, and has speeds for the axes but no accelerations."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, NamedTuple

from pydantic import ValidationError

from passo.config.importing.draft import bad
from passo.geometry.base import Unreachable
from passo.geometry.dual_scara import DualScara
from passo.geometry.rotary_delta import RotaryDelta
from passo.geometry.scara import Scara

if TYPE_CHECKING:
    from passo.config.importing.aprinter.conversion import Job
    from passo.config.importing.aprinter.document import Node
    from passo.config.importing.numbers import Read


class _Kind(NamedTuple):
    """The model of a geometry, the group of its rows, the axes that its arms move together, the
    beginning of the names of its stored options, and the lengths of the first arm and its rod."""

    model: type[Scara] | type[DualScara] | type[RotaryDelta]
    group: str
    axes: str
    prefix: str
    lengths: tuple[str, ...]


_BOTH = ("proximal1", "distal1")
ARMS = {
    "SCARA": _Kind(Scara, "scara", "XY", "SCARA", ("arm1", "arm2")),
    "DualSCARA": _Kind(DualScara, "dual_scara", "XY", "SCARA", _BOTH),
    "RotationalDelta": _Kind(
        RotaryDelta, "rotary_delta", "XYZ", "Delta", ("arm_length", "rod_length")
    ),
}


def put_arms(job: Job, transform: Node) -> list[Node]:
    """Converts the geometry, the arms and the axes that they move, without homing. Returns the
    steppers of the arms. Raises ConfigError."""
    kind = ARMS[transform.kind]
    job.rows(kind.group, transform, kind.prefix)
    if kind.model is Scara:
        place = transform.within("ExternalArm2Motor").place
        external = job.stored.flag(transform, "ExternalArm2Motor", "SCARAExternalArm2Motor")
        job.draft.put(("geometry", "external_motor"), external, place)
    steppers = job.transform_steppers(transform, "abc"[: len(kind.model.arms)])
    for stepper in steppers:
        letter = stepper.text("Name")
        job.arms.add(letter)
        job.rows("arm", stepper, letter, name=job.motors[letter])
    accels = [job.stored.needed(s, "MaxAccel", f"{s.text('Name')}MaxAccel") for s in steppers]
    reach = sum(job.draft.number(("geometry", key)) for key in kind.lengths)
    _put_axes(job, transform, kind, min(accels, key=lambda found: found.value), reach)
    return steppers


def _put_axes(job: Job, transform: Node, kind: _Kind, accel: Read, reach: float) -> None:
    """Converts the axes that the arms move. Their acceleration is that of the end of the stretched
    arms, so that the limits of the arms are the ones that count."""
    limit = float(f"{radians(accel.value) * reach:.6g}")
    for index, _ in enumerate(kind.axes):
        node = transform.within("CartesianAxes", f"VirtualAxis{index}")
        letter = node.text("Name")
        job.rows("virtual_axis", node, letter, name=letter.lower())
        job.draft.put(("axes", letter.lower(), "accel_mm_s2"), limit, accel.place)
    text = f"axes have an acceleration too: {limit:g} mm/s², that of the end of the stretched arms"
    job.draft.changed(accel.place, "MaxAccel", text)


def put_home(job: Job, transform: Node) -> None:
    """Sets where the nozzle is when all arms are at their endstops, if that is within the limits of
    the axes. Raises ConfigError for arms that do not meet there."""
    kind = ARMS[transform.kind]
    motors = "abc"[: len(kind.model.arms)]
    needed = [("homing", motor, "position") for motor in motors]
    needed += [("axes", axis, "max_mm") for axis in kind.axes.lower()]
    if any(key not in job.draft.keys for key in needed):
        return
    ends = [job.draft.number(("homing", motor, "position")) for motor in motors]
    a, b, c = [*ends, 0.0][:3]
    values = job.draft.table("geometry")
    try:
        geometry = kind.model.model_validate(values)
        place = geometry.forward((a, b, c))
    except (Unreachable, ValidationError):
        raise bad(transform.place, transform.kind, str(values)[:60], "arms that meet") from None
    limits = [
        [job.draft.number(("axes", axis, key)) for key in ("min_mm", "max_mm")]
        for axis in kind.axes.lower()
    ]
    if all(low <= at <= high for at, (low, high) in zip(place, limits, strict=False)):
        for axis, at in zip(kind.axes.lower(), place, strict=False):
            job.draft.put(("axes", axis, "home_mm"), round(at, 3) + 0.0, transform.place)
