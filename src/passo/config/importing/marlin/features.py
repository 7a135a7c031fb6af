"""The parts of a configuration other than motion, heat and bed: shaping, parking, power, laser,
display."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.importing.marlin.conversion import TABLE
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
        ("NOZZLE_PARK_FEATURE", _put_park),
        ("PSU_CONTROL", _put_mains),
        ("LASER_FEATURE", _put_laser),
        ("INPUT_SHAPING_X", _put_shapers),
        ("BACKLASH_COMPENSATION", _put_backlash),
        ("FILAMENT_RUNOUT_SENSOR", _put_runout),
        ("PREHEAT_1_TEMP_HOTEND", _put_presets),
    ):
        job.part(name, partial(convert, job))
    for name, group in TABLE.groups.items():
        if group.alone:
            job.part(group.of.partition(",")[0], partial(job.rows, name))


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


def _put_runout(job: Job) -> None:
    """Converts the switches of the filament, or the sensors of its motion. A switch is at the given
    level while there is no filament."""
    defines, name = job.defines, "FILAMENT_RUNOUT_SENSOR"
    if not defines.on(name):
        return
    count = defines.number("NUM_RUNOUT_SENSORS")
    sensors = int(count.value) if count else 1
    for number in range(1, sensors + 1):
        names = [f"FIL_RUNOUT{number}_PIN", *(["FIL_RUNOUT_PIN"] if number == 1 else [])]
        pin = job.pins.given(*names)
        part = "runout" if number == 1 else f"runout{number}"
        path = ("filament_sensors", part)
        if pin is None:
            text = f"the pin of the sensor is not in the file: [filament_sensors.{part}] pin"
            job.decide(name, text)
            continue
        inverted = defines.text(f"FIL_RUNOUT{number}_STATE", "FIL_RUNOUT_STATE") == "HIGH"
        pulled = defines.on(f"FIL_RUNOUT{number}_PULLUP", "FIL_RUNOUT_PULLUP")
        mark = f"{'!' if inverted else ''}{'^' if pulled else ''}"
        job.draft.put((*path, "pin"), f"{mark}{pin}", job.place(*names))
        if sensors > 1:
            job.draft.put((*path, "extruder"), "e" if number == 1 else f"e{number - 1}", None)
        moves = defines.on("FILAMENT_MOTION_SENSOR")
        job.draft.put((*path, "kind"), "motion" if moves else "switch", None)
        length = defines.number("FILAMENT_RUNOUT_DISTANCE_MM")
        job.put((*path, "length_mm" if moves else "delay_mm"), length)
        job.rows("runout", name=part)


def _put_backlash(job: Job) -> None:
    """Converts the corrected part of the gaps. Passo compensates axes with their own motors."""
    defines, name = job.defines, "BACKLASH_COMPENSATION"
    if not defines.on(name):
        return
    distances = defines.numbers("BACKLASH_DISTANCE_MM") or []
    correction = defines.number("BACKLASH_CORRECTION")
    share = correction.value if correction else 0.0
    gaps = [(axis, gap) for axis, gap in zip("xyz", distances, strict=False) if gap.value > 0]
    defines.first("BACKLASH_SMOOTHING_MM")
    if share <= 0 or not gaps:
        job.dropped(name, "no gap is corrected; M425 sets it")
        return
    for axis, gap in gaps:
        if axis in KINDS[job.kind].motors:
            job.put(("backlash", f"{axis}_mm"), gap, share)
        else:
            job.dropped(name, f"no motor moves {axis.upper()} alone")
    job.rows("backlash")


def _put_shapers(job: Job) -> None:
    """Converts input shaping to a ZV shaper, with Marlin's damping ratio. The shaper of fixed-time
    motion is used if the machine starts in this mode."""
    defines = job.defines
    fixed = defines.on("FT_MOTION", "FTM_IS_DEFAULT_MOTION") and defines.on("FTM_IS_DEFAULT_MOTION")
    for axis, letter in zip("xyz", "XYZ", strict=True):
        define, group, kind = f"INPUT_SHAPING_{letter}", "shaping", "zv"
        if defines.on(define):
            if ("laser", "pin") in job.draft.keys:
                job.dropped(define, "no shaping with a laser, whose power follows the plan")
                continue
            names = [f"SHAPING_FREQ_{letter}"]
        elif fixed:
            define, group = f"FTM_DEFAULT_SHAPER_{letter}", "fixed_time"
            word = (defines.text(define) or "").rpartition("_")[2]
            kind = _FIXED_TIME.get(word, word.lower())
            names = [f"FTM_SHAPING_DEFAULT_{at}" for at in (f"FREQ_{letter}", f"{letter}_FREQ")]
        else:
            continue
        frequency = defines.number(*names)
        if kind in SHAPER_TYPES and frequency is not None and frequency.value > 0:
            job.draft.put(("shaping", axis, "type"), kind, job.place(define))
            job.rows(group, axis=axis, letter=letter)


def _put_park(job: Job) -> None:
    point = job.defines.on("NOZZLE_PARK_FEATURE") and job.defines.numbers("NOZZLE_PARK_POINT")
    if point and len(point) > 2:
        at = [float(one.value) for one in point[:2]]
        job.draft.put(("park", "position_mm"), [*at], point[0].place)
        job.put(("park", "raise_mm"), point[2] if point[2].value >= 0 else None)
        job.rows("park")


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
    job.rows("mains")


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
