"""Endstops of axes and towers, with the speeds of homing."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.importing.draft import NO_STALLS, PROBE_SPEEDS, TWO_APPROACHES, Place, bad
from passo.config.importing.marlin.arms import ARMS, FULL_TURN_DEG, put_home
from passo.config.importing.marlin.motors import further_motors
from passo.config.stalls import STALL_KINDS
from passo.config.trinamic import chip_of
from passo.geometry.delta import rise_mm

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job
    from passo.config.importing.numbers import Read

_TO_MM_S = 1 / 60
_PROBE_FAST = ("Z_PROBE_FEEDRATE_FAST", "Z_PROBE_SPEED_FAST")  # in mm/min
_BUMPS_MM, _DIVISORS = (5.0, 5.0, 2.0), (2.0, 2.0, 4.0)  # of Marlin, if the file gives none


def put_homing(job: Job, index: int, letter: str, motor: str) -> None:
    """Converts the endstop of an axis, a tower or an arm. Raises ConfigError."""
    defines, put, axis = job.defines, job.draft.put, letter.upper()
    delta = job.kind == "delta"
    arm = job.kind == "scara" and letter in ARMS
    path = ("homing", motor if delta or arm else letter)
    home_dir = defines.number(f"{axis}_HOME_DIR")
    side = "max" if delta or (home_dir is not None and home_dir.value > 0) else "min"
    stalls = f"{axis}_STALL_SENSITIVITY"
    stalled = bool(defines.first(stalls)) and defines.on("SENSORLESS_HOMING")
    if stalled and not _put_stall(job, path, axis, side, motor):
        home = None if delta or arm else _home_position(job, axis, side)
        end = (home.value, home.place) if home else None
        job.draft.put_no_homing(letter, end, job.place(stalls), stalls, NO_STALLS)
        return
    place = home_dir.place if home_dir else None
    put((*path, "direction"), side, place)
    if stalled:
        _put_position(job, path, index, axis, side)
        job.put((*path, "fast"), _homing_speed(job, index, axis), _TO_MM_S)
        return
    by_probe = letter == "z" and side == "min" and _homes_by_probe(job) and not delta
    if by_probe:
        put(
            (*path, "probe"),
            True,
            job.place("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN", "USE_PROBE_FOR_Z_HOMING"),
        )
        _put_safe_home(job, path)
        speed, own = _homing_speed(job, index, axis), defines.number(*_PROBE_FAST)
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


def _put_stall(job: Job, path: KeyPath, axis: str, side: str, motor: str) -> bool:
    """Sets the stall detection of the motor's driver as the endstop; False if Passo does not set
    the registers of the driver, or the board has no input for it."""
    keys, tmc = job.draft.keys, ("steppers", motor, "tmc")
    chip = (
        chip_of(keys[("steppers", motor, "driver")][0]) if (*tmc, "run_current_a") in keys else None
    )
    pin = switch_pin(job, axis, side)
    if chip not in STALL_KINDS or pin is None:
        return False
    job.draft.put((*tmc, STALL_KINDS[chip].pins[-1]), pin, None)
    threshold = job.needed(f"{axis}_STALL_SENSITIVITY")
    job.draft.put((*path, "stall", "threshold"), int(threshold.value), threshold.place)
    job.rows("stall", name=path[1], letter=axis)
    return True


def _homes_by_probe(job: Job) -> bool:
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
    names = further_motors(job, axis)
    own = [_own_switch(job, name) for name in names]
    if None in own:
        put((*path, "pin"), pin, place)
        what = next(name for name in several if defines.on(name))
        job.decide(what, f"give an endstop for each motor: homing.{path[-1]}.stepper_pins")
        return
    motor = KINDS[job.kind].motors["XYZ".index(axis)]
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
    divisors = defines.numbers("HOMING_BUMP_DIVISOR") or []
    divisor = divisors[index].value if index < len(divisors) else _DIVISORS[index]
    bumps = defines.numbers("HOMING_BUMP_MM") or []
    bump = bumps[index] if index < len(bumps) else defines.number(f"{axis}_HOME_BUMP_MM")
    job.put((*path, "fast"), found, _TO_MM_S)
    job.put((*path, "slow"), found, _TO_MM_S / (divisor or 1.0))
    if bump is None:
        job.draft.put((*path, "retract"), _BUMPS_MM[index], None)
    elif bump.value > 0:
        job.put((*path, "retract"), bump)
    else:
        job.draft.changed(bump.place, bump.name, TWO_APPROACHES)
