"""Converts a document of APrinter's configuration editor to a draft of a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.aprinter.arms import ARMS, put_arms, put_home
from passo.config.importing.aprinter.boards import Pins
from passo.config.importing.aprinter.conversion import TABLE, Job
from passo.config.importing.aprinter.document import (
    Node,
    Stored,
    document,
    missing,
    stored_options,
)
from passo.config.importing.aprinter.heat import heater_name, put_heat
from passo.config.importing.draft import Draft, bad
from passo.config.importing.sources import MAX_BYTES, Sources
from passo.config.importing.table import report
from passo.errors import ConfigError
from passo.geometry.delta import rise_mm

if TYPE_CHECKING:
    from pathlib import Path

_KINDS = {  # of a transform: the kind of Passo's geometry
    "NoTransform": "cartesian",
    "Null": "cartesian",
    "CoreXY": "corexy",
    "Delta": "delta",
    "SCARA": "scara",
    "DualSCARA": "dual_scara",
    "RotationalDelta": "rotary_delta",
}
_HOOKS = {"After homing": "after_homing", "After bed probing": "after_probing"}


def imported(path: Path, stored: Path | None = None, *, board: str | None = None) -> Draft:
    """The machine file of the selected configuration, with remarks. `stored` is a file with changed
    options: aprinter.cfg, or an answer to M503. `board` is the board file to use. Raises
    ConfigError."""
    sources = Sources(max_line=MAX_BYTES)  # a document may be one line
    root = document(sources.read(path), path)
    options = stored_options(sources.read(stored), stored.name) if stored else Stored()
    config, draft = _selected(root), Draft()
    job = Job(config, Pins(root, config.within("board"), board), options, draft)
    draft.put_head(path, config.text("name"))
    _put_motion(job)
    _put_probe(job)
    put_heat(job)
    _put_cold(job)
    _put_moves(job)
    for key, row in TABLE.notes("values").items():
        if config.each(key):
            report(draft, row, config.within(key).place, key)
    job.rows("machine", config)
    draft.put(("board", "base"), job.pins.base, config.within("board").place)
    text = "the board is simulated until [board] has link and port. It needs Passo's firmware"
    draft.decide(config.within("board").place, "board", f"{text}: passo firmware flash")
    for name in sorted(options.options.keys() - options.used):
        value, place = options.options[name]
        draft.dropped(place, name, f"Passo has no such setting, {value} here")
    return draft


def _selected(root: Node) -> Node:
    wanted = root.text("selected_config")
    found = root.each("configurations")
    chosen = [config for config in found if config.text("name") == wanted] or found[:1]
    if not chosen:
        raise missing(root.place, "configurations")
    return chosen[0]


def _put_motion(job: Job) -> None:
    transform = job.config.within("transform")
    kind = transform.kind
    if kind not in _KINDS:
        place, limit = transform.place, ", ".join(_KINDS)
        raise ConfigError.of("import.kinematics", place.file, place.line, value=kind, limit=limit)
    job.draft.put(("geometry", "kind"), _KINDS[kind], transform.place)
    taken: list[Node] = []
    if kind == "Delta":
        taken = _put_delta(job, transform)
    elif kind in ARMS:
        taken = put_arms(job, transform)
        for arm in taken:
            _put_homing(job, job.motors[arm.text("Name")], arm)
        put_home(job, transform)
    elif kind == "CoreXY":
        taken = job.transform_steppers(transform, "ab")
        _put_virtual_axes(job, transform, taken, "XY")
    for axis in transform.each("IdentityAxes"):
        stepper = job.stepper(axis.get("StepperName"))
        taken.append(stepper)
        _put_axis(job, axis.text("Name").lower(), stepper, axis)
    for stepper in job.config.each("steppers"):
        if not any(stepper is one for one in taken):
            _put_axis(job, stepper.text("Name").lower(), stepper, None)
    for stepper in job.config.each("steppers"):
        _put_motors(job, stepper)
    job.draft.put(("limits", "junction"), "cornering_distance", None)


def _put_virtual_axes(job: Job, transform: Node, steppers: list[Node], letters: str) -> None:
    """Converts axes with several motors. Their acceleration is that of the slowest motor."""
    accels = [job.stored.needed(s, "MaxAccel", f"{s.text('Name')}MaxAccel") for s in steppers]
    accel = min(accels, key=lambda found: found.value)
    for index, _ in enumerate(letters):
        node = transform.within("CartesianAxes", f"VirtualAxis{index}")
        letter = node.text("Name")
        job.rows("virtual_axis", node, letter, name=letter.lower())
        job.put(("axes", letter.lower(), "accel_mm_s2"), accel)
        if transform.kind == "CoreXY":
            _put_homing(job, letter.lower(), node)


def _put_delta(job: Job, transform: Node) -> list[Node]:
    steppers, put = job.transform_steppers(transform, "abc"), job.draft.put
    offsets = [
        job.stored.needed(transform, key, f"Delta{key}")
        for key in ("SmoothRodOffset", "EffectorOffset", "CarriageOffset")
    ]
    radius = offsets[0].value - offsets[1].value - offsets[2].value
    key = "DiagnalRod" if transform.get("DiagnalRod") else "DiagonalRod"
    rod = job.stored.needed(transform, key, "DeltaDiagonalRod")
    words = [f"DiagonalRodCorr{i}" for i in (1, 2, 3)]
    more = [job.stored.number(transform, word, f"Delta{word}") for word in words]
    rods = [rod.value + (one.value if one else 0.0) for one in more]
    put(("geometry", "radius"), radius, offsets[0].place)
    put(("geometry", "rods"), [*rods], rod.place)
    job.rows("delta", transform, "Delta")
    _put_virtual_axes(job, transform, steppers, "XYZ")
    tops: list[float] = []
    for tower, stepper, length in zip("abc", steppers, rods, strict=True):
        job.rows("tower", stepper, stepper.text("Name"), name=tower)
        if length <= radius:
            raise bad(rod.place, "DiagonalRod", f"{length:g}", f"more than {radius:g}")
        if _put_homing(job, tower, stepper):
            tops.append(job.draft.number(("homing", tower, "position")) - rise_mm(length, radius))
    for axis in "xy":
        put(("axes", axis, "home_mm"), 0.0, None)
    if tops:
        top = min(min(tops), job.draft.number(("axes", "z", "max_mm")))
        put(("axes", "z", "home_mm"), round(top, 6), None)
    reach = job.draft.number(("geometry", "limit_radius"))
    put(("bed", "round"), True, None)
    put(("bed", "size_mm"), [2 * reach, 2 * reach], job.draft.keys["geometry", "limit_radius"][1])
    put(("bed", "center_mm"), [0.0, 0.0], None)
    return steppers


def _put_axis(job: Job, name: str, stepper: Node, identity: Node | None) -> None:
    """Converts an axis with its own motor, or an extruder. As in APrinter, an extruder that is not
    named E becomes a further axis that moves filament."""
    letter = stepper.text("Name")
    job.motors[letter] = name
    extruder = stepper.flag("IsExtruder")
    if extruder and name == "e":
        job.rows("extruder", stepper, letter, name=name)
        return
    if extruder:
        job.draft.put(("axes", name, "extruder"), True, stepper.within("IsExtruder").place)
    else:
        job.rows("travel", stepper, letter, name=name)
        job.rows("travel", identity and identity.get("Limits"), letter, name=name)
    job.rows("axis", stepper, letter, name=name)
    if not extruder:
        _put_homing(job, name, stepper)


def _put_motors(job: Job, stepper: Node) -> None:
    letter = stepper.text("Name")
    delay = stepper.get("delay")
    for number, slave in enumerate(stepper.each("slave_steppers")):
        name = f"{job.motors[letter]}{number or ''}"
        job.rows("arm_steps" if letter in job.arms else "steps", stepper, letter, name=name)
        port = slave.within("stepper_port")
        for key, value in job.pins.motor(port).items():
            job.draft.put(("steppers", name, key), value, port.place)
        job.rows("slave", slave, f"{letter}S{number}" if number else letter, name=name)
        micro = job.stored.number(slave, "MicroSteps")
        if micro is not None and micro.value > 0:
            job.draft.put(("steppers", name, "microsteps"), micro.whole(1, 256), micro.place)
        if delay is not None and delay.kind == "Delay":
            job.rows("delay", delay, None, name=name)


def _put_homing(job: Job, name: str, limits: Node) -> bool:
    """Converts the homing of an axis or a stepper, if it has one. Its end is the limit plus the
    offset; a virtual axis has no offset."""
    homing, letter = limits.get("homing"), limits.text("Name")
    if homing is None or homing.kind != "homing":
        return False
    path, stored = ("homing", name), job.stored
    upward = stored.flag(homing, "HomeDir", f"{letter}HomeDir")
    word = "MaxPos" if upward else "MinPos"
    end = stored.needed(limits, word, f"{letter}{word}")
    offset = stored.number(homing, "HomeOffset", f"{letter}HomeOffset")
    place = homing.within("HomeEndstopInput")
    inverted = stored.flag(homing, "HomeEndInvert", f"{letter}HomeEndInvert")
    job.draft.put((*path, "direction"), "max" if upward else "min", homing.place)
    position = end.value + (offset.value if offset else 0.0)
    job.draft.put((*path, "position"), position, end.place)
    job.draft.put((*path, "pin"), job.pins.switch(place, inverted), place.place)
    job.rows("homing", homing, letter, name=name)
    default = homing.get("ByDefault")
    if default is not None and not stored.flag(homing, "ByDefault", f"{letter}HomeByDefault"):
        job.draft.put((*path, "by_default"), False, default.place)
    return True


def _put_probe(job: Job) -> None:
    """Converts the probe. APrinter adds the offset of the probe to a point and the general Z offset
    to a height; Passo subtracts the offset and the trigger height."""
    probe, stored = job.config.get("probe_config", "probe"), job.stored
    if probe is None or probe.kind != "Probe":
        return
    path, put = ("probe",), job.draft.put
    pin = probe.within("ProbePin")
    put((*path, "kind"), "fixed", probe.place)
    inverted = stored.flag(probe, "InvertInput", "ProbeInvert")
    put((*path, "pin"), job.pins.switch(pin, inverted), pin.place)
    offset = [stored.needed(probe, f"Offset{axis}", f"ProbeOffset{axis}") for axis in "XY"]
    put((*path, "offset_mm"), [-one.value for one in offset], offset[0].place)
    height = stored.needed(probe, "GeneralZOffset", "ProbeGeneralZOffset")
    job.put((*path, "trigger_height_mm"), height, -1.0)
    job.rows("probe", probe, "Probe")
    points: list[Any] = []
    for number, node in enumerate(probe.each("ProbePoints"), 1):
        at = [stored.needed(node, axis, f"ProbeP{number}{axis}") for axis in "XY"]
        point: dict[str, Any] = {"x": at[0].value, "y": at[1].value}
        more = stored.number(node, "Z-offset", f"ProbeP{number}ZOffset")
        if more is not None and more.value:
            point["offset"] = more.value
        if not stored.flag(node, "Enabled", f"ProbeP{number}Enabled"):
            point["enabled"] = False
        points.append(point)
    correction = probe.get("correction")
    method = "none"
    if correction is not None and correction.kind == "Correction":
        quadratic = stored.flag(correction, "QuadraticCorrectionEnabled", "ProbeQuadrCorrEnabled")
        method = "quadratic" if quadratic else "linear"
    put(("levelling", "method"), method, correction.place if correction else probe.place)
    put(("levelling", "points"), points, probe.within("ProbePoints").place)


def _put_cold(job: Job) -> None:
    """Sets the heater of each further axis that moves filament."""
    for heater in job.config.each("heaters"):
        for axis in heater.each("cold_extrusion_prevention", "ExtruderAxes"):
            name = job.motors.get(str(axis.scalar), "")
            if ("axes", name, "extruder") in job.draft.keys:
                job.draft.put(("axes", name, "heater"), heater_name(heater), axis.place)


def _put_moves(job: Job) -> None:
    for number, move in enumerate(job.config.each("Moves", "Moves"), 1):
        path, hook = ("moves", f"move-{number}"), _HOOKS.get(move.text("HookType"))
        at = {
            coordinate.text("AxisName").lower(): value.value
            for coordinate in move.each("Coordinates")
            if (
                value := job.stored.number(
                    coordinate, "Value", f"Move{number}{coordinate.text('AxisName')}"
                )
            )
        }
        if not at:
            continue
        job.draft.put((*path, "position_mm"), {**at}, move.place)
        job.rows("move", move, f"Move{number}", name=path[1])
        job.draft.put((*path, "hook"), hook, move.place)
        job.rows("hook", move, None, name=path[1])
        if not job.stored.flag(move, "Enabled", f"Move{number}Enabled"):
            job.draft.put((*path, "enabled"), False, move.place)
