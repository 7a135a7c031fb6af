"""The probe and the mesh."""

from __future__ import annotations

from math import floor, sqrt
from typing import TYPE_CHECKING

from passo.config.importing.klipper.eddy import put_eddy_keys, put_height
from passo.config.importing.numbers import Read

if TYPE_CHECKING:
    from passo.config.importing.draft import Value
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

START_MM, LOW_MM = 10.0, -2.0  # default heights of a descent: start and lowest
HIGHEST_MM = 100.0  # start of a descent
_ABOVE_MM, _BELOW_MM = 5.0, 2.0  # minimum distances of these heights from the trigger height
_MOST_REGIONS = 99  # that Klipper has
DESCENT_S = 19.0  # a descent that would take longer is refused


_KINDS = {"probe": "fixed", "bltouch": "bltouch", "smart_effector": "nozzle"}
EDDIES = ("probe_eddy_current", "probe_eddy_ng")


def put_probe(job: Import) -> None:
    """Converts the section of the probe. Sets `job.probe_pin`, with which Z may be homed."""
    job.parts(*_KINDS, convert=_put_probe)
    eddies = [section for kind in EDDIES for section in job.config.of(kind)]
    if job.probe_pin is None and eddies:
        job.part(eddies[0], put_eddy)


def _put_probe(job: Import, section: Section) -> None:
    touch = section.name == "bltouch"
    option, path = "sensor_pin" if touch else "pin", ("probe",)
    pin = job.pins.of(section, option)
    if pin is None:
        if option not in section.options:
            raise section.missing(option)
        job.leave_out(section)
        return  # it is on a board that Passo does not drive
    job.draft.put((*path, "kind"), _KINDS[section.name], section.place)
    job.put_value((*path, "pin"), section, option, pin)
    if touch:
        job.put("bltouch", section)
        section.used.add("stow_on_each_sample")
    elif section.name == "smart_effector":
        job.put("smart_effector", section)
    put_common(job, section, pin)


def put_common(job: Import, section: Section, pin: str) -> None:
    """Imports the offsets, the heights and the speeds of a probe at a pin or a bus."""
    path = ("probe",)
    x, y = (section.number(f"{axis}_offset", 0.0) or 0.0 for axis in "xy")
    job.probe_offset = x, y
    job.put_value((*path, "offset_mm"), section, "x_offset", [x, y])
    job.put("probe", section)
    height = job.draft.number((*path, "trigger_height_mm"))
    speed = job.draft.number((*path, "fast_mm_s"))
    low = round(min(LOW_MM, height - _BELOW_MM), 3)
    start = round(max(height + _ABOVE_MM, min(START_MM, low + DESCENT_S * speed)), 3)
    job.draft.put((*path, "low_mm"), low if low != LOW_MM else None, None)
    job.draft.put((*path, "start_mm"), start if start != START_MM else None, None)
    job.probe_pin = pin


def put_eddy(job: Import, section: Section) -> None:
    """Imports an eddy current probe."""
    bus = put_eddy_keys(job, section)
    if bus is not None:
        put_common(job, section, bus)
        put_height(job, section)


def put_twist(job: Import) -> None:
    """Converts the twist of the axes, if the machine has a probe."""
    if job.probe_pin is not None:
        job.parts("axis_twist_compensation", convert=_put_twist)


def _put_twist(job: Import, section: Section) -> None:
    for axis, stored in (("x", "z_compensations"), ("y", "zy_compensations")):
        if f"calibrate_start_{axis}" not in section.options:
            continue
        job.put(f"twist_{axis}", section)
        path = "probe", "twist", axis
        for end, key in (("start", "from_mm"), ("end", "to_mm")):
            mm = section.number(f"compensation_{end}_{axis}")
            if mm is not None:  # where the stored heights were measured
                job.draft.put((*path, key), mm, section.at(f"compensation_{end}_{axis}"))
        heights = section.numbers(stored, "heights in mm, with commas between them")
        job.put_value(
            (*path, "heights_mm"), section, stored, None if heights is None else [*heights]
        )


def put_mesh(job: Import) -> None:
    """Imports [bed_mesh], limited to the area that the probe reaches. Call it after the axes are
    imported."""
    if job.probe_pin is not None:
        job.parts("bed_mesh", convert=_put_mesh)


def _put_mesh(job: Import, section: Section) -> None:
    put, path = job.draft.put, ("levelling",)
    radius = section.number("mesh_radius")
    corners = [section.pair(name) for name in ("mesh_min", "mesh_max")]
    if radius is not None:
        x, y = section.pair("mesh_origin") or (0.0, 0.0)
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
    count = section.pair(option) or ((3.0, 3.0) if radius is None else (5.0, 5.0))
    place = section.at(option)
    counts = [Read(value, "probe_count in [bed_mesh]", place).whole() for value in count]
    put((*path, "count"), [*counts], place)
    algorithm = section.text("algorithm", "lagrange").lower()
    smooth = "bicubic" if algorithm == "bicubic" else "bilinear"
    put((*path, "interpolation"), smooth, section.at("algorithm"))
    job.put("mesh", section)
    section.used |= {"fade_start", "fade_target"}
    _put_avoided(job, section)
    if algorithm == "lagrange" and max(count) > 3:
        text = "Passo has no Lagrange surface: the mesh is bicubic"
        put((*path, "interpolation"), "bicubic", section.at("algorithm"))
        job.draft.changed(section.at("algorithm"), "[bed_mesh] algorithm", text)


def _put_avoided(job: Import, section: Section) -> None:
    """Imports the regions in which the probe cannot measure."""
    regions: list[Value] = []
    for number in range(1, _MOST_REGIONS + 1):
        corners = [section.pair(f"faulty_region_{number}_{end}") for end in ("min", "max")]
        if None not in corners:
            regions.append([mm for corner in corners if corner is not None for mm in corner])
    job.put_value(("levelling", "avoid"), section, "faulty_region_1_min", regions or None)


def reached(job: Import, corner: list[float]) -> list[float]:
    """The place nearest to a corner that the probe can reach."""
    place: list[float] = []
    for axis, offset, at in zip("xy", job.probe_offset, corner, strict=True):
        low, high = (job.draft.number(("axes", axis, key)) for key in ("min_mm", "max_mm"))
        place.append(min(max(at, low, low + offset), high, high + offset))
    return place
