"""Geometry, axes, limits and extruders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.importing.draft import bad
from passo.config.importing.marlin.arms import put_arms, put_end_limits
from passo.config.importing.marlin.drivers import put_driver
from passo.config.importing.marlin.homing import put_homing
from passo.config.importing.marlin.motors import put_motor, put_socket
from passo.config.importing.numbers import plain
from passo.errors import ConfigError
from passo.geometry.delta import ANGLES

if TYPE_CHECKING:
    from passo.config.importing.marlin.conversion import Job

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
    for index, (letter, motor) in enumerate(zip("xyz", KINDS[job.kind].motors, strict=True)):
        subtracts = chosen in _REVERSED and motor == "b"
        put_motor(job, index, letter, motor, subtracts)
        put_homing(job, index, letter, motor)
    for number in range(job.extruders):
        _put_extruder(job, number, 3 + len(beyond))
    job.rows("limits")
    _put_junction(job)


def _kind(job: Job) -> str:
    """The define of the kind of machine. Raises ConfigError for one that Passo does not have."""
    defines = job.defines
    mechanism = (defines.text("MECHANISM") or "").removeprefix("MECH_")
    named = (name for name in (*_KINDS, *_OTHER_KINDS) if defines.on(name) or mechanism == name)
    chosen = next(named, mechanism)
    if chosen in _KINDS:
        return chosen
    if chosen in ("", "CARTESIAN"):
        return "MECHANISM"
    place = defines.place(chosen if chosen in defines.found else "MECHANISM")
    limit = ", ".join(("cartesian", *_KINDS))
    raise ConfigError.of("import.kinematics", place.file, place.line, value=chosen, limit=limit)


def _put_delta(job: Job) -> None:
    put, defines = job.draft.put, job.defines
    rod = job.needed("DELTA_DIAGONAL_ROD")
    job.rows("delta")
    radius = job.draft.number(("geometry", "radius"))
    trims = defines.numbers("DELTA_DIAGONAL_ROD_TRIM_TOWER")
    turns = defines.numbers("DELTA_TOWER_ANGLE_TRIM")
    rods = [plain(rod.value + (trims[i].value if trims else 0.0)) for i in range(3)]
    put(("geometry", "rods"), [*rods], rod.place)
    angles = [angle + (turns[i].value if turns else 0.0) for i, angle in enumerate(ANGLES)]
    put(("geometry", "angles"), [*angles], turns[0].place if turns else None)
    radii = defines.numbers("DELTA_RADIUS_TRIM_TOWER")
    if radii and any(one.value for one in radii):
        job.dropped("DELTA_RADIUS_TRIM_TOWER", "all towers have one radius: calibrate with G33")
    if rod.value <= radius:
        limit = f"more than the radius of {radius:g} mm"
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
    job.needed_list("DEFAULT_MAX_FEEDRATE")
    job.needed_list("DEFAULT_MAX_ACCELERATION")
    for index, axis in enumerate("xyz"):
        if job.kind != "delta":
            job.rows("travel", axis=axis, letter=axis.upper())
        elif axis == "z":
            job.rows("delta_z")
        else:
            reach = job.needed("PRINTABLE_RADIUS", "DELTA_PRINTABLE_RADIUS")
            job.put(("axes", axis, "min_mm"), reach, -1)
            job.rows("delta_x_y", axis=axis)
            job.draft.put(("axes", axis, "home_mm"), 0.0, None)
        job.rows("axis", axis=axis, index=str(index))
    if job.kind == "scara":
        put_end_limits(job)


def _put_extruder(job: Job, number: int, first: int) -> None:
    """Converts an extruder. If each extruder has its own values, they are at `first` and after
    it."""
    name, defines = f"e{number}" if number else "e", job.defines
    steps = job.needed_list("DEFAULT_AXIS_STEPS_PER_UNIT")
    index = min(first, len(steps) - 1) + number
    path = ("steppers", name)
    job.rows("stepper", name=name, index=str(index))
    put_socket(job, path, f"E{number}", f"E{number}")
    found = defines.number(f"INVERT_E{number}_DIR")
    inverted = True if found and found.value else None
    job.draft.put((*path, "invert"), inverted, found.place if found else None)
    put_driver(job, path, f"E{number}")
    job.rows("extruder", name=name, index=str(first + number), number=str(number))


def _put_junction(job: Job) -> None:
    defines, put = job.defines, job.draft.put
    deviation, classic = defines.number("JUNCTION_DEVIATION_MM"), defines.on("CLASSIC_JERK")
    if deviation is not None and not classic:
        put(("limits", "junction"), "deviation", deviation.place)
        job.rows("deviation")
        return
    pairs = {"X": "XY", "Y": "XY", "Z": "Z"}
    names = [f"DEFAULT_{axis}JERK" for axis in ("X", "XY", "Y", "Z")]
    used = next((name for name in names if defines.first(name)), None)
    if used is not None:
        put(("limits", "junction"), "jerk", defines.place(used))
        for letter, pair in pairs.items():
            job.rows("jerk", axis=letter.lower(), letter=letter, pair=pair)
