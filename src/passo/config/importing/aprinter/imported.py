"""Converts a document of APrinter's configuration editor to a draft of a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.aprinter.arms import ARMS, put_arms, put_home
from passo.config.importing.aprinter.boards import Pins
from passo.config.importing.aprinter.conversion import Job
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
from passo.errors import ConfigError
from passo.geometry.delta import rise_mm

if TYPE_CHECKING:
    from pathlib import Path

    from passo.config.importing.draft import KeyPath

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
_TOWERS = ("a", "b", "c")


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
    put_heat(config, job.pins, options, draft)
    _put_cold(job)
    _put_moves(job)
    if config.each("lasers"):
        draft.decide(config.within("lasers").place, "lasers", "give [laser] by hand")
    job.put_number(("idle", "motors_off_s"), config, "InactiveTime", "InactiveTime")
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
            homing = arm.get("homing")
            if homing is not None and homing.kind == "homing":
                letter = arm.text("Name")
                _put_homing(job, job.motors[letter], letter, homing, arm)
        put_home(job, transform)
    else:
        for index, motor in enumerate("ab" if kind == "CoreXY" else ""):
            written = transform.get("Steppers", f"TransformStepper{index}", "StepperName")
            taken.append(job.stepper(written))
            job.motors[taken[-1].text("Name")] = motor
        if kind == "CoreXY":
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
        name = node.text("Name")
        path = ("axes", name.lower())
        job.put_axis_limits(path, node)
        job.put((*path, "accel_mm_s2"), accel)
        homing = node.get("homing")
        if homing is not None and homing.kind == "homing" and transform.kind == "CoreXY":
            _put_homing(job, name.lower(), name, homing, node)


def _put_delta(job: Job, transform: Node) -> list[Node]:
    names = [transform.get("Steppers", f"TransformStepper{i}", "StepperName") for i in range(3)]
    steppers = [job.stepper(name) for name in names]
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
    put = job.draft.put
    put(("geometry", "radius"), radius, offsets[0].place)
    put(("geometry", "rods"), [*rods], rod.place)
    limit = job.stored.needed(transform, "LimitRadius", "DeltaLimitRadius")
    job.put(("geometry", "limit_radius"), limit)
    _put_virtual_axes(job, transform, steppers, "XYZ")
    tops: list[float] = []
    for tower, stepper, length in zip(_TOWERS, steppers, rods, strict=True):
        name = stepper.text("Name")
        job.motors[name] = tower
        path = ("steppers", tower)
        for key, word in (
            ("min_mm", "MinPos"),
            ("max_mm", "MaxPos"),
            ("speed_mm_s", "MaxSpeed"),
            ("accel_mm_s2", "MaxAccel"),
        ):
            job.put_number((*path, key), stepper, word, f"{name}{word}")
        if length <= radius:
            raise bad(rod.place, "DiagonalRod", f"{length:g}", f"more than {radius:g}")
        homing = stepper.get("homing")
        if homing is not None and homing.kind == "homing":
            _put_homing(job, tower, name, homing, stepper)
            end = job.draft.number(("homing", tower, "position"))
            tops.append(end - rise_mm(length, radius))
    for axis in "xy":
        put(("axes", axis, "home_mm"), 0.0, None)
    if tops:
        top = min(min(tops), job.draft.number(("axes", "z", "max_mm")))
        put(("axes", "z", "home_mm"), round(top, 6), None)
    put(("bed", "round"), True, None)
    put(("bed", "size_mm"), [2 * limit.value, 2 * limit.value], limit.place)
    put(("bed", "center_mm"), [0.0, 0.0], None)
    return steppers


def _put_axis(job: Job, name: str, stepper: Node, identity: Node | None) -> None:
    """Converts an axis with its own motor, or an extruder. As in APrinter, an extruder that is not
    named E becomes a further axis that moves filament."""
    letter = stepper.text("Name")
    job.motors[letter] = name
    extruder = stepper.flag("IsExtruder")
    path: KeyPath = ("extruders" if extruder and name == "e" else "axes", name)
    if extruder and name != "e":
        job.draft.put((*path, "extruder"), True, stepper.within("IsExtruder").place)
    if not extruder:
        for key, word in (("min_mm", "MinPos"), ("max_mm", "MaxPos")):
            limits = identity.get("Limits") if identity else None
            node = limits if limits and limits.get(word) else stepper
            job.put_number((*path, key), node, word, f"{letter}{word}")
    for key, word in (("speed_mm_s", "MaxSpeed"), ("accel_mm_s2", "MaxAccel")):
        job.put((*path, key), job.stored.needed(stepper, word, f"{letter}{word}"))
    if path[0] == "axes":
        corner = job.stored.number(stepper, "CorneringDistance", f"{letter}CorneringDistance")
        job.put((*path, "cornering_distance_steps"), corner)
    homing = stepper.get("homing")
    if homing is not None and homing.kind == "homing" and not extruder:
        _put_homing(job, name, letter, homing, stepper)


def _put_motors(job: Job, stepper: Node) -> None:
    letter = stepper.text("Name")
    name = job.motors[letter]
    for number, slave in enumerate(stepper.each("slave_steppers")):
        path = ("steppers", f"{name}{number}" if number else name)
        steps = job.stored.needed(stepper, "StepsPerUnit", f"{letter}StepsPerUnit")
        turns = letter in job.arms
        job.put((*path, "steps_per_degree" if turns else "steps_per_mm"), steps)
        port = slave.within("stepper_port")
        for key, value in job.pins.motor(port).items():
            job.draft.put((*path, key), value, port.place)
        prefix = f"{letter}S{number}" if number else letter
        if job.stored.flag(slave, "InvertDir", f"{prefix}InvertDir"):
            job.draft.put((*path, "invert"), True, slave.within("InvertDir").place)
        current = job.stored.number(slave, "Current", f"{prefix}Current")
        if current is not None and current.value > 0:
            job.put((*path, "peak_current_a"), current, 1e-3)
        micro = job.stored.number(slave, "MicroSteps")
        if micro is not None and micro.value > 0:
            job.draft.put((*path, "microsteps"), micro.whole(1, 256), micro.place)
        delay = stepper.get("delay")
        if delay is not None and delay.kind == "Delay":
            job.put_number((*path, "pulse_us"), delay, "StepHighTime")
            job.put_number((*path, "direction_setup_us"), delay, "DirSetTime")


def _put_homing(job: Job, name: str, letter: str, homing: Node, limits: Node) -> None:
    """Converts the homing of an axis. Its end is the limit plus the offset; a virtual axis has no
    offset."""
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
    for key, word in (
        ("fast", "HomeFastSpeed"),
        ("retract", "HomeRetractDist"),
        ("slow", "HomeSlowSpeed"),
        ("max_travel", "HomeFastMaxDist"),
    ):
        job.put_number((*path, key), homing, word, f"{letter}{word}")
    default = homing.get("ByDefault")
    if default is not None and not stored.flag(homing, "ByDefault", f"{letter}HomeByDefault"):
        job.draft.put((*path, "by_default"), False, default.place)


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
    for key, word in (
        ("start_mm", "StartHeight"),
        ("low_mm", "LowHeight"),
        ("retract_mm", "RetractDist"),
        ("travel_mm_s", "MoveSpeed"),
        ("fast_mm_s", "FastSpeed"),
        ("lift_mm_s", "RetractSpeed"),
        ("slow_mm_s", "SlowSpeed"),
    ):
        job.put_number((*path, key), probe, word, f"Probe{word}")
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
        job.put_number((*path, "speed_mm_s"), move, "Speed", f"Move{number}Speed")
        job.draft.put((*path, "hook"), hook, move.place)
        priority = job.stored.number(move, "HookPriority")
        if priority is not None:
            job.draft.put((*path, "priority"), priority.whole(0, 1000), priority.place)
        if not job.stored.flag(move, "Enabled", f"Move{number}Enabled"):
            job.draft.put((*path, "enabled"), False, move.place)
