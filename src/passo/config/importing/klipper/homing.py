"""The endstops of axes and towers, with the speeds of homing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import NO_ENDSTOP, PROBE_SPEEDS, TWO_APPROACHES
from passo.config.importing.klipper.safe_home import put_safe_home_of_probe
from passo.config.importing.klipper.stalls import by_stall, put_stall
from passo.geometry.delta import rise_mm

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_OF_HOMING = (
    "endstop_pin",
    "position_endstop",
    "homing_speed",
    "second_homing_speed",
    "homing_retract_dist",
)


def put_homing(
    job: Import,
    sections: list[Section],
    names: list[str],
    letter: str,
    motor: str,
    part: str | None = None,
) -> None:
    """Imports the endstops of an axis or a tower. `names` are the motors of the `sections`; `motor`
    is the first one. `part` is what is homed, if that is neither the axis nor a tower."""
    first, put = sections[0], job.draft.put
    path = ("homing", part or (motor if letter in "abc" else letter))
    written = first.text("endstop_pin")
    by_probe = "probe" in written and "virtual_endstop" in written
    if by_stall(written):
        _put_stall_homing(job, sections, names, letter, path)
        return
    if "virtual_endstop" in written and (not by_probe or job.probe_pin is None):
        why = "Passo does not have this probe" if by_probe else NO_ENDSTOP
        _put_no_homing(job, sections, letter, why)
        return
    if by_probe:
        put((*path, "direction"), "min", first.at("endstop_pin"))
        put((*path, "probe"), True, first.at("endstop_pin"))
        put_safe_home_of_probe(job, path)
        _remark_on_speed(job, first)
        for section in sections:
            section.used.update(_OF_HOMING)
        return
    found = first.option("endstop_pin")
    if found is None:
        raise first.missing("endstop_pin")
    pin = job.pins.pin(first, "endstop_pin", found)
    if pin is None:
        _put_no_homing(job, sections, letter, "Passo does not reach its endstop")
        return
    if not _put_position(job, sections, letter, path):
        return
    _put_switches(job, sections, names, path, pin)
    _put_homing_speeds(job, first, path, letter)


def _put_stall_homing(
    job: Import, sections: list[Section], names: list[str], letter: str, path: KeyPath
) -> None:
    why = put_stall(job, sections, names, path)
    if why:
        _put_no_homing(job, sections, letter, why)
        return
    if not _put_position(job, sections, letter, path):
        return
    first = job.required("stepper_a") if letter in "abc" else sections[0]
    job.put("homing", sections[0], first, name=path[1])
    for section in sections:
        section.used.update(_OF_HOMING)


def _put_position(job: Import, sections: list[Section], letter: str, path: KeyPath) -> bool:
    """Sets the side and the position of an endstop; False if the file does not have them."""
    first, put = sections[0], job.draft.put
    towers = (job.config.get("stepper_a") or first) if letter in "abc" else first
    position = first.number("position_endstop", towers.number("position_endstop"))
    if position is None:
        _put_no_homing(job, sections, letter, "position_endstop is not in the file")
        return False
    place = first.at("endstop_pin")
    put((*path, "direction"), _direction(job, first, letter, position), place)
    if letter in "abc":
        position = _carriage_mm(job, first, position)
    put((*path, "position"), position, first.at("position_endstop"))
    return True


def _put_switches(
    job: Import, sections: list[Section], names: list[str], path: KeyPath, pin: str
) -> None:
    """Sets an endstop for each motor, or that of the first one, `pin`, for all."""
    put, (first, *further) = job.draft.put, sections
    own = {n: job.pins.of(s, "endstop_pin") for n, s in zip(names[1:], further, strict=True)}
    place = first.at("endstop_pin")
    if own and all(own.values()):
        put((*path, "stepper_pins", names[0]), pin, place)
        for name, section in zip(names[1:], further, strict=True):
            put((*path, "stepper_pins", name), own[name], section.at("endstop_pin"))
        return
    put((*path, "pin"), pin, place)
    if any(own.values()):
        text = "motors without an endstop of their own: all of the axis stop at the first one"
        job.draft.decide(place, f"[{first.name}] endstop_pin", text)


def _put_no_homing(job: Import, sections: list[Section], letter: str, why: str) -> None:
    first = sections[0]
    for section in sections:
        section.used.update(_OF_HOMING)
    what = f"[{first.name}] endstop_pin {first.text('endstop_pin')}"
    mm, place = first.number("position_endstop"), first.at("endstop_pin")
    end = None if mm is None else (mm, first.at("position_endstop"))
    job.draft.put_no_homing(letter, end, place, what, why)


def _remark_on_speed(job: Import, section: Section) -> None:
    """Reports speeds of homing that the probe does not have."""
    speed = section.number("homing_speed")
    if speed is not None and speed != job.draft.number(("probe", "fast_mm_s")):
        place = section.at("homing_speed")
        job.draft.changed(place, f"[{section.name}] homing_speed {speed:g}", PROBE_SPEEDS)


def _put_homing_speeds(job: Import, section: Section, path: KeyPath, letter: str) -> None:
    """Imports the homing speeds; all towers have the speeds of the first one."""
    first = job.required("stepper_a") if letter in "abc" else section
    job.put("homing", section, first, name=path[1])
    option, source = "second_homing_speed", section
    if option not in section.options:
        source = first
    # Klipper's default for the second approach is half the speed of the first
    slow = source.number(option, job.draft.number((*path, "fast")) / 2)
    section.used.add(option)
    job.put_value((*path, "slow"), source, option, slow or None)
    if (*path, "retract") not in job.draft.keys:
        what = f"[{section.name}] homing_retract_dist 0"
        job.draft.changed(section.at("homing_retract_dist"), what, TWO_APPROACHES)


def _direction(job: Import, section: Section, letter: str, position: float) -> str:
    if letter in "abc":
        return "max"
    if "homing_positive_dir" in section.options:
        return "max" if section.flag("homing_positive_dir", False) else "min"
    low, high = section.number("position_min", 0.0), section.needed("position_max")
    assert low is not None
    return "min" if position <= (low + high) / 2 else "max"


def _carriage_mm(job: Import, section: Section, height: float) -> float:
    """The height of a carriage at its endstop, mm: the nozzle height plus the rise of the rod with
    the nozzle in the middle."""
    first = job.required("stepper_a")
    rod = section.number("arm_length", first.needed("arm_length"))
    radius = job.required("printer").needed("delta_radius")
    assert rod is not None
    if rod <= radius:
        raise section.wrong("arm_length", f"more than {radius:g}", f"{rod:g}")
    return round(height + rise_mm(rod, radius), 6)
