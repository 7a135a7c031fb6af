"""Screws, and motors that level the gantry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.klipper.bed import reached
from passo.config.importing.numbers import number_of

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_MOST_SCREWS = 99  # that Klipper counts
_THREADS = ("M3", "M4", "M5", "M6")
_FAR = "the probe does not get to X{:g} Y{:g}: give the places of [levelling.{}] by hand"


def put_levelling(job: Import) -> None:
    """Converts all sections of levelling."""
    by_probe, by_hand = job.config.get("screws_tilt_adjust"), job.config.get("bed_screws")
    screws = by_probe if by_probe is not None and job.probe_pin is not None else by_hand
    motors = job.config.get("z_tilt") or job.config.get("quad_gantry_level")
    if screws is not None:
        job.part(screws, _put_screws)
    if motors is not None and job.probe_pin is not None:
        job.part(motors, _put_motors)
    delta = job.config.get("delta_calibrate")
    if delta is not None and job.required("printer").text("kinematics") == "delta":
        job.part(delta, _put_delta)


def _put_delta(job: Import, section: Section) -> None:
    """Converts [delta_calibrate]. Without a probe, the delta is calibrated by the paper test."""
    job.put("delta_calibrate", section)
    if job.probe_pin is None:
        job.draft.put(("probe", "kind"), "manual", section.place)
    section.used.update(section.options)
    text = "calibrate the delta again, with DELTA_CALIBRATE"
    job.draft.changed(section.place, "[delta_calibrate]", text)


def _put_screws(job: Import, section: Section) -> None:
    """Converts the screws. The positions of [screws_tilt_adjust] are those of the nozzle when the
    probe is over a screw; those of [bed_screws] are the positions of the screws."""
    by_probe = section.name == "screws_tilt_adjust"
    dx, dy = job.probe_offset if by_probe else (0.0, 0.0)
    places: list[Any] = []
    names = set[str]()
    for number in range(1, _MOST_SCREWS + 1):
        place = section.pair(f"screw{number}")
        if place is None:
            break
        name = section.text(f"screw{number}_name") or f"screw {number}"
        name = name if name not in names else f"{name} {number}"
        names.add(name)
        at = [round(place[0] + dx, 4), round(place[1] + dy, 4)]
        if not _in_reach(job, section, at, "screws"):
            return
        places.append({"name": name, "x": at[0], "y": at[1]})
    path = ("levelling", "screws")
    if by_probe:
        written = section.text("screw_thread", "CW-M3")
        hand, _, size = written.upper().partition("-")
        if hand not in ("CW", "CCW") or size not in _THREADS:
            raise section.wrong("screw_thread", "CW or CCW, and M3 to M6", written)
        job.put_value((*path, "thread"), section, "screw_thread", f"{size} {hand.lower()}")
    job.draft.put((*path, "places"), places, section.place)


def _put_motors(job: Import, section: Section) -> None:
    tilt = section.name == "z_tilt"
    motors = [name for name in job.motors if name[0] == "z"]
    if tilt:
        pivots = _places(section, "z_positions")
    else:
        corners = _places(section, "gantry_corners")
        if len(corners) != 2:
            raise section.wrong("gantry_corners", "2 places")
        (x0, y0), (x1, y1) = corners
        pivots = [(x0, y0), (x0, y1), (x1, y1), (x1, y0)]
    if len(pivots) != len(motors):
        what = "z_positions" if tilt else "gantry_corners"
        limit = f"a place for each motor of Z, of which there are {len(motors)}"
        raise section.wrong(what, limit)
    path: KeyPath = ("levelling", "motors")
    points: list[Any] = []
    for x, y in _places(section, "points"):
        at = [round(x + job.probe_offset[0], 4), round(y + job.probe_offset[1], 4)]
        if not _in_reach(job, section, at, "motors"):
            return
        points.append({"x": at[0], "y": at[1]})
    put, place = job.draft.put, section.at("z_positions" if tilt else "gantry_corners")
    for motor, (x, y) in zip(motors, pivots, strict=True):
        put((*path, "pivots", motor), [x, y], place)
    put((*path, "points"), points, section.at("points"))
    if not tilt:
        job.put("quad_gantry_level", section)
    job.put("motors", section)


def _in_reach(job: Import, section: Section, at: list[float], table: str) -> bool:
    """Whether the probe gets to a place; if not, that is reported."""
    if reached(job, at) == at:
        return True
    job.draft.decide(section.place, f"[{section.name}]", _FAR.format(*at, table))
    job.leave_out(section)
    return False


def _places(section: Section, name: str) -> list[tuple[float, float]]:
    """A list of two numbers a line. Raises ConfigError."""
    found: list[tuple[float, float]] = []
    text = section.text(name)
    for line in text.splitlines():
        try:
            x, y = (number_of(part) for part in line.split(","))
        except ValueError:
            raise section.wrong(name, "two numbers with a comma", line[:40]) from None
        found.append((x, y))
    return found
