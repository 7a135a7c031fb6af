"""A cable winch: motors with the anchors of their cables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.geometry.winch import Winch

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_FEWEST = 3  # cables of every winch


def put_winch(job: Import, printer: Section, limits: tuple[float, float]) -> dict[str, Section]:
    """Converts anchors and axes, not the motors. `limits` are speed and acceleration. Returns the
    sections of the motors, by the names of Passo. Raises ConfigError."""
    letters = "abcdefghijklmnopqrstuvwxyz"
    sections: list[Section] = []
    for number, letter in enumerate(letters):
        section = job.config.get(f"stepper_{letter}")
        if section is None and number >= _FEWEST:
            break
        sections.append(section or job.required(f"stepper_{letter}"))
    put, known = job.draft.put, Winch.motors
    if len(sections) > len(known):
        raise sections[len(known)].wrong("anchor_x", f"at most {len(known)} cables")
    anchors = [[s.needed(f"anchor_{axis}") for axis in "xyz"] for s in sections]
    put(("geometry", "anchors"), [[*anchor] for anchor in anchors], sections[0].at("anchor_x"))
    speed, accel = limits
    for i, axis in enumerate("xyz"):
        ends = [anchor[i] for anchor in anchors]
        put(("axes", axis, "min_mm"), min(ends), None)
        put(("axes", axis, "max_mm"), max(ends), None)
        put(("axes", axis, "home_mm"), min(max(0.0, min(ends)), max(ends)), None)
        put(("axes", axis, "speed_mm_s"), speed, printer.at("max_velocity"))
        put(("axes", axis, "accel_mm_s2"), accel, printer.at("max_accel"))
    for name, section in zip(known, sections, strict=False):
        job.used.add(section.name)
        if section.name != f"stepper_{name}":
            what = f"the motor is {name}, because G1 has another use for the letter"
            job.draft.changed(section.at("step_pin"), section.name, what)
    return dict(zip(known, sections, strict=False))
