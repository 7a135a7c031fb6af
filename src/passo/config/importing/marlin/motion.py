"""Geometry, axes, limits and extruders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.marlin.arms import put_arms, put_end_limits
from passo.config.importing.marlin.drivers import put_driver
from passo.config.importing.marlin.homing import put_homing
from passo.config.importing.marlin.motors import MOTORS, put_motor, put_socket
from passo.config.importing.numbers import plain
from passo.errors import ConfigError
from passo.geometry.delta import ANGLES

if TYPE_CHECKING:
    from passo.config.importing.marlin.conversion import Job
    from passo.config.importing.numbers import Read

_KINDS = {  # by define; of the second three the motor that subtracts turns the other way
    "COREXY": "corexy",
    "COREXZ": "corexz",
    "COREYZ": "coreyz",
    "COREYX": "corexy",
    "COREZX": "corexz",
    "COREZY": "coreyz",
    "DELTA": "delta",
    "MORGAN_SCARA": "scara",
    "MP_SCARA": "scara",
}
_BELTS = "reach_x_mm and reach_y_mm in [geometry]"
_CARRIAGES = {  # the keys that skew needs: where its carriages get to
    "cartesian": "min_mm and max_mm of the motors",
    **dict.fromkeys(("corexy", "corexz", "coreyz"), _BELTS),
}
_REVERSED = ("COREYX", "COREZX", "COREZY")
_OTHER_KINDS = (
    "AXEL_TPARA",
    "POLAR",
    "POLARGRAPH",
    "MARKFORGED_XY",
    "MARKFORGED_YX",
    "FOAMCUTTER_XYUV",
    "ARTICULATED_ROBOT_ARM",
)
_FURTHER = "IJKUVW"


def put_motion(job: Job) -> None:
    """Converts axes, extruders and motors. Raises ConfigError."""
    defines, put = job.defines, job.draft.put
    chosen = _kind(job)
    job.kind = _KINDS.get(chosen, "cartesian")
    place = defines.place(chosen) if chosen in defines.found else None
    put(("geometry", "kind"), job.kind, place)
    if job.kind == "delta":
        _put_delta(job)
    elif job.kind == "scara":
        put_arms(job, external=chosen == "MORGAN_SCARA")
    _put_skew(job)
    further = [f"{letter}_DRIVER_TYPE" for letter in _FURTHER]
    beyond = [name for name in further if defines.first(name)]
    for name in beyond:
        job.dropped(name, "axes after Z are not taken over")
    _put_axes(job)
    for index, (letter, motor) in enumerate(zip("xyz", MOTORS[job.kind], strict=True)):
        subtracts = chosen in _REVERSED and motor == "b"
        put_motor(job, index, letter, motor, subtracts)
        put_homing(job, index, letter, motor)
    for number in range(job.extruders):
        _put_extruder(job, number, 3 + len(beyond))
    _put_limits(job)


def _kind(job: Job) -> str:
    defines = job.defines
    mechanism = (defines.text("MECHANISM") or "").removeprefix("MECH_")
    for name in (*_KINDS, *_OTHER_KINDS):
        if defines.on(name) or mechanism == name:
            if name in _KINDS:
                return name
            place = defines.place(name if name in defines.found else "MECHANISM")
            limit = ", ".join(("cartesian", *_KINDS))
            raise ConfigError.of(
                "import.kinematics", place.file, place.line, value=name, limit=limit
            )
    if mechanism not in ("", "CARTESIAN"):
        place = defines.place("MECHANISM")
        limit = ", ".join(("cartesian", *_KINDS))
        raise ConfigError.of(
            "import.kinematics", place.file, place.line, value=mechanism, limit=limit
        )
    return "MECHANISM"


def _put_delta(job: Job) -> None:
    put, defines = job.draft.put, job.defines
    radius = job.needed("DELTA_RADIUS")
    rod = job.needed("DELTA_DIAGONAL_ROD")
    reach = job.needed("PRINTABLE_RADIUS", "DELTA_PRINTABLE_RADIUS")
    trims = defines.numbers("DELTA_DIAGONAL_ROD_TRIM_TOWER")
    turns = defines.numbers("DELTA_TOWER_ANGLE_TRIM")
    job.put(("geometry", "radius"), radius)
    rods = [plain(rod.value + (trims[i].value if trims else 0.0)) for i in range(3)]
    put(("geometry", "rods"), [*rods], rod.place)
    angles = [angle + (turns[i].value if turns else 0.0) for i, angle in enumerate(ANGLES)]
    put(("geometry", "angles"), [*angles], turns[0].place if turns else None)
    job.put(("geometry", "limit_radius"), reach)
    radii = defines.numbers("DELTA_RADIUS_TRIM_TOWER")
    if radii and any(one.value for one in radii):
        job.dropped("DELTA_RADIUS_TRIM_TOWER", "all towers have one radius: calibrate with G33")
    if rod.value <= radius.value:
        limit = f"more than the radius of {radius.value:g} mm"
        raise bad(rod.place, rod.name, f"{rod.value:g}", limit)


def _put_skew(job: Job) -> None:
    """Reports the skew as commands, because the limits of the carriages must be in the machine file
    first."""
    defines = job.defines
    if not defines.on("SKEW_CORRECTION"):
        return
    if job.kind not in _CARRIAGES:
        job.dropped("SKEW_CORRECTION", "Passo does not correct the skew of machines with arms")
        return
    commands: list[str] = []
    for plane, letter, side in (("XY", "I", "XY"), ("XZ", "J", "XY"), ("YZ", "K", "YZ")):
        factor = defines.number(f"{plane}_SKEW_FACTOR")
        names = (f"{plane}_DIAG_AC", f"{plane}_DIAG_BD", f"{side}_SIDE_AD")
        lengths = [length.value for length in map(defines.number, names) if length is not None]
        if factor is not None:
            commands += [f"M852 {letter}{factor.value:g}"] if factor.value else []
        elif len(lengths) == len(names) and lengths[0] != lengths[1]:
            commands.append(f"SET_SKEW {plane}={','.join(f'{mm:g}' for mm in lengths)}")
    if commands:
        reach = _CARRIAGES[job.kind]
        text = f"give {reach}, then send {', '.join(commands)} and M500"
        job.decide("SKEW_CORRECTION", text)


def _put_axes(job: Job) -> None:
    speeds = job.needed_list("DEFAULT_MAX_FEEDRATE")
    accels = job.needed_list("DEFAULT_MAX_ACCELERATION")
    for index, axis in enumerate("xyz"):
        path, letter = ("axes", axis), axis.upper()
        if job.kind == "delta":
            _put_delta_axis(job, axis)
        else:
            low = job.defines.number(f"{letter}_MIN_POS")
            if low is not None and low.value:
                job.put((*path, "min_mm"), low)
            else:
                job.draft.put((*path, "min_mm"), 0.0, low.place if low else None)
            job.put((*path, "max_mm"), job.needed(f"{letter}_MAX_POS", f"{letter}_MAX_LENGTH"))
        job.put((*path, "speed_mm_s"), speeds[index])
        job.put((*path, "accel_mm_s2"), accels[index])
    if job.kind == "scara":
        put_end_limits(job)


def _put_delta_axis(job: Job, axis: str) -> None:
    path, reach = ("axes", axis), job.needed("PRINTABLE_RADIUS", "DELTA_PRINTABLE_RADIUS")
    if axis == "z":
        top = job.needed("DELTA_HEIGHT", "MANUAL_Z_HOME_POS")
        low = job.defines.number("Z_MIN_POS")
        job.draft.put((*path, "min_mm"), low.value if low else 0.0, low.place if low else None)
        job.put((*path, "max_mm"), top)
        job.put((*path, "home_mm"), top)
        return
    job.put((*path, "min_mm"), reach, -1)
    job.put((*path, "max_mm"), reach)
    job.draft.put((*path, "home_mm"), 0.0, None)


def _put_extruder(job: Job, number: int, first: int) -> None:
    """Converts an extruder. If each extruder has its own values, they are at `first` and after
    it."""
    name = f"e{number}" if number else "e"
    path, defines = ("steppers", name), job.defines

    def own(found: list[Read]) -> Read:
        at = min(first, len(found) - 1)
        return found[min(at + number, len(found) - 1)]

    steps = own(job.needed_list("DEFAULT_AXIS_STEPS_PER_UNIT"))
    job.put((*path, "steps_per_mm"), steps)
    put_socket(job, path, f"E{number}", f"E{number}")
    found = defines.number(f"INVERT_E{number}_DIR")
    job.draft.put(
        (*path, "invert"), True if found and found.value else None, found.place if found else None
    )
    put_driver(job, path, f"E{number}", steps)
    path = ("extruders", name)
    job.put((*path, "speed_mm_s"), own(job.needed_list("DEFAULT_MAX_FEEDRATE")))
    job.put((*path, "accel_mm_s2"), own(job.needed_list("DEFAULT_MAX_ACCELERATION")))
    jerks = defines.numbers("DEFAULT_EJERK")
    if jerks:
        job.put((*path, "jerk_mm_s"), jerks[min(number, len(jerks) - 1)])
    if defines.on("LIN_ADVANCE"):
        factors = defines.numbers("ADVANCE_K", "LIN_ADVANCE_K")
        if factors:
            job.put((*path, "advance_s"), factors[min(number, len(factors) - 1)])


def _put_limits(job: Job) -> None:
    defines, put = job.defines, job.draft.put
    job.put(("limits", "print_accel_mm_s2"), defines.number("DEFAULT_ACCELERATION"))
    job.put(("limits", "travel_accel_mm_s2"), defines.number("DEFAULT_TRAVEL_ACCELERATION"))
    job.put(("limits", "retract_accel_mm_s2"), defines.number("DEFAULT_RETRACT_ACCELERATION"))
    deviation, classic = defines.number("JUNCTION_DEVIATION_MM"), defines.on("CLASSIC_JERK")
    if deviation is not None and not classic:
        put(("limits", "junction"), "deviation", deviation.place)
        job.put(("limits", "junction_deviation_mm"), deviation)
        return
    jerks = {axis: defines.number(f"DEFAULT_{axis.upper()}JERK") for axis in "xyz"}
    both = defines.number("DEFAULT_XYJERK")
    for axis in "xy":
        jerks[axis] = jerks[axis] or both
    if any(jerks.values()):
        place = next(found.place for found in jerks.values() if found)
        put(("limits", "junction"), "jerk", place)
        for axis, found in jerks.items():
            job.put(("axes", axis, "jerk_mm_s"), found)
