"""The parts of a configuration other than motion, heat and bed: shaping, parking, power, laser,
display."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.shapers import SHAPER_TYPES

if TYPE_CHECKING:
    from passo.config.importing.marlin.boards import KnownBoard
    from passo.config.importing.marlin.conversion import Job

_FIXED_TIME = {"2HEI": "2hump_ei", "3HEI": "3hump_ei"}
_PRESETS = 5  # that Marlin may have
_FULL_SCALES = {"PWM255": 255.0, "PERCENT": 100.0, "SERVO": None, "RPM": None}
_DISPLAYS = {
    "REPRAP_DISCOUNT_SMART_CONTROLLER": "reprap-discount-smart",
    "REPRAP_DISCOUNT_FULL_GRAPHIC_SMART_CONTROLLER": "reprap-discount-full-graphic",
}


def put_features(job: Job) -> None:
    """Converts all of them. One that Passo cannot take is left out."""
    for name, convert in (
        ("DEFAULT_STEPPER_TIMEOUT_SEC", _put_idle),
        ("NOZZLE_PARK_FEATURE", _put_park),
        ("FWRETRACT", _put_retraction),
        ("EXTRUDE_MINTEMP", _put_cold_limit),
        ("PSU_CONTROL", _put_mains),
        ("LASER_FEATURE", _put_laser),
        ("INPUT_SHAPING_X", _put_shapers),
        ("BACKLASH_COMPENSATION", _put_backlash),
        ("PREHEAT_1_TEMP_HOTEND", _put_presets),
    ):
        job.part(name, lambda convert=convert: convert(job))


def _put_presets(job: Job) -> None:
    """Reports the presets of preheating as the commands that set them, because they are stored
    settings, not keys of the machine file."""
    words = (("H", "HOTEND"), ("B", "BED"), ("F", "FAN_SPEED"), ("F", "FAN"))
    for preset in range(1, _PRESETS + 1):
        values: dict[str, str] = {}
        names: list[str] = []
        for word, what in words:
            defines = [f"PREHEAT_{preset}_{stem}{what}" for stem in ("TEMP_", "")]
            found = job.defines.number(*defines)
            if found is not None and word not in values:
                values[word] = f"{word}{found.value:g}"
                names.append(found.name)
        if names:
            text = f"a preset is not in the machine file: M145 S{preset - 1}"
            job.decide(names[0], f"{text} {' '.join(values.values())} sets it, and M500 stores it")


def _put_backlash(job: Job) -> None:
    """Converts the corrected part of the gaps. Passo compensates axes with their own motors."""
    defines, name = job.defines, "BACKLASH_COMPENSATION"
    if not defines.on(name):
        return
    distances = defines.numbers("BACKLASH_DISTANCE_MM") or []
    correction = defines.number("BACKLASH_CORRECTION")
    smooth = defines.number("BACKLASH_SMOOTHING_MM")
    share = correction.value if correction else 0.0
    gaps = [(axis, gap) for axis, gap in zip("xyz", distances, strict=False) if gap.value > 0]
    if share <= 0 or not gaps:
        job.dropped(name, "no gap is corrected; M425 sets it")
        return
    for axis, gap in gaps:
        if axis in KINDS[job.kind].actuators:
            job.put(("backlash", f"{axis}_mm"), gap, share)
        else:
            job.dropped(name, f"no motor moves {axis.upper()} alone")
    if smooth is not None and smooth.value > 0:
        job.put(("backlash", "smooth_mm"), smooth)


def _put_shapers(job: Job) -> None:
    """Converts input shaping to a ZV shaper, with Marlin's damping ratio. The shaper of fixed-time
    motion is used if the machine starts in this mode."""
    defines, put = job.defines, job.draft.put
    fixed = defines.on("FT_MOTION", "FTM_IS_DEFAULT_MOTION") and defines.on("FTM_IS_DEFAULT_MOTION")
    for axis in "xyz":
        letter, path = axis.upper(), ("shaping", axis)
        if defines.on(f"INPUT_SHAPING_{letter}"):
            if ("laser", "pin") in job.draft.keys:
                text = "no shaping with a laser, whose power follows the plan"
                job.dropped(f"INPUT_SHAPING_{letter}", text)
                continue
            frequency = defines.number(f"SHAPING_FREQ_{letter}")
            if frequency is None or frequency.value <= 0:
                continue
            put((*path, "type"), "zv", job.place(f"INPUT_SHAPING_{letter}"))
            job.put((*path, "frequency_hz"), frequency)
            job.put((*path, "damping"), defines.number(f"SHAPING_ZETA_{letter}"))
        elif fixed:
            written = defines.text(f"FTM_DEFAULT_SHAPER_{letter}") or ""
            word = written.rpartition("_")[2]
            kind = _FIXED_TIME.get(word, word.lower())
            frequency = defines.number(
                f"FTM_SHAPING_DEFAULT_FREQ_{letter}", f"FTM_SHAPING_DEFAULT_{letter}_FREQ"
            )
            if kind not in SHAPER_TYPES or frequency is None or frequency.value <= 0:
                continue
            put((*path, "type"), kind, job.place(f"FTM_DEFAULT_SHAPER_{letter}"))
            job.put((*path, "frequency_hz"), frequency)
            job.put((*path, "damping"), defines.number(f"FTM_SHAPING_ZETA_{letter}"))


def _put_retraction(job: Job) -> None:
    """Converts the retraction of G10 and G11, if it is in use."""
    if not job.defines.on("FWRETRACT"):
        return
    for name, key in (
        ("RETRACT_LENGTH", "length_mm"),
        ("RETRACT_FEEDRATE", "speed_mm_s"),
        ("RETRACT_ZRAISE", "hop_mm"),
        ("RETRACT_RECOVER_LENGTH", "extra_mm"),
        ("RETRACT_RECOVER_FEEDRATE", "return_mm_s"),
    ):
        found = job.defines.number(name)
        if found is not None and (found.value > 0 or key == "extra_mm"):
            job.put(("retraction", key), found)


def _put_cold_limit(job: Job) -> None:
    if job.defines.on("PREVENT_COLD_EXTRUSION"):
        job.put(("limits", "min_extrude_c"), job.defines.number("EXTRUDE_MINTEMP"))


def _put_idle(job: Job) -> None:
    found = job.defines.number("DEFAULT_STEPPER_TIMEOUT_SEC", "DEFAULT_STEPPER_DEACTIVE_TIME")
    job.put(("idle", "motors_off_s"), found)


def _put_park(job: Job) -> None:
    defines = job.defines
    if not defines.on("NOZZLE_PARK_FEATURE"):
        return
    point = defines.numbers("NOZZLE_PARK_POINT")
    if point is None or len(point) < 3:
        return
    path, place = ("park",), point[0].place
    job.draft.put((*path, "position_mm"), [float(one.value) for one in point[:2]], place)
    if point[2].value >= 0:
        job.put((*path, "raise_mm"), point[2])
    job.put((*path, "speed_mm_s"), defines.number("NOZZLE_PARK_XY_FEEDRATE"))
    if defines.on("ADVANCED_PAUSE_FEATURE"):
        job.put((*path, "retract_mm"), defines.number("PAUSE_PARK_RETRACT_LENGTH"))
        job.put((*path, "retract_mm_s"), defines.number("PAUSE_PARK_RETRACT_FEEDRATE"))


def _put_mains(job: Job) -> None:
    defines = job.defines
    name = defines.first("PSU_CONTROL", "POWER_SUPPLY")
    supply = defines.number("POWER_SUPPLY")
    if name is None or (name == "POWER_SUPPLY" and (supply is None or not supply.value)):
        return
    given = job.pins.given("PS_ON_PIN")
    pin = given or ("PS_ON" if "PS_ON" in job.pins.board.pins else None)
    if pin is None:
        job.decide(name, "the pin that switches the power supply is not known: [mains] pin")
        return
    state = defines.text("PSU_ACTIVE_STATE", "PSU_ACTIVE_HIGH")
    low = state in (None, "LOW", "0", "false") and not (supply and supply.value == 2)
    job.draft.put(("mains", "pin"), f"{'!' if low else ''}{pin}", defines.place(name))
    if defines.on("PSU_DEFAULT_OFF", "PS_DEFAULT_OFF"):
        place = job.place("PSU_DEFAULT_OFF", "PS_DEFAULT_OFF")
        job.draft.put(("mains", "on_at_start"), False, place)


def _put_laser(job: Job) -> None:
    defines = job.defines
    name = next((n for n in ("LASER_FEATURE", "SPINDLE_FEATURE", "LASER") if defines.on(n)), None)
    if name is None:
        return
    pin = job.pins.given("SPINDLE_LASER_PWM_PIN")
    if pin is None:
        job.decide(name, "the output of the laser is not in the file: [laser] pin")
        return
    job.draft.put(("laser", "pin"), pin, job.place("SPINDLE_LASER_PWM_PIN"))
    unit = defines.text("CUTTER_POWER_UNIT") or "PWM255"
    scale = _FULL_SCALES.get(unit)
    if scale is None:
        job.put(("laser", "full_scale"), defines.number("SPEED_POWER_MAX"))
    else:
        place = job.place("CUTTER_POWER_UNIT") if "CUTTER_POWER_UNIT" in defines.found else None
        job.draft.put(("laser", "full_scale"), scale, place)


def put_board(job: Job, known: KnownBoard) -> None:
    """Sets the board with its display, and its connection."""
    base, variant = known.base, known.variant
    defines, put, place = job.defines, job.draft.put, job.place("MOTHERBOARD")
    put(("board", "base"), base, place)
    put(("board", "variant"), variant, place)
    for name, display in _DISPLAYS.items():
        if defines.on(name) and display in job.pins.board.displays:
            put(("board", "fitted"), [display], job.place(name))
        elif defines.first(name):
            job.dropped(name, "the display stays dark on this board")
    if known.unknown:
        text = (
            f"Passo has no file of the board {known.unknown}: the machine is simulated on the"
            f" sockets of {base}, whose pins are not yours. Import again with --board NAME if one"
            " of `passo firmware list` has the same wiring; else write a board file, and the pins"
        )
        job.draft.decide(place, "MOTHERBOARD", text)
        return
    text = "the board is simulated until [board] has link and port"
    if job.pins.board.is_klippers:
        text += ". It needs the firmware of Klipper"
    else:
        text += ". It needs Passo's firmware: passo firmware flash"
    job.draft.decide(place, "MOTHERBOARD", text)
