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
    from collections.abc import Mapping

    from passo.config.importing.aprinter.conversion import Job
    from passo.config.importing.aprinter.document import Node
    from passo.config.importing.numbers import Read

Geometry = Scara | DualScara | RotaryDelta


class _Kind(NamedTuple):
    """The model of a geometry, the axes that its arms move together, the beginning of the names of
    its stored options, and the key of the machine file for each parameter."""

    model: type[Scara] | type[DualScara] | type[RotaryDelta]
    axes: str
    prefix: str
    keys: Mapping[str, str]


ARMS: Mapping[str, _Kind] = {
    "SCARA": _Kind(
        Scara,
        "XY",
        "SCARA",
        {
            "Arm1Length": "arm1",
            "Arm2Length": "arm2",
            "XOffset": "x_offset",
            "YOffset": "y_offset",
        },
    ),
    "DualSCARA": _Kind(
        DualScara,
        "XY",
        "SCARA",
        {
            "Arm1ShoulderXCoord": "shoulder1_x",
            "Arm2ShoulderXCoord": "shoulder2_x",
            "Arm1ProximalSideLength": "proximal1",
            "Arm2ProximalSideLength": "proximal2",
            "Arm1DistalSideLength": "distal1",
            "Arm2DistalSideLength": "distal2",
            "XOffset": "x_offset",
            "YOffset": "y_offset",
        },
    ),
    "RotationalDelta": _Kind(
        RotaryDelta,
        "XYZ",
        "Delta",
        {
            "EndEffectorLength": "effector_length",
            "BaseLength": "base_length",
            "RodLength": "rod_length",
            "ArmLength": "arm_length",
            "ZOffset": "z_offset",
        },
    ),
}


def put_arms(job: Job, transform: Node) -> list[Node]:
    """Converts the geometry, the arms and the axes that they move, without homing. Returns the
    steppers of the arms. Raises ConfigError."""
    kind = ARMS[transform.kind]
    values: dict[str, float | bool] = {}
    for word, key in kind.keys.items():
        found = job.stored.needed(transform, word, f"{kind.prefix}{word}")
        job.put(("geometry", key), found)
        values[key] = found.value
    if kind.model is Scara:
        place = transform.within("ExternalArm2Motor").place
        external = job.stored.flag(transform, "ExternalArm2Motor", "SCARAExternalArm2Motor")
        job.draft.put(("geometry", "external_motor"), external, place)
        values["external_motor"] = external
    steppers: list[Node] = []
    for index in range(len(kind.model.arms)):
        name = transform.get("Steppers", f"TransformStepper{index}", "StepperName")
        steppers.append(job.stepper(name))
        letter = steppers[-1].text("Name")
        job.motors[letter] = "abc"[index]
        job.arms.add(letter)
    accels = [_put_arm(job, stepper) for stepper in steppers]
    reach = sum(value for key, value in values.items() if _is_length(key))
    _put_axes(job, transform, kind, min(accels, key=lambda found: found.value), reach)
    return steppers


def _is_length(key: str) -> bool:
    """Whether a parameter is the length of the first arm or of its rod, which carry the nozzle."""
    return key in ("arm1", "arm2", "proximal1", "distal1", "arm_length", "rod_length")


def _put_arm(job: Job, stepper: Node) -> Read:
    """Converts the limits of an arm, and returns its acceleration."""
    letter = stepper.text("Name")
    path = ("steppers", job.motors[letter])
    accel = job.stored.needed(stepper, "MaxAccel", f"{letter}MaxAccel")
    for key, word in (("speed_deg_s", "MaxSpeed"), ("min_deg", "MinPos"), ("max_deg", "MaxPos")):
        job.put((*path, key), job.stored.needed(stepper, word, f"{letter}{word}"))
    job.put((*path, "accel_deg_s2"), accel)
    return accel


def _put_axes(job: Job, transform: Node, kind: _Kind, accel: Read, reach: float) -> None:
    """Converts the axes that the arms move. Their acceleration is that of the end of the stretched
    arms, so that the limits of the arms are the ones that count."""
    limit = float(f"{radians(accel.value) * reach:.6g}")
    for index, _ in enumerate(kind.axes):
        node = transform.within("CartesianAxes", f"VirtualAxis{index}")
        path = ("axes", node.text("Name").lower())
        job.put_axis_limits(path, node)
        job.draft.put((*path, "accel_mm_s2"), limit, accel.place)
    text = f"axes have an acceleration too: {limit:g} mm/s², that of the end of the stretched arms"
    job.draft.changed(accel.place, "MaxAccel", text)


def put_home(job: Job, transform: Node) -> None:
    """Sets where the nozzle is when all arms are at their endstops, if that is within the limits of
    the axes. Raises ConfigError for arms that do not meet there."""
    kind = ARMS[transform.kind]
    keys = job.draft.keys
    motors = "abc"[: len(kind.model.arms)]
    if any(("homing", motor, "position") not in keys for motor in motors):
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
