"""[safe_z_home] and [homing_override]: the nozzle moves to a place where Z can be homed. For a
probe this is a key of the machine file, otherwise a macro G28."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.klipper.bed import DESCENT_S, HIGHEST_MM, LOW_MM, START_MM

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_HOME = "G28.1"  # the command of Passo, for a macro G28
_SAVED = "safe_z_home"  # the name under which the macro saves the modes


def put_safe_home_of_probe(job: Import, path: KeyPath) -> None:
    """Imports [safe_z_home] of a machine that homes Z with a probe: Passo rises to the start of a
    descent before X and Y move, and descends at `probe_at_mm`."""
    section = job.config.get("safe_z_home")
    place = section.pair("home_xy_position") if section else None
    if section is None or place is None:
        return
    job.used.add(section.name)
    at = [round(mm + offset, 4) for mm, offset in zip(place, job.probe_offset, strict=True)]
    job.draft.put((*path, "probe_at_mm"), [*at], section.at("home_xy_position"))
    _put_rise(job, section)
    mesh = job.config.get("bed_mesh")
    if mesh is None or "speed" not in mesh.options:
        job.draft.put(("probe", "travel_mm_s"), section.number("speed"), section.at("speed"))
    _remark_on_return(job, section)


def _put_rise(job: Import, section: Section) -> None:
    """Makes a descent start at least as high as z_hop, as far as a descent may be so long."""
    hop, place, draft = section.number("z_hop"), section.at("z_hop"), job.draft
    if hop is None:
        return
    keys = ("probe", "start_mm"), ("probe", "low_mm")
    start = draft.number(keys[0]) if keys[0] in draft.keys else START_MM
    low = draft.number(keys[1]) if keys[1] in draft.keys else LOW_MM
    if hop > start:
        longest = low + DESCENT_S * draft.number(("probe", "fast_mm_s"))
        start = round(max(start, min(hop, longest, HIGHEST_MM)), 3)
        draft.put(keys[0], start, place)
    if hop != start:
        text = f"the nozzle rises by probe.start_mm, {start:g} mm"
        draft.changed(place, f"[{section.name}] z_hop {hop:g}", text)


def put_homing_macro(job: Import) -> None:
    """Imports [homing_override], or a [safe_z_home] of a machine that homes Z with a switch, as a
    macro G28."""
    override, safe = job.config.get("homing_override"), job.config.get("safe_z_home")
    section = override or safe
    if section is None or section.name in job.used:
        return
    job.used.add(section.name)
    path, put = ("macros", "G28"), job.draft.put
    if path in {key[:2] for key in job.draft.keys}:
        text = "the macro G28 replaces it: home Z only where its switch or the probe can trigger"
        job.draft.decide(section.place, f"[{section.name}]", text)
        section.used.update(section.options)
        return
    text = f"it is a macro G28, which reaches the command of Passo as {_HOME}"
    if section is override:
        put((*path, "gcode"), _override(section), section.at("gcode"))
    else:
        put((*path, "gcode"), _safe_home(job, section), section.at("home_xy_position"))
        if section.number("z_hop"):
            text += ". While Z is not homed, G28 X and G28 Y do not rise"
    put((*path, "rename_existing"), _HOME, None)
    job.draft.changed(section.place, f"[{section.name}]", text)


def _override(section: Section) -> str:
    """The G-code of [homing_override], for a G28 without letters or with one of its axes."""
    axes = [letter for letter in section.text("axes", "xyz").lower() if letter in "xyz"]
    set_to = {axis.upper(): section.number(f"set_position_{axis}") for axis in "xyz"}
    places = " ".join(f"{axis}{mm:g}" for axis, mm in set_to.items() if mm is not None)
    gcode = section.commented(
        "gcode"
    )  # within the macro G28, also in other macros, G28 is the command
    body = f"G92 {places}\n{gcode}" if places else gcode
    asked = " or ".join(f"'{axis.upper()}' in params" for axis in axes)
    alone = "not ('X' in params or 'Y' in params or 'Z' in params)"
    return (
        f"{{% if {asked} or {alone} %}}\n{body}\n{{% else %}}\n{_HOME} {{rawparams}}\n{{% endif %}}"
    )


def _safe_home(job: Import, section: Section) -> str:
    """The moves of [safe_z_home] in machine coordinates, without those that no axis needs."""
    found = section.pair("home_xy_position")
    if found is None:
        raise section.missing("home_xy_position")
    hop, speed = section.number("z_hop", 0.0) or 0.0, section.number("speed", 50.0) or 50.0
    feed = (section.number("z_hop_speed", 15.0) or 15.0) * 60
    _remark_on_return(job, section)
    ends = (("homing", "z", "position"), ("axes", "z", "home_mm"))
    home = next((job.draft.number(end) for end in ends if end in job.draft.keys), 0.0)
    rise = f"""\
{{% if 'z' in homed %}}
{{% if printer.toolhead.position.z < {hop:g} %}}
G53 G1 Z{hop:g} F{feed:g}
{{% endif %}}
{{% elif z %}}
G92 Z0
G1 Z{hop:g} F{feed:g}
{{% endif %}}
"""
    again = f"G53 G1 Z{hop:g} F{feed:g}\n" if home < hop else ""
    return f"""\
{{% set every = not ('X' in params or 'Y' in params or 'Z' in params) %}}
{{% set x, y, z = every or 'X' in params, every or 'Y' in params, every or 'Z' in params %}}
{{% set homed = printer.toolhead.homed_axes %}}
{{% if not ('O' in params and homed == 'xyz') %}}
SAVE_GCODE_STATE NAME={_SAVED}
G21
G90
{rise if hop > 0 else ""}\
{{% if x or y %}}
{_HOME}{{' X' if x else ''}}{{' Y' if y else ''}}
{{% endif %}}
{{% if z %}}
G53 G1 X{found[0]:g} Y{found[1]:g} F{speed * 60:g}
{_HOME} Z
{again}\
{{% endif %}}
RESTORE_GCODE_STATE NAME={_SAVED}
{{% endif %}}"""


def _remark_on_return(job: Import, section: Section) -> None:
    if section.flag("move_to_previous", False):
        text = "the nozzle stays where Z was homed"
        place = section.at("move_to_previous")
        job.draft.dropped(place, f"[{section.name}] move_to_previous", text)
