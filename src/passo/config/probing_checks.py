"""Checks of the probe and of levelling. They need a machine file without other errors."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import hypot

from passo.config.eddy_checks import check_calibration
from passo.config.findings import Finding, did_you_mean
from passo.config.machine import MachineConfig
from passo.config.pin_names import placed
from passo.config.probing import MIN_DISTANCE_MM, UNKNOWNS
from passo.probes.base import SensingProbe
from passo.probes.dock import DockProbe
from passo.probes.eddy import EddyProbe

_CLEARANCE_MM = 1.0  # minimum height of a descent's start above the trigger height
_MAX_DESCENT_S = 20.0


def check_probe(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the probe triggers within its descent: below its start and above its end."""
    if machine.simulated.delta is not None and machine.geometry.kind != "delta":
        limit = 'a geometry of the kind "delta"'
        yield Finding("config.conflict", ("simulated", "delta"), machine.geometry.kind, limit)
    probe = machine.probe
    homes = any(homing.probe for homing in machine.homing.values())
    if homes and not isinstance(probe, SensingProbe):
        limit = "false, or a table probe with a pin"
        yield Finding("config.conflict", ("homing", "z", "probe"), True, limit)
    if probe is None:
        if machine.levelling.method != "none":
            path = ("levelling", "method")
            limit = '"none", or a table probe'
            yield Finding("config.conflict", path, machine.levelling.method, limit)
        return
    if isinstance(probe, SensingProbe):
        yield from _check_sensor(machine, probe)
    yield from _check_points(machine)
    yield from _check_area(machine)
    yield from _check_motors(machine)
    yield from _check_screws(machine)


def _check_sensor(machine: MachineConfig, probe: SensingProbe) -> Iterator[Finding]:
    yield from _check_descent(probe)
    yield from _check_home(machine, probe)
    if isinstance(probe, EddyProbe):
        yield from check_calibration(probe)
    if probe.servo_pin and placed(probe.servo_pin)[0] != placed(probe.wired_at)[0]:
        limit = f"a pin on the board of pin, which is {probe.wired_at}"
        yield Finding("config.value", ("probe", "control_pin"), probe.servo_pin, limit)
    if isinstance(probe, DockProbe):
        yield from _check_dock(machine, probe)
    for axis, twist in probe.twist.items():
        if twist.from_mm == twist.to_mm:
            path = ("probe", "twist", axis, "to_mm")
            yield Finding("config.value", path, twist.to_mm, "another place than from_mm")
        if len(twist.heights_mm) == 1:
            path = ("probe", "twist", axis, "heights_mm")
            yield Finding("config.value", path, twist.heights_mm, "no height, or at least two")
    for index, name in enumerate(probe.heaters_off):
        if name not in machine.heaters:
            hint = did_you_mean(name, machine.heaters)
            path = ("probe", "heaters_off", index)
            yield Finding("config.value", path, name, "the name of one of the heaters", hint)


def _check_dock(machine: MachineConfig, probe: DockProbe) -> Iterator[Finding]:
    """Checks that the nozzle can reach the dock, at a sufficient height above the bed."""
    if probe.dock_height_mm < probe.start_mm:
        limit = f"at least start_mm, which is {probe.start_mm:g}"
        yield Finding("config.value", ("probe", "dock_height_mm"), probe.dock_height_mm, limit)
    x, y = machine.axes["x"], machine.axes["y"]
    for key in ("approach_mm", "dock_mm", "leave_mm"):
        at_x, at_y = place = getattr(probe, key)
        if not (x.min_mm <= at_x <= x.max_mm and y.min_mm <= at_y <= y.max_mm):
            limit = (
                f"within X{x.min_mm:g} to X{x.max_mm:g} and Y{y.min_mm:g} to Y{y.max_mm:g}, which"
                " the nozzle reaches"
            )
            yield Finding("config.value", ("probe", key), place, limit)


def _check_descent(probe: SensingProbe) -> Iterator[Finding]:
    least = probe.trigger_height_mm + _CLEARANCE_MM
    if probe.start_mm <= least:
        limit = f"more than {least:g}: 1 mm above the height at which the probe triggers"
        yield Finding("config.value", ("probe", "start_mm"), probe.start_mm, limit)
    if probe.low_mm >= probe.trigger_height_mm:
        limit = f"less than trigger_height_mm, which is {probe.trigger_height_mm:g}"
        yield Finding("config.value", ("probe", "low_mm"), probe.low_mm, limit)
    seconds = (probe.start_mm - probe.low_mm) / probe.fast_mm_s
    if seconds > _MAX_DESCENT_S:
        limit = f"a descent of at most {_MAX_DESCENT_S:g} s, and this takes {seconds:.0f} s"
        yield Finding("config.value", ("probe", "fast_mm_s"), probe.fast_mm_s, limit)


