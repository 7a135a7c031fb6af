"""The chip of an eddy current probe."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.numbers import number_of
from passo.config.part_names import part_name
from passo.config.pin_names import MAIN, named_on
from passo.probes.eddy import LEAST_POINTS, EddyPoint, falls

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_HEIGHT_MM, _SCAN_MM = 2.0, 2.0
_CHIPS = ("ldc1612", "btt_eddy")
_PLUGIN = "probe_eddy_ng"
_WIRES = {"scl_pin": "i2c_software_scl_pin", "sda_pin": "i2c_software_sda_pin"}


def put_eddy_keys(job: Import, section: Section) -> str | None:
    """Imports the chip, its bus and its calibration. Returns a pin or the bus; None, which is
    reported, if it cannot be used."""
    put, path = job.draft.put, ("probe",)
    kind = section.text("sensor_type")
    if kind not in _CHIPS:
        text = f"Passo does not read the chip {kind}: levelling needs another probe, in [probe]"
        job.draft.decide(section.at("sensor_type"), f"[{section.name}]", text)
        job.leave_out(section)
        return None
    pins = {key: job.pins.of(section, option) for key, option in _WIRES.items()}
    bus = section.text("i2c_bus")
    used = pins["scl_pin"] if all(pins.values()) else None
    if used is None and bus:
        used = named_on(job.pins.further.get(section.text("i2c_mcu"), MAIN), bus)
        pins = {"i2c_bus": used}
    if used is None:
        text = "the probe is not used: give [probe] its i2c_bus, or scl_pin and sda_pin"
        job.draft.decide(section.place, f"[{section.name}]", text)
        job.leave_out(section)
        return None
    put((*path, "kind"), "eddy", section.place)
    put((*path, "name"), part_name(section.rest), section.place)
    for key, pin in pins.items():
        put((*path, key), pin, section.at(_WIRES.get(key, key)))
    section.used |= {"i2c_mcu", "i2c_bus"}
    job.put("eddy", section)
    if section.kind == _PLUGIN:
        text = "the calibration of a plug-in does not fit: send PROBE_EDDY_CURRENT_CALIBRATE"
        job.draft.changed(section.place, f"[{section.name}]", text)
    return used


def put_height(job: Import, section: Section) -> None:
    """Imports the height at which a descent ends, and the calibration. Call it after the other keys
    of a probe."""
    height = _first(section, "descend_z", "z_offset", "home_trigger_height")
    if height is None:
        height = _HEIGHT_MM
        text = f"it is not in the file: a descent ends {height:g} mm above the bed"
        job.draft.changed(section.place, f"[{section.name}] descend_z", text)
        job.draft.put(("probe", "trigger_height_mm"), height, section.place)
    _put_calibration(job, section, height)


def _first(section: Section, *options: str) -> float | None:
    """The number of the first of these options that the section has."""
    return next((mm for o in options if (mm := section.number(o)) is not None), None)


def _put_calibration(job: Import, section: Section, height: float) -> None:
    rows: list[Any] = []
    for written in section.text("calibrate").replace("\n", ",").split(","):
        if not written.strip():
            continue
        mm, _, hz = written.partition(":")
        try:
            rows.append({"mm": number_of(mm.strip()), "hz": number_of(hz.strip())})
        except ValueError:
            raise section.wrong("calibrate", "heights and frequencies", written.strip()) from None
    if not rows:
        return
    points = [EddyPoint(mm=row["mm"], hz=row["hz"]) for row in rows]
    low, high = min(p.mm for p in points), max(p.mm for p in points)
    if len(points) < LEAST_POINTS or not falls(points) or not low < height < high:
        text = "it does not fit: send PROBE_EDDY_CURRENT_CALIBRATE"
        job.draft.changed(section.at("calibrate"), f"[{section.name}] calibrate", text)
        return
    job.put_value(("probe", "calibration"), section, "calibrate", rows)
    if not low < _SCAN_MM < high:
        job.draft.put(("probe", "scan_mm"), height, section.at("calibrate"))
