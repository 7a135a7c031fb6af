"""G33, DELTA_CALIBRATE, DELTA_ANALYZE, M665 and M666: measure and set the geometry of a delta."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import cos, hypot, radians, sin
from statistics import fmean
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, ignored, integer, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.geometry.base import Point, Unreachable
from passo.geometry.delta import Delta, rise_mm
from passo.levelling.delta_calibration import (
    Calibration,
    ChangeLimits,
    DeltaMachine,
    Distance,
    Factors,
    calibrate,
    printed_distances,
)
from passo.motion.probing import Measured, Place, Prober
from passo.printer.commands.manual_probe import METHODS, ManualProbe, by_hand
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.rig import Rig

NO_DELTA = "This machine is not a delta with an endstop on each tower."
NO_PROBE = "This machine is not a delta with a probe."
_TOWERS = "ABC"
_ANGLES = (210.0, 330.0, 90.0)  # the angles of the towers from which M665 counts
# fractions of the radius for 7 points, as in Klipper
_INNER_SHARES = (0.95, 0.90, 0.85, 0.70, 0.75, 0.80)
# distance of nozzle and probe from the edge, because the geometry is not exact yet
_MARGIN_MM = 2.0
# the measurements of DELTA_ANALYZE, and how many each has
_MEASURED = {
    "CENTER_DISTS": 6,
    "CENTER_PILLAR_WIDTHS": 3,
    "OUTER_DISTS": 6,
    "OUTER_PILLAR_WIDTHS": 6,
}
_LOWEST_MM = 10.0  # of the paper test, because the geometry is not exact yet
_DIGITS = 6  # decimals of mm and degrees, so that stored and active values are equal


def is_calibrated(machine: MachineConfig) -> bool:
    """Whether the machine is a delta with an endstop for each carriage, which can be calibrated."""
    return isinstance(machine.geometry, Delta) and set("abc") <= set(machine.homing)


class DeltaCommands:
    """The commands for the geometry of one delta, for which `is_calibrated` is True. The active
    geometry is that of the rig."""

    def __init__(
        self, rig: Rig, prober: Prober, correction: BedCorrection, manual: ManualProbe
    ) -> None:
        self._rig, self._prober, self._correction, self._manual = rig, prober, correction, manual
        self._config = rig.machine.levelling
        self._printed: dict[str, list[float]] = {}  # the values given to DELTA_ANALYZE
        # The drops of the carriages, and the height of the nozzle there, mm: of the last paper
        # test, where the height is 0, and of MANUAL_HEIGHT.
        self._touched: list[tuple[Point, float]] = []
        self._heights: list[tuple[Point, float]] = []

    @property
    def _now(self) -> DeltaMachine:
        machine = self._rig.machine
        assert isinstance(machine.geometry, Delta)
        a, b, c = (machine.homing[name].position for name in "abc")
        return DeltaMachine(machine.geometry, (a, b, c))

    def _use(self, delta: DeltaMachine) -> None:
        """Activates geometry and endstops, rounded to `_DIGITS`. Raises CommandError if the rods
        are too short, or if the nozzle would be outside its limits."""
        geometry = delta.geometry
        _check_rods(geometry)
        if self._rig.job.stops.suspended:
            raise CommandError.of("command.aside", value="This command")
        rounded = geometry.model_copy(
            update={
                "radius": round(geometry.radius, _DIGITS),
                "angles": [round(angle, _DIGITS) for angle in geometry.angles],
                "rods": [round(rod, _DIGITS) for rod in geometry.rods],
            }
        )
        machine = self._rig.machine
        homing = {
            name: machine.homing[name].model_copy(update={"position": round(at, _DIGITS)})
            for name, at in zip("abc", delta.endstops, strict=True)
        }
        update = {"geometry": rounded, "homing": machine.homing | homing}
        try:
            self._rig.use_geometry(machine.model_copy(update=update))
        except Unreachable as error:
            raise CommandError.of("levelling.delta-nowhere", value=error) from None

    # -- calibration ------------------------------------------------------------------------------

    @command(
        "G33",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Calibrates a delta: probes 7 points (19 from P4 on) within the radius R, and finds radius,"
        " angles of the towers and endstops; F7 also a common length of the rods, which heights"
        " hardly determine. A result that does not make the bed flatter is dropped.",
        number("P", "7 points, 19 from 4 on", low=3, high=10, default=3),
        number("R", "the radius of the points", "mm", 0, above=True),
        integer("F", "7: also the length of the rods", 6, 7, default=6),
        ignored("V T E C"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _auto_calibrate(self, command: Command, reply: Reply) -> Wait | None:
        many, rods = command.value("P") >= 4, command.integer("F") == 7
        return self._calibration(reply, command.value("R", None), many=many, rods=rods)

    @command(
        "DELTA_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Calibrates a delta with 7 points, as G33. METHOD=manual, or a delta without a probe,"
        " measures them by the paper test.",
        choice("METHOD", "manual: by the paper test", *METHODS),
        kind=Kind.PROBED,
        lacks=NO_DELTA,
    )
    def _calibrate(self, command: Command, reply: Reply) -> Wait | None:
        if self._by_hand(command):
            return self._paper_test(6, reply)
        return self._calibration(reply, None, many=False, rods=False)

    def _by_hand(self, command: Command) -> bool:
        """Whether the points are measured by the paper test."""
        return by_hand(command) or not isinstance(self._prober.carried, SensingProbe)

    @command(
        "DELTA_ANALYZE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Takes the lengths that were measured on Klipper's calibration part, with commas, in one"
        " command or several. The part was printed with the geometry in force. CALIBRATE=extended"
        " then probes 7 points as G33, and finds the lengths of the rods, too. Without a probe, it"
        " uses the points of the last DELTA_CALIBRATE; METHOD=manual measures them by the paper"
        " test. MANUAL_HEIGHT is the true height of the nozzle where it is, as one more point.",
        text("CENTER_DISTS", "6 lengths in mm, with commas"),
        text("CENTER_PILLAR_WIDTHS", "3 lengths in mm"),
        text("OUTER_DISTS", "6 lengths in mm"),
        text("OUTER_PILLAR_WIDTHS", "6 lengths in mm"),
        number("SCALE", "the factor of the printed part", low=0.1, high=10, default=1),
        choice("CALIBRATE", "calculates", "extended"),
        choice("METHOD", "manual: by the paper test", *METHODS),
        number("MANUAL_HEIGHT", "the true height of the nozzle where it is", "mm", -10, 10),
        kind=Kind.PROBED,
        lacks=NO_DELTA,
    )
    def _analyze(self, command: Command, reply: Reply) -> Wait | None:
        if (height := command.value("MANUAL_HEIGHT", None)) is not None:
            return WaitForMoves(lambda: self._add_height(height, reply))
        for key, count in _MEASURED.items():
            if command.has(key):
                self._printed[key] = _list(key, command.string(key), count)
        missing = [key for key in _MEASURED if key not in self._printed]
        if not command.has("CALIBRATE"):
            reply.say(f"// Still to measure: {', '.join(missing) or 'nothing; CALIBRATE=extended'}")
            return None
        if missing:
            raise CommandError.of("input.missing-word", axis="the command", value=missing[0])
        center, center_widths, outer, outer_widths = (self._printed[key] for key in _MEASURED)
        try:
            distances = printed_distances(
                *(self._now, center, center_widths, outer, outer_widths, command.value("SCALE"))
            )
        except Unreachable as error:
            raise CommandError.of("levelling.delta-nowhere", value=error) from None
        if not self._by_hand(command):
            return WaitForProcedure(partial(self._find, self._seven(), 9, reply, distances))
        if command.has("METHOD") or not self._touched:
            return self._paper_test(9, reply, distances)
        return WaitForMoves(lambda: self._fit(9, reply, distances))

    def _add_height(self, height_mm: float, reply: Reply) -> None:
        """Adds the position of the nozzle, whose height above the bed is known."""
        for axis in self._rig.job.locked_axes:
            raise CommandError.of("input.not-homed", axis="XYZ"[min(axis, 2)])
        with self._correction.suspended():
            x, y = self._prober.nozzle_xy_mm
            z = self._prober.z_mm
        self._heights.append((self._now.drops((x, y, z)), height_mm))
        reply.say(f"// Manual height: X{x:.3f} Y{y:.3f} Z{z:.3f} is {height_mm:.3f} mm high")

    def _seven(self) -> list[Place]:
        return list(_spread(self._config.delta.radius_mm or self._reach_mm(), many=False))

    def _paper_test(
        self, factors: Factors, reply: Reply, distances: Sequence[Distance] = ()
    ) -> Wait:
        """Measures 7 points by the paper test, and calibrates with them. Raises CommandError."""
        places = [replace(place, by_nozzle=True) for place in self._seven()]

        def done(found: Sequence[Measured], reply: Reply) -> None:
            delta = self._now
            self._touched = [
                (delta.drops((m.place.x, m.place.y, m.trigger_z_mm)), 0.0) for m in found
            ]
            self._fit(factors, reply, distances)

        return self._manual.start(places, done, reply=reply, lowest_mm=_LOWEST_MM)

    def _fit(self, factors: Factors, reply: Reply, distances: Sequence[Distance]) -> None:
        """Calibrates with what was measured by hand. The geometry stays if the result is not better
        or changes too much: raises CommandError."""
        found = calibrate(self._now, [*self._touched, *self._heights], factors, distances)
        found.check(self._limits)
        on = self._correction.on
        self._use(found.after)
        self._correction.use(self._correction.correction, on=False)
        count = len(self._touched) + len(self._heights)
        self._tell(_report(found, None, factors, count, len(distances)), reply, corrected=on)

    def _calibration(
        self, reply: Reply, radius_mm: float | None, *, many: bool, rods: bool
    ) -> Wait:
        if radius_mm is None:
            radius_mm = self._config.delta.radius_mm or self._reach_mm()
        elif radius_mm > self._reach_mm():
            raise CommandError.bad_value("R", radius_mm, f"more than 0, at most {self._reach_mm()}")
        places = list(_spread(radius_mm, many=many))
        return WaitForProcedure(partial(self._find, places, 7 if rods else 6, reply))

    def _reach_mm(self) -> float:
        """The distance from the middle, mm, that both nozzle and probe can reach."""
        geometry = self._now.geometry
        x0, y0, x1, y1 = self._rig.machine.bed_area_mm
        nozzle = geometry.limit_radius - hypot(*self._prober.offset_mm)
        return round(min(nozzle, -x0, -y0, x1, y1) - _MARGIN_MM, 1)

    async def _find(
        self,
        places: Sequence[Place],
        factors: Factors,
        reply: Reply,
        distances: Sequence[Distance] = (),
    ) -> None:
        before, on = self._now, self._correction.on
        found = calibrate(before, await self._touch(places), factors, distances)
        found.check(self._limits)
        self._use(found.after)
        try:
            self._correction.use(self._correction.correction, on=False)
            left = calibrate(self._now, await self._touch(places), factors, distances).rms_before
            if left > found.rms_before:
                limit = found.rms_before
                raise CommandError.of("levelling.delta-worse", value=left, limit=limit)
        except BaseException:
            self._use(before)
            self._correction.use(self._correction.correction, on=on)
            raise
        lines = _report(found, left, factors, len(places), len(distances))
        self._tell(lines, reply, corrected=on)

    @property
    def _limits(self) -> ChangeLimits:
        limits = self._config.delta
        return ChangeLimits(
            limits.max_radius_mm, limits.max_angle_deg, limits.max_endstop_mm, limits.max_rod_mm
        )

    def _tell(self, lines: Iterable[str], reply: Reply, *, corrected: bool) -> None:
        for line in lines:
            reply.say(line)
        if corrected:
            reply.say("The correction of the bed is off: measure it again (G29 or G32)")

    async def _touch(self, places: Sequence[Place]) -> list[tuple[Point, float]]:
        """Measures places: the drops of the carriages when the probe triggers, and the Z of the
        nozzle there, mm."""
        delta, trigger_mm = self._now, self._prober.trigger_height_mm
        return [
            (delta.drops((*self._prober.nozzle_at(m.place), m.trigger_z_mm)), trigger_mm)
            for m in await self._prober.measure(places)
        ]

    # -- settings ---------------------------------------------------------------------------------

    @command(
        "M665",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the geometry of a delta: the length L of the rods, to which A, B and C add for one"
        " each, the radius R, the height H of the nozzle at home in the middle, and what X, Y and Z"
        " add to 210, 330 and 90 degrees. Without parameters it reports them.",
        number("L", "the length of the rods", "mm", 1, 1e4),
        number("R", "the radius", "mm", 1, 1e4),
        number("H", "the height of the nozzle at home", "mm", 0, 1e4),
        number("A B C", "what one rod is longer than L", "mm"),
        number("X Y Z", "what a tower stands off its angle", "degrees"),
        ignored("S D E"),
        kind=Kind.PROBED,
        lacks=NO_DELTA,
    )
    def _set_geometry(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words.keys() & set("LRHXYZABC"):
            reply.say(f"  {self._geometry_line()}")
            return None
        if words.keys() & set(_TOWERS) and "L" not in words:
            raise CommandError.of("input.missing-word", axis="the command", value="L")
        return WaitForMoves(lambda: self._change(words))

    def _geometry_line(self) -> str:
        delta = self._now
        geometry = delta.geometry
        base, *_ = geometry.rods
        words = {"L": base, "R": geometry.radius, "H": self._height(_heights(delta))}
        words |= {k: a - at for k, a, at in zip("XYZ", geometry.angles, _ANGLES, strict=True)}
        words |= {k: rod - base for k, rod in zip(_TOWERS, geometry.rods, strict=True)}
        return "M665 " + " ".join(f"{k}{round(mm, 4) + 0.0:.4f}" for k, mm in words.items())

    def _change(self, words: dict[str, float]) -> None:
        delta = self._now
        geometry, heights = delta.geometry, _heights(delta)
        angles, rods = list(geometry.angles), list(geometry.rods)
        for i, (letter, tower) in enumerate(zip("XYZ", _TOWERS, strict=True)):
            if letter in words:
                angles[i] = _ANGLES[i] + words[letter]
            if "L" in words:
                rods[i] = _within("L", words["L"] + words.get(tower, 0.0), 1, 1e4)
        radius = words.get("R", geometry.radius)
        if "H" in words:
            rise = words["H"] - self._height(heights)
            heights = [e + rise for e in heights]
        update = {"radius": radius, "angles": angles, "rods": rods}
        self._use(_with_heights(geometry.model_copy(update=update), heights))

    def endstop_line(self) -> str:
        """M666 with the current values, and a comment that names the firmware whose signs they
        use."""
        shown = zip("XYZ", self._offsets(), strict=True)
        words = " ".join(f"{k}{round(mm, 4) + 0.0:.4f}" for k, mm in shown)
        return f"M666 {words} ; {'Marlin' if self._marlin else 'RepRapFirmware'}'s signs"

    @property
    def _marlin(self) -> bool:
        return self._config.dialect == "marlin"

    def _height(self, heights: Sequence[float]) -> float:
        """H of M665: the height of the lowest endstop (Marlin), or the mean height, mm."""
        return min(heights) if self._marlin else fmean(heights)

    def _offsets(self) -> list[float]:
        heights = _heights(self._now)
        height = self._height(heights)
        return [height - e if self._marlin else e - height for e in heights]

    def move_endstops(self, words: dict[str, float]) -> None:
        """Executes M666 with these words. Raises CommandError."""
        heights = _heights(self._now)
        height = self._height(heights)
        offsets = self._offsets()
        for i, letter in enumerate("XYZ"):
            if letter in words:
                most = 0.0 if self._marlin else 50.0
                offsets[i] = _within(letter, words[letter], -50, most)
        sign = -1 if self._marlin else 1
        moved = [height + sign * mm for mm in offsets]
        self._use(_with_heights(self._now.geometry, moved))

    @command(
        "SET_DELTA",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the geometry of a delta as the machine file has it and M500 stores it. ENDSTOP is the"
        " position of a carriage at its endstop.",
        number("RADIUS", "the radius", "mm", 1, 1e4),
        number("ROD_A ROD_B ROD_C", "the length of a rod", "mm", 1, 1e4),
        number(
            "ENDSTOP_A ENDSTOP_B ENDSTOP_C",
            "the position of a carriage at its endstop",
            "mm",
            -1e4,
            1e4,
        ),
        number("ANGLE_A ANGLE_B ANGLE_C", "the angle of a tower", "degrees", -360, 360),
        kind=Kind.PROBED,
        lacks=NO_DELTA,
    )
    def _set_delta(self, command: Command, _: Reply) -> Wait | None:
        delta = self._now
        geometry = delta.geometry

        def three(name: str, before: Sequence[float]) -> list[float]:
            keys = [f"{name}_{tower}" for tower in _TOWERS]
            return [command.value(k, value) for k, value in zip(keys, before, strict=True)]

        update = {
            "radius": command.value("RADIUS", geometry.radius),
            "angles": three("ANGLE", geometry.angles),
            "rods": three("ROD", geometry.rods),
        }
        a, b, c = three("ENDSTOP", delta.endstops)
        new = DeltaMachine(geometry.model_copy(update=update), (a, b, c))
        return WaitForMoves(lambda: self._use(new))

    def setting_lines(self) -> Iterator[str]:
        """Commands that restore the geometry exactly."""
        delta = self._now
        geometry = delta.geometry
        words = {"RADIUS": geometry.radius}
        for name, values in (
            ("ANGLE", geometry.angles),
            ("ROD", geometry.rods),
            ("ENDSTOP", delta.endstops),
        ):
            words |= {f"{name}_{tower}": v for tower, v in zip(_TOWERS, values, strict=True)}
        yield "SET_DELTA " + " ".join(f"{k}={round(v, _DIGITS)!r}" for k, v in words.items())


def _spread(radius_mm: float, *, many: bool) -> Iterator[Place]:
    """The middle and six points around it, or 19 in three rings."""
    if many:
        rings = [((0.75,) * 6, 60), ((1.0,) * 6, 90), ((0.5,) * 6, 90)]
    else:
        rings = [(_INNER_SHARES, 90)]
    yield Place(0.0, 0.0, "point 1")
    n = 1
    for shares, start in rings:
        for i, share in enumerate(shares):
            n += 1
            angle, mm = radians(start + 60 * i), share * radius_mm
            yield Place(round(mm * cos(angle), 3), round(mm * sin(angle), 3), f"point {n}")


def _report(
    found: Calibration, left_mm: float | None, factors: int, points: int, distances: int
) -> Iterator[str]:
    """The lines of a result; `left_mm` is the deviation that was measured again, if it was."""
    for name, old, new in found.changes():
        unit = "degrees" if name.startswith("angle") else "mm"
        if round(old, 4) != round(new, 4):
            yield f"{name}: {old:.4f} -> {new:.4f} {unit}"
    by = f"{points} points and {distances} distances" if distances else f"{points} points"
    what = "these lengths and a flat bed" if distances else "a flat bed"
    again = f"calculated again by {found.rms_after:.4f} mm"
    if left_mm is not None:
        again = f"measured again by {left_mm:.4f} mm"
    yield (
        f"Calibrated {factors} factors using {by}: they deviated from {what} by"
        f" {found.rms_before:.4f} mm rms, and {again}"
    )
    yield "M500 stores this geometry; M501 or M502 takes it back"


def _heights(delta: DeltaMachine) -> list[float]:
    """For each tower, the height of the nozzle in the middle, mm, if all carriages were as high as
    this tower's endstop."""
    geometry = delta.geometry
    return [
        q - rise_mm(rod, geometry.radius)
        for q, rod in zip(delta.endstops, geometry.rods, strict=True)
    ]


def _with_heights(geometry: Delta, heights: Sequence[float]) -> DeltaMachine:
    """The inverse of `_heights`. Raises CommandError if a rod is too short."""
    _check_rods(geometry)
    a, b, c = (
        e + rise_mm(rod, geometry.radius) for e, rod in zip(heights, geometry.rods, strict=True)
    )
    return DeltaMachine(geometry, (a, b, c))


def _check_rods(geometry: Delta) -> None:
    if min(geometry.rods) <= geometry.radius:
        raise CommandError.of(
            "command.value",
            axis="the shortest rod",
            value=f"{min(geometry.rods):g} mm",
            limit=f"more than the radius of {geometry.radius:g} mm",
        )


def _list(name: str, text: str, count: int) -> list[float]:
    """Positive numbers between commas. Raises CommandError."""
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != count or not all(0 < mm < 1e4 for mm in found):
        limit = f"{count} lengths in mm with commas between them"
        raise CommandError.of("command.value", axis=name, value=text, limit=limit)
    return found


def _within(name: str, value: float, low: float, high: float) -> float:
    """Raises CommandError unless `value` is between `low` and `high`."""
    if not low <= value <= high:
        raise CommandError.bad_value(name, value, f"{low:g} to {high:g}")
    return value
