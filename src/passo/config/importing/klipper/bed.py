"""The probe and the mesh."""

from __future__ import annotations

from math import floor, sqrt
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.cfg import Section
from passo.config.importing.klipper.settings import put_fade
from passo.config.importing.numbers import Read, number_of

if TYPE_CHECKING:
    from passo.config.importing.klipper.conversion import Import

START_MM, LOW_MM = 10.0, -2.0  # default heights of a descent: start and lowest
HIGHEST_MM = 100.0  # start of a descent
_ABOVE_MM, _BELOW_MM = 5.0, 2.0  # minimum distances of these heights from the trigger height
DESCENT_S = 19.0  # a descent that would take longer is refused
_SAMPLES = {"average": "mean", "median": "median"}


def put_probe(job: Import) -> None:
    """Converts [probe] or [bltouch]. Sets `job.probe_pin`, with which Z may be homed."""
    for name in ("probe", "bltouch"):
        section = job.config.get(name)
        if section is not None:
            job.part(section, _put_probe)


def _put_probe(job: Import, section: Section) -> None:
    touch = section.name == "bltouch"
    option = "sensor_pin" if touch else "pin"
    pin = job.pins.of(section, option)
    if pin is None:
        if option not in section.options:
            raise section.missing(option)
        section.used.update(section.options)
        job.left_out.add(section.name)
        return  # it is on a board that Passo does not drive
    put, path = job.draft.put, ("probe",)
    height = section.number("z_offset", 0.0) or 0.0
    put((*path, "kind"), section.name if touch else "fixed", section.place)
    put((*path, "pin"), pin, section.at(option))
    if touch:
        _put_touch(job, section)
    offset = [section.number(f"{axis}_offset", 0.0) or 0.0 for axis in "xy"]
    job.probe_offset = offset[0], offset[1]
    put((*path, "offset_mm"), [*offset], section.at("x_offset"))
    put((*path, "trigger_height_mm"), height, section.at("z_offset"))
    speed = section.number("speed", 5.0) or 5.0
    low = round(min(LOW_MM, height - _BELOW_MM), 3)
    start = round(max(height + _ABOVE_MM, min(START_MM, low + DESCENT_S * speed)), 3)
    put((*path, "low_mm"), low if low != LOW_MM else None, None)
    put((*path, "start_mm"), start if start != START_MM else None, None)
    put((*path, "fast_mm_s"), speed, section.at("speed"))
    put((*path, "slow_mm_s"), speed, section.at("speed"))
    put((*path, "lift_mm_s"), section.number("lift_speed", speed), section.at("lift_speed"))
    put(
        (*path, "retract_mm"),
        section.number("sample_retract_dist", 2.0),
        section.at("sample_retract_dist"),
    )
    put((*path, "samples"), section.whole("samples") or 1, section.at("samples"))
    result = section.text("samples_result", "average").lower()
    if result not in _SAMPLES:
        key = "samples_result in [probe]"
        raise bad(section.at("samples_result"), key, result, "median or average")
    put((*path, "result"), _SAMPLES[result], section.at("samples_result"))
    tolerance = section.number("samples_tolerance", 0.1)
    put((*path, "tolerance_mm"), tolerance, section.at("samples_tolerance"))
    retries = section.whole("samples_tolerance_retries") or 0
    put((*path, "retries"), retries, section.at("samples_tolerance_retries"))
    job.probe_pin = pin
    for name in ("activate_gcode", "deactivate_gcode"):
        if name in section.options:
            section.used.add(name)
            text = "Passo runs no G-code here: if it fetches or turns the probe, give probe.kind"
            job.draft.decide(section.at(name), f"[probe] {name}", text)


