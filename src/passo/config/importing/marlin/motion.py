"""Geometry, axes, motors, limits, homing and extruders."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import NO_SWITCH, PROBE_SPEEDS, Place, bad
from passo.config.importing.marlin.arms import (
    ARMS,
    FULL_TURN_DEG,
    put_arms,
    put_end_limits,
    put_home,
)
from passo.config.importing.marlin.conversion import plain
from passo.config.importing.marlin.drivers import put_driver
from passo.errors import ConfigError
from passo.geometry.delta import rise_mm

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job
    from passo.config.importing.numbers import Read

# The motors of X, Y and Z, by geometry.
MOTORS = {
    "cartesian": ("x", "y", "z"),
    "corexy": ("a", "b", "z"),
    "corexz": ("a", "y", "b"),
    "coreyz": ("x", "a", "b"),
    "delta": ("a", "b", "c"),
    "scara": ("a", "b", "z"),
}
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
_ANGLES = (210.0, 330.0, 90.0)
_TO_MM_S = 1 / 60
PROBE_FAST = ("Z_PROBE_FEEDRATE_FAST", "Z_PROBE_SPEED_FAST")  # in mm/min
_BUMPS_MM, _DIVISORS = (5.0, 5.0, 2.0), (2.0, 2.0, 4.0)  # of Marlin, if the file gives none


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
        _put_motor(job, index, letter, motor, subtracts)
        _put_homing(job, index, letter, motor)
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
    angles = [angle + (turns[i].value if turns else 0.0) for i, angle in enumerate(_ANGLES)]
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


def _put_motor(job: Job, index: int, letter: str, motor: str, subtracts: bool) -> None:
    """Converts the motor of an axis or a tower, and further motors of the same axis."""
    axis = letter.upper()
    steps = job.needed_list("DEFAULT_AXIS_STEPS_PER_UNIT")[index]
    names = [axis, *_further_motors(job, axis)]
    turns = job.kind == "scara" and letter in ARMS
    for number, name in enumerate(names):
        stepper = motor if number == 0 else f"{motor}{number}"
        path = ("steppers", stepper)
        job.put((*path, "steps_per_degree" if turns else "steps_per_mm"), steps)
        if turns:
            job.put((*path, "speed_deg_s"), job.needed_list("DEFAULT_MAX_FEEDRATE")[index])
            job.put((*path, "accel_deg_s2"), job.needed_list("DEFAULT_MAX_ACCELERATION")[index])
        _put_socket(job, path, name, axis)
        _put_inversion(job, path, axis, name if number else None, subtracts)
        put_driver(job, path, name, steps)
        if job.kind == "delta":
            job.put((*path, "speed_mm_s"), job.needed_list("DEFAULT_MAX_FEEDRATE")[index])


def _further_motors(job: Job, axis: str) -> list[str]:
    """The names of further motors of an axis: Z2, Z3."""
    defines = job.defines
    named = [
        f"{axis}{number}" for number in (2, 3, 4) if defines.first(f"{axis}{number}_DRIVER_TYPE")
    ]
    if named:
        return named
    old = (f"{axis}_DUAL_STEPPER_DRIVERS", f"{axis}_TWO_STEPPER_DRIVERS", f"{axis}_TWO_STEPPER")
    count = defines.number("NUM_Z_STEPPER_DRIVERS") if axis == "Z" else None
    if count is not None and count.value > 1:
        return [f"Z{number}" for number in range(2, count.whole(1, 4) + 1)]
    return [f"{axis}2"] if defines.on(*old) else []


def _put_socket(job: Job, path: KeyPath, name: str, axis: str) -> None:
    """Sets the socket of a motor. As in Marlin, further motors use the sockets after those of the
    extruders."""
    socket = job.pins.socket(name)
    if socket is None and not name.startswith("E") and name != axis:
        taken = [value for key, (value, _) in job.draft.keys.items() if key[-1] == "socket"]
        own = {job.pins.socket(letter) for letter in "XYZ"}
        further = [value for value in taken if value not in own]
        socket = job.pins.socket(f"E{job.extruders + len(further)}")
    if socket is None:
        place = Place(job.defines.files[0].name, 1)
        limit = f"a socket; {job.pins.board.name} has {', '.join(job.pins.board.sockets)}"
        raise bad(place, f"motor {name}", name, limit)
    job.draft.put((*path, "socket"), socket, None)


def _put_inversion(
    job: Job, path: KeyPath, axis: str, further: str | None, subtracts: bool
) -> None:
    defines = job.defines
    found = defines.number(f"INVERT_{axis}_DIR")
    inverted = bool(found and found.value) != subtracts
    if further is not None:
        against = (f"INVERT_{further}_VS_{axis}_DIR", f"INVERT_{axis}2_VS_{axis}_DIR")
        inverted = inverted != defines.on(*against)
    job.draft.put((*path, "invert"), inverted or None, found.place if found else None)
    for name, usual in ((f"{axis}_ENABLE_ON", 0), (f"INVERT_{axis}_STEP_PIN", 0)):
        value = defines.number(name)
        if value is not None and value.value != usual:
            job.decide(
                name, "the board file has drivers that are enabled by a low level: name pins"
            )


def _put_homing(job: Job, index: int, letter: str, motor: str) -> None:
    defines, put, axis = job.defines, job.draft.put, letter.upper()
    delta = job.kind == "delta"
    arm = job.kind == "scara" and letter in ARMS
    path = ("homing", motor if delta or arm else letter)
    way = defines.number(f"{axis}_HOME_DIR")
    side = "max" if delta or (way is not None and way.value > 0) else "min"
    stalls = f"{axis}_STALL_SENSITIVITY"
    if defines.first(stalls) and defines.on("SENSORLESS_HOMING"):
        home = None if delta or arm else _home_position(job, axis, side)
        end = (home.value, home.place) if home else None
        job.draft.put_no_homing(letter, end, job.place(stalls), stalls, NO_SWITCH)
        return
    place = way.place if way else None
    put((*path, "direction"), side, place)
    by_probe = letter == "z" and side == "min" and homes_by_probe(job) and not delta
    if by_probe:
        put(
            (*path, "probe"),
            True,
            job.place("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN", "USE_PROBE_FOR_Z_HOMING"),
        )
        _put_safe_home(job, path)
        speed, own = _homing_speed(job, index, axis), defines.number(*PROBE_FAST)
        if speed is not None and (own is None or own.value != speed.value):
            job.draft.changed(speed.place, speed.name, PROBE_SPEEDS)
        return
    if letter == "z" and defines.on("Z_SAFE_HOMING"):
        text = "Z homes where the nozzle is: write a macro G28 that moves it before"
        job.dropped("Z_SAFE_HOMING", text)
    _put_switch(job, path, axis, side)
    if arm:
        put_home(job, path, letter)
        put((*path, "max_travel"), FULL_TURN_DEG, None)
    else:
        _put_position(job, path, index, axis, side)
    _put_speeds(job, path, index, axis)


def homes_by_probe(job: Job) -> bool:
    """Whether the probe is the endstop of Z."""
    wired = job.defines.on("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN", "USE_PROBE_FOR_Z_HOMING")
    return wired and job.trigger_mm is not None


def _put_safe_home(job: Job, path: KeyPath) -> None:
    if not job.defines.on("Z_SAFE_HOMING"):
        return
    names = ("Z_SAFE_HOMING_X_POINT", "Z_SAFE_HOMING_Y_POINT")
    if any("CENTER" in (job.defines.text(name) or "CENTER") for name in names):
        return  # the middle, as without a place
    place = [job.needed(name).value for name in names]
    job.draft.put((*path, "probe_at_mm"), [*place], job.place(names[0]))


def switch_pin(job: Job, axis: str, side: str) -> str | None:
    """The pin of a switch with its marks; None if the board has none there."""
    defines, end = job.defines, f"{axis}_{side.upper()}"
    pin = job.pins.given(f"{end}_PIN", f"{axis}_STOP_PIN") or job.pins.endstop(axis, side)
    if pin is None:
        return None
    marks = ""
    if defines.on("ENDSTOPPULLUPS", f"ENDSTOPPULLUP_{axis}{side.upper()}"):
        marks = "^"
    elif defines.on("ENDSTOPPULLDOWNS", f"ENDSTOPPULLDOWN_{axis}{side.upper()}"):
        marks = "~"
    return f"{'!' if is_inverted(job, end) else ''}{marks}{pin}"


def is_inverted(job: Job, end: str) -> bool:
    """Whether a switch is low when it is triggered."""
    state = job.defines.text(f"{end}_ENDSTOP_HIT_STATE")
    if state is not None:
        return state in ("LOW", "0", "false")
    found = job.defines.number(f"{end}_ENDSTOP_INVERTING", f"{end}_ENDSTOP_LOGIC")
    return bool(found and found.value)


def _put_switch(job: Job, path: KeyPath, axis: str, side: str) -> None:
    defines, put = job.defines, job.draft.put
    pin = switch_pin(job, axis, side)
    place = None
    for name in ("ENDSTOP_HIT_STATE", "ENDSTOP_INVERTING", "ENDSTOP_LOGIC"):
        found = defines.first(f"{axis}_{side.upper()}_{name}")
        place = defines.place(found) if found else place
    if pin is None:
        raise bad(
            place or Place(defines.files[0].name, 1),
            f"{axis}_{side.upper()}_PIN",
            "missing",
            f"an endstop; {job.pins.board.name} has {', '.join(job.pins.board.endstops)}",
        )
    several = (f"{axis}_MULTI_ENDSTOPS", f"{axis}_DUAL_ENDSTOPS", f"{axis}_TWO_ENDSTOPS")
    if not defines.on(*several) or job.kind == "delta":
        put((*path, "pin"), pin, place)
        return
    names = _further_motors(job, axis)
    own = [_own_switch(job, name) for name in names]
    if None in own:
        put((*path, "pin"), pin, place)
        what = next(name for name in several if defines.on(name))
        job.decide(what, f"give an endstop for each motor: homing.{path[-1]}.stepper_pins")
        return
    motor = MOTORS[job.kind]["XYZ".index(axis)]
    marks = pin[: len(pin) - len(pin.lstrip("!^~"))]
    put((*path, "stepper_pins", motor), pin, place)
    for number, (name, other) in enumerate(zip(names, own, strict=True), 1):
        at = job.place(f"{name}_STOP_PIN", f"{name}_USE_ENDSTOP")
        put((*path, "stepper_pins", f"{motor}{number}"), f"{marks}{other}", at)


def _own_switch(job: Job, name: str) -> str | None:
    """The endstop of a further motor: its own pin, or the input for an end of an axis, for example
    _XMAX_."""
    used = job.defines.text(f"{name}_USE_ENDSTOP") or ""
    end = re.fullmatch(r"_([XYZ])(MIN|MAX)_", used)
    return job.pins.given(f"{name}_STOP_PIN") or (
        job.pins.endstop(end[1], end[2]) if end is not None else None
    )


def _put_position(job: Job, path: KeyPath, index: int, axis: str, side: str) -> None:
    defines = job.defines
    if job.kind == "delta":
        height, rod = (
            job.needed("DELTA_HEIGHT", "MANUAL_Z_HOME_POS"),
            job.needed("DELTA_DIAGONAL_ROD"),
        )
        radius, trims = job.needed("DELTA_RADIUS"), defines.numbers("DELTA_ENDSTOP_ADJ")
        rods = defines.numbers("DELTA_DIAGONAL_ROD_TRIM_TOWER")
        length = rod.value + (rods[index].value if rods else 0.0)
        trim = trims[index].value if trims else 0.0
        at = height.value + rise_mm(length, radius.value) - trim
        job.draft.put((*path, "position"), round(at, 6), height.place)
        return
    found = _home_position(job, axis, side)
    if found is None:
        job.draft.put((*path, "position"), 0.0, None)
    else:
        job.put((*path, "position"), found)


def _home_position(job: Job, axis: str, side: str) -> Read | None:
    """The position of an axis at its endstop, mm."""
    end = f"{axis}_{side.upper()}_POS"
    return job.defines.number(f"MANUAL_{axis}_HOME_POS", end, f"{axis}_MAX_LENGTH")


def _homing_speed(job: Job, index: int, axis: str) -> Read | None:
    """The speed towards an endstop, mm/min."""
    speeds = job.defines.numbers("HOMING_FEEDRATE_MM_M", "HOMING_FEEDRATE")
    if speeds is not None:
        return speeds[index] if index < len(speeds) else None
    group = "Z" if axis == "Z" else "XY"
    return job.defines.number(f"HOMING_FEEDRATE_{axis}", f"HOMING_FEEDRATE_{group}")


def _put_speeds(job: Job, path: KeyPath, index: int, axis: str) -> None:
    defines = job.defines
    found = _homing_speed(job, index, axis)
    divisors = defines.numbers("HOMING_BUMP_DIVISOR")
    divisor = divisors[index].value if divisors and index < len(divisors) else _DIVISORS[index]
    bumps = defines.numbers("HOMING_BUMP_MM")
    bump = bumps[index] if bumps and index < len(bumps) else defines.number(f"{axis}_HOME_BUMP_MM")
    if found is not None:
        job.put((*path, "fast"), found, _TO_MM_S)
        job.put((*path, "slow"), found, _TO_MM_S / (divisor or 1.0))
    if bump is None:
        job.draft.put((*path, "retract"), _BUMPS_MM[index], None)
    elif bump.value > 0:
        job.put((*path, "retract"), bump)
    else:
        text = "an axis approaches its endstop twice: it goes back by 3 mm between"
        job.draft.changed(bump.place, bump.name, text)


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
    _put_socket(job, path, f"E{number}", f"E{number}")
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
