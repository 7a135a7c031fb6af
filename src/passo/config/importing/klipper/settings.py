"""What SAVE_CONFIG has stored under names: [bed_mesh NAME] and [skew_correction NAME]."""

from __future__ import annotations

import re
from itertools import product
from string import digits
from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.importing.draft import StoredHeights
from passo.config.importing.numbers import number_of
from passo.geometry.core_belts import CoreBelts
from passo.geometry.skewable import SkewableModel

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}")
_STORE = "`passo import --state DIR` stores {}, for `passo serve --state DIR`; {} LOAD={} uses it"
_PLANES = ("xy", "xz", "yz")


def put_settings(job: Import) -> None:
    """Imports the stored meshes and skews."""
    for section in job.config.of("bed_mesh"):
        if section.rest:
            job.part(section, _put_heights)
    for section in job.config.of("skew_correction"):
        job.part(section, _put_skew)


def _put_heights(job: Import, section: Section) -> None:
    rows = [row for row in section.text("points").splitlines() if row.strip()]
    try:
        heights = [[number_of(mm) for mm in row.strip(" ,").split(",")] for row in rows]
    except ValueError:
        raise section.wrong("points", "rows of heights in mm") from None
    x, y = ((section.needed(f"min_{a}"), section.needed(f"max_{a}")) for a in "xy")
    if min(len(heights), *map(len, heights), 2) < 2 or len({*map(len, heights)}) > 1:
        raise section.wrong("points", "at least two rows of the same length")
    name, bicubic = _name(section), section.text("algo") == "bicubic"
    job.draft.meshes.append(StoredHeights(name, x, y, heights, bicubic or len(heights) > 3))
    section.used.update(section.options)
    text = _STORE.format("its heights", "BED_MESH_PROFILE", name)
    job.draft.decide(section.place, f"[{section.name}]", text)


def _put_skew(job: Import, section: Section) -> None:
    """Imports a skew, which is not in force until it is loaded."""
    factors = {plane: section.number(f"{plane}_skew", 0.0) or 0.0 for plane in _PLANES}
    if not any(factors.values()):
        return
    name, values = _name(section), (f"{p.upper()}={mm:.9f}" for p, mm in factors.items())
    job.draft.commands.append(f"SKEW_PROFILE SET={name} {' '.join(values)}")
    text = _STORE.format("it", "SKEW_PROFILE", name) + _put_reach(job, section, factors)
    job.draft.decide(section.place, f"[{section.name}]", text)


def _put_reach(job: Import, section: Section, factors: dict[str, float]) -> str:
    """Sets the reach of motors that skew moves beyond their axes: as in Klipper, that of the axis.
    Carriages on crossed belts must reach more, so that the rest of the sentence asks for it."""
    keys = job.draft.keys
    reaches: list[str] = []
    model = KINDS.get(str(keys["geometry", "kind"][0]))
    if model is None or not issubclass(model, SkewableModel):
        return ", on a cartesian machine or crossed belts only"
    skewed = model.model_validate(
        {"kind": keys["geometry", "kind"][0], "skew": [*factors.values()]}
    )
    ends = {axis: [_axis_mm(job, axis, end) for end in ("min_mm", "max_mm")] for axis in "xyz"}
    if not issubclass(model, CoreBelts):
        for motor in job.motors:
            if (axis := motor.rstrip(digits)) in skewed.sheared_axes:
                for key, mm in zip(("min_mm", "max_mm"), ends[axis], strict=True):
                    job.draft.put(("steppers", motor, key), mm, section.place)
        return ""
    corners = [skewed.carriages((x, y, z)) for x, y, z in product(*ends.values())]
    for axis in skewed.sheared_axes:
        places = [corner["xyz".index(axis)] for corner in corners]
        reaches.append(f"reach_{axis}_mm = [{min(places):.2f}, {max(places):.2f}]")
    return (
        f", when geometry has {' and '.join(reaches)}, if the carriages reach so far; if not,"
        " shorten the axes"
    )


def _axis_mm(job: Import, axis: str, key: str) -> float:
    return float(str(job.draft.keys["axes", axis, key][0]))


def _name(section: Section) -> str:
    """The name of a stored mesh or skew. Raises ConfigError for one that Passo cannot have."""
    if not _NAME.fullmatch(section.rest):
        raise section.wrong("version", "a name of letters, digits, _, . and -", section.rest)
    return section.rest