def _check_home(machine: MachineConfig, probe: SensingProbe) -> Iterator[Finding]:
    """Checks that the probe can reach the place where it homes Z, and that the home position is the
    trigger height."""
    homing = machine.homing.get("z")
    if homing is None or not homing.probe:
        return
    if homing.direction != "min":
        limit = '"min": the probe is above the bed'
        yield Finding("config.conflict", ("homing", "z", "direction"), homing.direction, limit)
    if homing.position != probe.trigger_height_mm:
        limit = f"no such key: it is probe.trigger_height_mm, which is {probe.trigger_height_mm:g}"
        yield Finding("config.conflict", ("homing", "z", "position"), homing.position, limit)
    x, y = machine.probe_home_mm
    yield from _check_place(machine, ("homing", "z", "probe_at_mm"), x, y)


def _check_points(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the points are different, on the bed, reachable, and sufficient for the
    method."""
    probe, levelling = machine.probe, machine.levelling
    assert probe is not None
    points = [(i, p) for i, p in enumerate(levelling.points) if p.enabled]
    needed = UNKNOWNS.get(levelling.method, 0)
    if len(points) < needed:
        limit = f"at least {needed} enabled points for the method {levelling.method}"
        yield Finding("config.value", ("levelling", "points"), len(points), limit)
    for (i, a), (j, b) in combinations(points, 2):
        apart = hypot(a.x - b.x, a.y - b.y)
        if apart < MIN_DISTANCE_MM:
            path = ("levelling", "points", j)
            limit = (
                f"a point at least {MIN_DISTANCE_MM:g} mm from point {i + 1}, and it is"
                f" {apart:g} mm from it"
            )
            yield Finding("config.value", path, f"X{b.x:g} Y{b.y:g}", limit)
    for i, point in points:
        yield from _check_place(machine, ("levelling", "points", i), point.x, point.y)


def _check_area(machine: MachineConfig) -> Iterator[Finding]:
    area = machine.levelling.area
    if area is None:
        if machine.levelling.method == "mesh":
            limit = "a rectangle for the method mesh"
            yield Finding("config.missing-key", ("levelling", "area"), None, limit)
        return
    x0, y0, x1, y1 = area
    if not (x0 < x1 and y0 < y1):
        limit = "X and Y of the first corner, then greater ones of the opposite corner"
        yield Finding("config.value", ("levelling", "area"), area, limit)
        return
    for x, y in ((x0, y0), (x1, y0), (x0, y1), (x1, y1)):
        for finding in _check_place(machine, ("levelling", "area"), x, y):
            yield finding
            return


def _check_place(
    machine: MachineConfig, path: tuple[str | int, ...], x: float, y: float
) -> Iterator[Finding]:
    """Checks that the probe is on the bed there, and the nozzle within its axes."""
    assert machine.probe is not None
    dx, dy = machine.probe.offset_mm
    x0, y0, x1, y1 = machine.bed_area_mm
    low = [max(a, machine.axes[n].min_mm + d) for a, n, d in ((x0, "x", dx), (y0, "y", dy))]
    high = [min(a, machine.axes[n].max_mm + d) for a, n, d in ((x1, "x", dx), (y1, "y", dy))]
    if not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
        limit = (
            f"within X{low[0]:g} to X{high[0]:g} and Y{low[1]:g} to Y{high[1]:g}, where the probe"
            " is on the bed and the nozzle within its axes"
        )
        yield Finding("config.value", path, f"X{x:g} Y{y:g}", limit)


def _check_motors(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that each Z motor has a pivot, and that the points fit the number of motors."""
    motors = machine.levelling.motors
    if motors is None:
        return
    z = machine.drivable.by_name.get("z")
    of_z = {name for name in machine.steppers if machine.driven_by(name) == z}
    if z is None or set(motors.pivots) != of_z:
        path = ("levelling", "motors", "pivots")
        limit = f"a pivot for each motor of Z: {', '.join(sorted(of_z)) or 'this machine has none'}"
        yield Finding("config.value", path, ", ".join(motors.pivots), limit)
    for (one, a), (other, b) in combinations(motors.pivots.items(), 2):
        if hypot(a[0] - b[0], a[1] - b[1]) < MIN_DISTANCE_MM:
            path = ("levelling", "motors", "pivots", other)
            limit = f"a place at least {MIN_DISTANCE_MM:g} mm from that of {one}"
            yield Finding("config.value", path, f"X{b[0]:g} Y{b[1]:g}", limit)
    if len(motors.pivots) == 4 and len(motors.points) != 4:
        path = ("levelling", "motors", "points")
        limit = "four points for four motors, in the order of the pivots"
        yield Finding("config.value", path, len(motors.points), limit)
    for i, point in enumerate(motors.points):
        yield from _check_place(machine, ("levelling", "motors", "points", i), point.x, point.y)


def _check_screws(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the probe can reach each screw, and that the names of screws differ."""
    screws = machine.levelling.screws
    if screws is None:
        return
    names = [screw.name for screw in screws.places]
    for i, screw in enumerate(screws.places):
        path = ("levelling", "screws", "places", i)
        if screw.name in names[:i]:
            yield Finding("config.value", (*path, "name"), screw.name, "a name of its own")
        yield from _check_place(machine, path, screw.x, screw.y)