def _put_touch(job: Import, section: Section) -> None:
    """Imports the options that only a BLTouch has."""
    put, path = job.draft.put, ("probe",)
    control = section.option("control_pin")
    if control is None:
        raise bad(section.place, "control_pin in [bltouch]", "missing", "a pin of a board")
    put((*path, "control_pin"), job.pins.pin(section, "control_pin", control), control.place)
    for option, key, usual in (
        ("probe_with_touch_mode", "touch_mode", False),
        ("pin_up_touch_mode_reports_triggered", "verify", True),
    ):
        value = section.flag(option, usual)
        put((*path, key), value if value != usual else None, section.at(option))
    output = section.text("set_output_mode").lower()
    put((*path, "output"), output or None, section.at("set_output_mode"))
    section.used.add("stow_on_each_sample")


def put_mesh(job: Import) -> None:
    """Imports [bed_mesh], limited to the area that the probe reaches. Call it after the axes are
    imported."""
    section = job.config.get("bed_mesh")
    if section is not None and job.probe_pin is not None:
        job.part(section, _put_mesh)


def _put_mesh(job: Import, section: Section) -> None:
    put, path = job.draft.put, ("levelling",)
    radius = section.number("mesh_radius")
    corners = [pair(section, name) for name in ("mesh_min", "mesh_max")]
    if radius is not None:
        x, y = pair(section, "mesh_origin") or (0.0, 0.0)
        half = floor(abs(radius) / sqrt(2))
        corners = [(x - half, y - half), (x + half, y + half)]
        text = "a mesh is a square here: the one within the circle"
        job.draft.changed(section.at("mesh_radius"), "[bed_mesh] mesh_radius", text)
    if None in corners:
        job.draft.decide(section.place, "[bed_mesh]", "it has no area: choose [levelling] by hand")
        section.used.update(section.options)
        return
    put((*path, "method"), "mesh", section.place)
    written = [value for corner in corners if corner is not None for value in corner]
    area = [*reached(job, written[:2]), *reached(job, written[2:])]
    put((*path, "area"), [*area], section.at("mesh_min"))
    if area != written:
        text = "the probe does not get so far: the area is smaller"
        job.draft.changed(section.at("mesh_max"), "[bed_mesh] mesh_min, mesh_max", text)
    option = "probe_count" if radius is None else "round_probe_count"
    count = pair(section, option) or ((3.0, 3.0) if radius is None else (5.0, 5.0))
    place = section.at(option)
    counts = [Read(value, "probe_count in [bed_mesh]", place).whole() for value in count]
    put((*path, "count"), [*counts], place)
    algorithm = section.text("algorithm", "lagrange").lower()
    smooth = "bicubic" if algorithm == "bicubic" else "bilinear"
    put((*path, "interpolation"), smooth, section.at("algorithm"))
    put(("probe", "travel_mm_s"), section.number("speed"), section.at("speed"))
    margin = section.number("adaptive_margin")
    put((*path, "margin_mm"), margin or None, section.at("adaptive_margin"))
    zero = pair(section, "zero_reference_position")
    put((*path, "reference"), [*zero] if zero else None, section.at("zero_reference_position"))
    put_fade(job, section)
    if algorithm == "lagrange" and max(count) > 3:
        text = "Passo has no Lagrange surface: the mesh is bicubic"
        put((*path, "interpolation"), "bicubic", section.at("algorithm"))
        job.draft.changed(section.at("algorithm"), "[bed_mesh] algorithm", text)


def reached(job: Import, corner: list[float]) -> list[float]:
    """The place nearest to a corner that the probe can reach."""
    place: list[float] = []
    for axis, offset, at in zip("xy", job.probe_offset, corner, strict=True):
        low, high = (job.draft.number(("axes", axis, key)) for key in ("min_mm", "max_mm"))
        place.append(min(max(at, low, low + offset), high, high + offset))
    return place


def pair(section: Section, name: str) -> tuple[float, float] | None:
    """Two numbers separated by a comma, or one number for both. Raises ConfigError."""
    found = section.option(name)
    if found is None:
        return None
    parts = [part.strip() for part in found.text.split(",")]
    try:
        values = [number_of(part) for part in parts]
    except ValueError:
        raise bad(found.place, f"{name} in [{section.name}]", found.text, "two numbers") from None
    return (values[0], values[-1])
