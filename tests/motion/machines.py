"""Machine dicts for motion tests: plain numbers, as the configuration hands them to the core."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

from pydantic import TypeAdapter

from passo.config import load
from passo.geometry.base import GeometryModel
from passo.geometry.registry import AnyGeometry

HZ = 16_000_000
Point = tuple[float, float, float]
REACH: dict[str, tuple[Point, Point]] = {  # machine: middle and half sizes of a box in its reach
    "delta": ((0, 0, 60), (45, 45, 40)),
    "rotary-delta": ((0, 0, 20), (40, 40, 15)),
    "scara": ((100, 100, 50), (60, 60, 40)),
    "dual-scara": ((0, 78, 25), (30, 16, 20)),
    "polar": ((-70, 3, 50), (65, 60, 40)),
    "winch": ((0, 0, 150), (100, 100, 100)),
}
PLAIN: dict[str, dict[str, Any]] = {  # geometries on a plain machine
    "polar": {"kind": "polar"},
    "winch": {
        "kind": "winch",
        "anchors": [[0.0, -900, -50], [800.0, 500, -50], [-800.0, 500, -60], [0.0, 0, 900]],
    },
}


def nonlinear(name: str) -> tuple[dict[str, Any], GeometryModel]:
    """One of REACH at 16 MHz, and the plain geometry of it; the arms on two towers are driven as
    those of the SCARA."""
    if name in PLAIN:
        return plain(TypeAdapter(AnyGeometry).validate_python(PLAIN[name]))
    machine = load("scara" if name == "dual-scara" else name)
    spec, geometry = machine.core_spec() | {"clock_hz": HZ}, machine.geometry
    if name == "dual-scara":
        geometry = TypeAdapter(AnyGeometry).validate_python({"kind": "dual_scara"})
        spec["geometry"] = geometry.spec()
        for row in spec["steppers"][:3]:
            row |= {"min": -inf, "max": inf}
    return spec, geometry


def plain(geometry: GeometryModel) -> tuple[dict[str, Any], GeometryModel]:
    """A machine of this geometry, with 40 steps per unit of each of its motors."""
    spec = cartesian() | {"geometry": geometry.spec()}
    motors = [
        stepper(name, "actuator", i, 40.0, speed=500.0, accel=20000.0)
        for i, name in enumerate(geometry.actuators)
    ]
    return spec | {"steppers": [*motors, stepper("e", "extruder", 0, 95.5)]}, geometry


def joints(geometry: GeometryModel, at: Point, near: Sequence[float]) -> tuple[float, ...]:
    """The plain inverse; of a motor that turns without end, the position nearest to `near`."""
    found = zip(geometry.actuators, geometry.inverse(at), near, strict=True)
    return tuple(
        q + 360 * round((n - q) / 360) if name in geometry.endless else q for name, q, n in found
    )


def of_box(name: str, geometry: GeometryModel, at: Point) -> tuple[float, ...]:
    """The plain inverse in the box of one of REACH, in which no motor jumps."""
    return joints(geometry, at, geometry.inverse(REACH[name][0]))


def axis(letter: str, **limits: float) -> dict[str, Any]:
    values = {"min": -1000.0, "max": 1000.0, "speed": 300.0, "accel": 3000.0, "jerk": 10.0}
    return {"letter": letter, "name": letter.lower(), "cornering_steps": 40.0} | values | limits


def stepper(name: str, drive: str, index: int, steps: float, **values: float) -> dict[str, Any]:
    return {
        "name": name,
        "drive": drive,
        "index": index,
        "steps_per_unit": steps,
        "invert": False,
        "pulse_s": 1e-6,
        "dir_setup_s": 2e-7,
        "dir_hold_s": 2e-7,
        "max_rate_hz": 500000.0,
        "speed": inf,
        "accel": inf,
        "min": -inf,
        "max": inf,
    } | values


def cartesian(**limits: Any) -> dict[str, Any]:
    """80/80/400/95.5 steps per mm, 16 MHz, junction deviation 0.02 mm."""
    return {
        "name": "test",
        "clock_hz": HZ,
        "tolerance_s": 2e-6,
        "axes": [axis("X"), axis("Y"), axis("Z", speed=12.0, accel=100.0)],
        "extruders": [{"name": "e", "speed": 100.0, "accel": 5000.0, "jerk": 1.0}],
        "tools": [{"extruder": 0, "offset": [0.0, 0.0, 0.0]}],
        "geometry": {"kind": "cartesian"},
        "steppers": [
            stepper("x", "actuator", 0, 80.0),
            stepper("y", "actuator", 1, 80.0),
            stepper("z", "actuator", 2, 400.0),
            stepper("e", "extruder", 0, 95.5),
        ],
        "limits": {
            "print_accel": 3000.0,
            "travel_accel": 3000.0,
            "retract_accel": 3000.0,
            "speed": inf,
            "junction": "deviation",
            "junction_deviation": 0.02,
            "square_corner": 5.0,
            "minimum_cruise_ratio": 0.0,
            "least_speed_gain": 0.0,
        }
        | limits,
    }


def aprinter() -> dict[str, Any]:
    """The machine of the golden times: 80 steps/mm, 300 mm/s, 1500 mm/s², cornering distance 40."""
    spec = cartesian(
        print_accel=inf, travel_accel=inf, retract_accel=inf, junction="cornering_distance"
    )
    spec["axes"] = [axis(letter, accel=1500.0) for letter in "XYZ"]
    spec["extruders"] = [{"name": "e", "speed": 300.0, "accel": 250.0, "jerk": 1.0}]
    spec["steppers"][2]["steps_per_unit"] = 80.0
    spec["steppers"][3]["steps_per_unit"] = 100.0
    return spec
