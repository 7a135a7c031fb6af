"""G32, G29 and the other commands that measure the bed to correct it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from statistics import fmean, pstdev
from typing import TYPE_CHECKING

from passo.config.probing import ProbePoint
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import anything, choice, flag, ignored, integer, number, rest, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.levelling.areas import Area, Grid, check_avoided, places_around
from passo.levelling.correction import Correction
from passo.levelling.fits import check_points, fit
from passo.levelling.mesh import Interpolation
from passo.levelling.replies import bilinear_grid
from passo.motion.probing import Measured, Place, Prober
from passo.printer.commands.bed_correction import DEFAULT, TERMS, BedCorrectionCommands, exact
from passo.printer.commands.manual_probe import METHODS, ManualProbe, by_hand
from passo.printer.commands.mesh_words import ALGORITHMS, given_grid, given_interpolation
from passo.printer.commands.probe_offsets import ProbeOffsetCommands
from passo.printer.commands.probing import NO_PROBE, scan_of
from passo.printer.status import BedPoint, BedStatus, BedSurface
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.predefined_moves import PredefinedMoves
    from passo.motion.rig import Rig

_SURFACE_POINTS = 21  # points along X and along Y of the surface on the web page
_SPAN = re.compile(r"([XY])\s*(-?[\d.]+)\s*:\s*(-?[\d.]+)", re.ASCII)
_PAIR = re.compile(r"([SP])\s*([\d.]+)(?:\s*:\s*([\d.]+))?", re.ASCII)

Done = Callable[[Sequence[Measured], Reply], None]
_ShownPoints = tuple[tuple[BedPoint, ...], float | None, float | None]


class LevellingCommands:
    """Bed levelling of one printer. `points` and `mesh_grid` come from the machine file, or from
    commands. `printed_area` gives the area that the print covers, mm, if it is known."""

    def __init__(
        self,
        rig: Rig,
        prober: Prober,
        correction: BedCorrection,
        corrections: BedCorrectionCommands,
        offsets: ProbeOffsetCommands,
        manual: ManualProbe,
        moves: PredefinedMoves,
        printed_area: Callable[[], Area | None],
    ) -> None:
        self._rig, self._prober, self._correction = rig, prober, correction
        self._corrections, self._offsets, self._manual = corrections, offsets, manual
        self._moves, self._printed_area = moves, printed_area
        self._config = config = rig.machine.levelling
        self.points = list(config.points)
        self.mesh_grid: Grid | None = None
        if config.area is not None:
            x0, y0, x1, y1 = config.area
            self.mesh_grid = Grid((x0, y0, x1, y1), (config.count[0], config.count[1]))
        self._measured: list[tuple[Place, float]] = []  # with the height of the trigger
        self._progress = (0, 0)  # places done, and places in total, in a run
        self._shown: tuple[tuple[object, object, object], _ShownPoints] = (
            (None, None, None),
            ((), None, None),
        )
        self._drawn: tuple[Correction | None, BedSurface | None] = (None, None)

    # -- points -----------------------------------------------------------------------------------

    @command(
        "G32",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures all enabled points, and corrects the bed by them, or by its mesh if that is the"
        " method; D only measures. P measures one point, and leaves the nozzle R above it.",
        flag("D", "only measures"),
        integer("P", "measures this point alone", 1),
        number("R", "how high above it the nozzle stays", "mm"),
        ignored("S"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _measure_points(self, command: Command, reply: Reply) -> Wait | None:
        if command.has("P"):
            return self._one_point(command, reply)
        dry = command.flag("D")
        method = self._config.method
        if method == "mesh" and not dry:
            return self.measure_mesh(reply)
        places = self._places()
        if method in ("linear", "quadratic"):
            check_points([(p.x, p.y) for p in places], method)
        now = self._correction
        before = now.correction if now.on else None
        left: list[tuple[float, float, float]] = []

        def report(found: Measured, reply: Reply) -> None:
            place = found.place
            mm = found.height_mm - (before.plain(place.x, place.y) if before else 0.0)
            left.append((place.x, place.y, mm))
            reply.say(f"//ProbeHeight@P{place.name.removeprefix('point ')} {mm:.5f}")

        def done(_: Sequence[Measured], reply: Reply) -> None:
            self._correct_by(left, before, reply, dry=dry)

        return self._run(places, done, reply, report)

    @command(
        "BED_TILT_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures all enabled points and corrects the tilt of the bed, as G32 with the method"
        " linear.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _measure_tilt(self, command: Command, reply: Reply) -> Wait | None:
        method = self._config.method
        if method != "linear":
            why = f"levelling.method is {method}, and only linear corrects a tilt"
            raise CommandError.of("command.no-part", axis=command.code, value=why)
        return self._measure_points(command, reply)

    def _correct_by(
        self,
        left: Sequence[tuple[float, float, float]],
        before: Correction | None,
        reply: Reply,
        *,
        dry: bool,
    ) -> None:
        """Corrects the bed as APrinter does: the heights are the remaining errors of the current
        correction, and the fit to them is added to it."""
        method = self._config.method
        if method not in ("linear", "quadratic"):
            return
        found = fit(left, method)
        words = zip(("Z", "X", "Y", "XX", "XY", "YY"), found.coefficients, strict=True)
        shown = list(words)[: 3 if method == "linear" else 6]
        reply.say("RelativeCorrections " + " ".join(f"{k}:{v:.8f}" for k, v in shown))
        reply.say(f"The points deviate from this surface by {found.residual_rms:.4f} mm rms")
        if not dry:
            self._corrections.put((before or Correction()).accumulated(found), on=True)

    def _places(self) -> list[Place]:
        """The enabled points. Raises CommandError if there is none."""
        places = [
            Place(point.x, point.y, f"point {n}", point.offset)
            for n, point in enumerate(self.points, 1)
            if point.enabled
        ]
        if not places:
            raise CommandError.of("levelling.no-points")
        return places

    def _one_point(self, command: Command, reply: Reply) -> Wait | None:
        n = self._number("P", command.integer("P"))
        point = self.points[n - 1]
        place = Place(point.x, point.y, f"point {n}", point.offset)
        above = command.value("R", None)

        def done(found: Sequence[Measured], reply: Reply) -> None:
            reply.say(f"//ProbeHeight@P{n} {found[0].height_mm:.5f}")

        return self._run([place], done, reply, above_mm=above, alone=True)

    def _number(self, name: str, n: int) -> int:
        if not 1 <= n <= len(self.points):
            limit = f"a point from 1 to {len(self.points)}"
            raise CommandError.bad_value(name, n, limit)
        return n

    def _run(
        self,
        places: Sequence[Place],
        done: Done,
        reply: Reply,
        report: Callable[[Measured, Reply], None] = lambda _, __: None,
        above_mm: float | None = None,
        *,
        alone: bool = False,
        by_hand: bool = False,
        scan: str | None = None,
    ) -> Wait:
        """Measures these places, by the probe or by the paper test; `done` gets the heights.
        `by_hand`: by the paper test, also with a probe; `scan`: without descents, if the probe can.
        With the probe, makes the predefined moves
        before and after probing, unless `alone`: then the nozzle stays above the last place.
        `above_mm`: see `Prober.measure`. Raises CommandError."""
        found_so_far: list[Measured] = []

        def reported(found: Measured, reply: Reply) -> None:
            found_so_far.append(found)
            self._progress = len(found_so_far), len(places)
            report(found, reply)

        def ended(found: Sequence[Measured], reply: Reply) -> None:
            self._progress = 0, 0
            below = self._offsets.zero_below_trigger_mm
            self._measured = [(m.place, m.trigger_z_mm - below) for m in found]
            done(found, reply)

        if by_hand or not isinstance(self._prober.carried, SensingProbe):
            return self._manual.start(places, ended, reported, reply)

        async def run() -> None:
            self._prober.check(places)
            if not alone:
                await self._moves.run_hook("before_probing")
            self._progress = 0, len(places)
            try:
                if scan:
                    found = await self._prober.scan(
                        places, lambda m: reported(m, reply), rapid=scan == "rapid_scan"
                    )
                else:
                    found = await self._prober.measure(
                        places, lambda m: reported(m, reply), above_mm
                    )
            finally:
                self._progress = 0, 0
            ended(found, reply)
            if not alone:
                await self._moves.run_hook("after_probing")

        return WaitForProcedure(run)

    @command(
        "SET_PROBE_POINT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets point N of G32; what is not given stays.",
        integer("N", "the number of the point", 1),
        number("X Y", "its place", "mm"),
        number("OFFSET", "how much is added to its height", "mm"),
        number("ENABLED", "0: it is not measured"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _set_point(self, command: Command, _: Reply) -> Wait | None:
        n = self._number("N", command.integer("N"))
        point = self.points[n - 1]
        changed = ProbePoint(
            x=command.value("X", point.x),
            y=command.value("Y", point.y),
            offset=command.value("OFFSET", point.offset),
            enabled=command.value("ENABLED", float(point.enabled)) != 0,
        )
        if changed.enabled:
            self._prober.check_place(Place(changed.x, changed.y, f"point {n}"))
        self.points[n - 1] = changed
        return None

    # -- all methods ------------------------------------------------------------------------------

    @command(
        "G29",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures the bed by the method of the machine file; this replaces the correction before,"
        " and prints its heights as M420 V. D only measures, J alone forgets the correction. W sets"
        " one point of the mesh. S0 to S5 are those of the paper test (show, start, next, set,"
        " raise by Z, forget), or of RepRapFirmware.",
        flag("D", "only measures"),
        flag("W", "sets a point of the mesh"),
        integer("I J", "that point: column and row; J alone forgets the correction", alone=True),
        number("Z", "a height", "mm"),
        number("S", "a step of the paper test, or of RepRapFirmware: 0 to 5"),
        anything(),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _level(self, command: Command, reply: Reply) -> Wait | None:
        letters = command.letters()
        if command.flag("W"):
            words = command.words()
            return WaitForMoves(lambda: self._corrections.set_point(words))
        if letters == ["J"]:
            return WaitForMoves(lambda: self._corrections.put(None, on=False))
        step = command.value("S", None)
        paper = not isinstance(self._prober.carried, SensingProbe)
        if step is not None and (paper or self._config.dialect == "rrf"):
            return self._step(int(step), command, reply, paper=paper)
        return self._measure(reply, dry=command.flag("D"))

    @command(
        "G80",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Ends a canned cycle. On a printer for filament, outside of a cycle, it is G29, as in"
        " Prusa's firmware, and measures the whole bed.",
        anything(),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _level_as_prusa(self, _: Command, reply: Reply) -> Wait | None:
        return self._measure(reply, dry=False)

    def _step(self, step: int, command: Command, reply: Reply, *, paper: bool) -> Wait | None:
        """G29 S, as in Marlin's mesh bed leveling or in RepRapFirmware."""
        corrections = self._corrections
        if paper and step == 2:
            return self._manual.accept(command, reply)
        if (paper and step == 3) or (paper and step == 0):
            if step == 3:
                words = command.words()
                return WaitForMoves(lambda: corrections.set_point(words))
            for line in bilinear_grid(corrections.mesh()):
                reply.say(line)
            return None
        if paper and step == 4:
            mm = command.value("Z")
            return WaitForMoves(lambda: corrections.raise_to(mm, reply))
        if (paper and step == 5) or (not paper and step == 2):
            return WaitForMoves(lambda: corrections.put(None, on=False))
        if not paper and step == 1:
            stored = corrections.meshes.named(DEFAULT)
            return WaitForMoves(lambda: corrections.load_mesh(stored, reply))
        if not paper and step == 3:
            return WaitForMoves(lambda: corrections.save_mesh(DEFAULT))
        if step == (1 if paper else 0):
            return self._measure(reply, dry=False)
        raise CommandError.bad_value("S", step, "0 to 5" if paper else "0 to 3")

    def _measure(self, reply: Reply, *, dry: bool) -> Wait:
        if self._config.method not in ("linear", "quadratic"):
            return self.measure_mesh(reply, dry=dry)
        method = self._config.method
        places = self._places()
        check_points([(p.x, p.y) for p in places], method)

        def done(measured: Sequence[Measured], reply: Reply) -> None:
            found = fit([(m.place.x, m.place.y, m.height_mm) for m in measured], method)
            shown = zip(TERMS, found.coefficients, strict=True)
            # Not "Bed: …": Bed Visualizer takes a line that begins so as heights.
            reply.say("Surface: " + " ".join(f"{k}:{v:.8f}" for k, v in shown))
            reply.say(f"The points deviate from this surface by {found.residual_rms:.4f} mm rms")
            correction = Correction(fit=found, fade=self._corrections.fade)
            if not dry:
                self._corrections.put(correction, on=True)
            for line in bilinear_grid(correction.table(self._rig.machine.bed_area_mm)):
                reply.say(line)

        return self._run(places, done, reply)

    # -- mesh -------------------------------------------------------------------------------------

    def grid(self) -> Grid:
        """The grid of the next mesh. Raises CommandError if neither the machine file nor a command
        gives an area."""
        if self.mesh_grid is None:
            raise CommandError.of("levelling.no-area")
        return self.mesh_grid

    @command(
        "BED_MESH_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Measures a mesh; this replaces the correction before, and is stored as PROFILE. With"
        " ADAPTIVE=1 only where the print is, as far as the file says it. The other parameters"
        " replace the area, the number of points and the interpolation of the machine file for"
        " this mesh. METHOD=manual measures by the paper test; scan and rapid_scan, with an eddy"
        " current probe, without descents.",
        text("MESH_MIN MESH_MAX", "the corners of the mesh: X,Y in mm"),
        text("PROBE_COUNT", "the points along X and Y: 5,5"),
        number("MESH_RADIUS", "the radius of a round mesh", "mm", 0, above=True),
        text("MESH_ORIGIN", "the middle of a round mesh: X,Y in mm"),
        integer("ROUND_PROBE_COUNT", "its points along X and Y"),
        choice("ALGORITHM", "the interpolation", *ALGORITHMS),
        choice("METHOD", "by the paper test, or without descents or stops", *METHODS),
        flag("ADAPTIVE", "only where the print is"),
        number("ADAPTIVE_MARGIN", "how far around it", "mm"),
        text("PROFILE", "the name under which the mesh is stored"),
        ignored("HORIZONTAL_MOVE_Z"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _calibrate_mesh(self, command: Command, reply: Reply) -> Wait | None:
        grid, area = given_grid(command, self.mesh_grid), self._printed_area()
        profile = command.string("PROFILE")
        if command.flag("ADAPTIVE"):
            if area is None:
                reply.say("echo:The file names no objects: the whole mesh is measured")
            else:
                margin = command.value("ADAPTIVE_MARGIN", self._config.margin_mm)
                grid = grid.adapted(area, margin)
                profile = ""  # a mesh of this print only has no name

        def measured(reply: Reply) -> None:
            if profile:
                self._corrections.save_mesh(profile)
            reply.say("// Mesh Bed Leveling Complete")

        usual = self._config.interpolation
        interpolation = given_interpolation(command, grid, usual)
        return self.measure_mesh(
            reply,
            grid=grid,
            interpolation=interpolation,
            by_hand=by_hand(command),
            scan=scan_of(command),
            then=measured,
        )

    def measure_mesh(
        self,
        reply: Reply,
        *,
        dry: bool = False,
        grid: Grid | None = None,
        interpolation: Interpolation | None = None,
        by_hand: bool = False,
        scan: str | None = None,
        then: Callable[[Reply], None] = lambda _: None,
    ) -> Wait:
        """Measures a mesh, which replaces the current correction unless `dry` is True. `by_hand`:
        by the paper test, also with a probe; `scan`: see `_run`. Raises CommandError."""
        grid = grid or self.grid()
        interpolation = interpolation or self._config.interpolation
        avoid = [(a[0], a[1], a[2], a[3]) for a in self._config.avoid]
        check_avoided(avoid)
        spots = {(x, y): places_around(x, y, grid.area, avoid) for x, y in grid.probed()}
        wanted = [spot for around in spots.values() for spot in around]
        reference = self._config.reference
        if reference is not None:
            wanted.append((reference[0], reference[1]))
        places = [
            Place(x, y, f"mesh point {n}", by_nozzle=by_hand) for n, (x, y) in enumerate(wanted, 1)
        ]

        def done(measured: Sequence[Measured], reply: Reply) -> None:
            at = {(m.place.x, m.place.y): m.height_mm for m in measured}
            mesh = grid.mesh(lambda x, y: round(fmean(at[s] for s in spots[x, y]), 6))
            if reference is not None:
                # Then Z 0 of the program is the bed at the reference point, according to the
                # endstop.
                mesh = mesh.lowered(measured[-1].height_mm)
            if not dry:
                fade = self._corrections.fade
                correction = Correction(None, mesh, interpolation, fade)
                self._corrections.put(correction, on=True)
            for line in bilinear_grid(mesh):
                reply.say(line)
            then(reply)

        return self._run(places, done, reply, by_hand=by_hand, scan=scan)

    @command(
        "M557",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the area of the mesh, and how many points it has (P5:4) or how far they are apart"
        " (S20). Without parameters it reports them. A restart forgets it.",
        rest(
            "X(from:to) Y(from:to) P(points) S(mm)",
            "the area, and the number of points or their distance",
        ),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _set_grid(self, command: Command, reply: Reply) -> Wait | None:
        spans = {m[1]: (float(m[2]), float(m[3])) for m in _SPAN.finditer(command.text.upper())}
        pairs = {
            m[1]: (float(m[2]), float(m[3] or m[2])) for m in _PAIR.finditer(command.text.upper())
        }
        if not spans and not pairs:
            grid = self.grid()
            x0, y0, x1, y1 = grid.area
            reply.say(
                f"Grid: X{x0:.1f}:{x1:.1f}, Y{y0:.1f}:{y1:.1f}, radius -1.0, X spacing"
                f" {grid.xs[1] - grid.xs[0]:.1f}, Y spacing {grid.ys[1] - grid.ys[0]:.1f},"
                f" {len(grid.xs) * len(grid.ys)} points"
            )
            return None
        before = self.mesh_grid
        area = before.area if before else None
        if spans.keys() == {"X", "Y"}:
            (x0, x1), (y0, y1) = spans["X"], spans["Y"]
            area = x0, y0, x1, y1
        if area is None or not (area[0] < area[2] and area[1] < area[3]):
            raise CommandError.of(
                "command.value", axis="M557", value=command.text, limit="X10:200 Y10:180 P5"
            )
        counts = before.count if before else (5, 5)
        if "S" in pairs:
            wide, deep = pairs["S"]
            if min(wide, deep) <= 0:
                raise CommandError.bad_value("S", min(wide, deep), "more than 0 mm")
            counts = int((area[2] - area[0]) / wide) + 1, int((area[3] - area[1]) / deep) + 1
        if "P" in pairs:
            counts = int(pairs["P"][0]), int(pairs["P"][1])
        if not all(2 <= n <= 41 for n in counts):
            raise CommandError.of(
                "command.value", axis="M557", value=f"{counts[0]}:{counts[1]}", limit="2 to 41"
            )
        grid = Grid(area, counts)
        for n, (x, y) in enumerate(grid.probed(), 1):
            self._prober.check_place(Place(x, y, f"mesh point {n}"))
        self.mesh_grid = grid
        return None

    @command(
        "G42",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Moves the nozzle over a point of the mesh; P: the probe.",
        integer("I J", "the point: column and row", 0, default=0),
        flag("P", "moves the probe there, not the nozzle"),
        number("F", "the feedrate", "mm/min", 0, above=True),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _go_to_point(self, command: Command, _: Reply) -> Wait | None:
        i, j, mesh = command.integer("I"), command.integer("J"), self._corrections.mesh()
        if not (0 <= i < len(mesh.xs) and 0 <= j < len(mesh.ys)):
            limit = f"I below {len(mesh.xs)}, J below {len(mesh.ys)}"
            raise CommandError.of(
                "command.value", axis="the mesh point", value=f"I{i} J{j}", limit=limit
            )
        by_probe = command.flag("P")
        place = Place(mesh.xs[i], mesh.ys[j], "the mesh point", by_nozzle=not by_probe)
        speed = command.value("F", 60 * self._prober.carried.travel_mm_s) / 60
        return WaitForProcedure(lambda: self._prober.go_to(place, speed))

    # -- settings and status ----------------------------------------------------------------------

    def setting_lines(self) -> Iterator[str]:
        """Commands that restore offsets, points, grid and correction exactly."""
        yield self._offsets.line()
        for n, point in enumerate(self.points, 1):
            yield (
                f"SET_PROBE_POINT N={n} X={exact(point.x)} Y={exact(point.y)}"
                f" OFFSET={exact(point.offset)} ENABLED={int(point.enabled)}"
            )
        yield from self._corrections.setting_lines()

    def status(self) -> BedStatus:
        """The status of the bed."""
        now = self._correction
        correction = now.correction
        points, rms_mm, left_rms_mm = self._shown_points(correction)
        fade = correction.fade if correction else None
        dx, dy = self._prober.offset_mm
        return BedStatus(
            method=self._config.method,
            on=now.on,
            profile=self._corrections.profile,
            points=points,
            rms_mm=rms_mm,
            left_rms_mm=left_rms_mm,
            surface=self._surface(),
            fade_mm=fade.end_mm if fade else None,
            probe=self._prober.kind,
            probe_offset_mm=(dx, dy),
            trigger_height_mm=self._prober.trigger_height_mm,
            measured=self._progress[0],
            to_measure=self._progress[1],
            manual=self._manual.status,
            mesh=correction.mesh if correction else None,
            meshes=dict(self._corrections.meshes.all),
            triggered=self._prober.last_triggered,
            holds_babysteps=self._offsets.holds_babysteps,
        )

    def _shown_points(self, correction: Correction | None) -> _ShownPoints:
        """The last measured points, and their RMS deviations from their mean and from the
        correction, mm. Recomputed only after a change."""
        below = self._prober.trigger_height_mm - self._offsets.zero_below_trigger_mm
        key = self._measured, correction, below
        measured, then, height = self._shown[0]
        if measured is self._measured and then is correction and height == below:
            return self._shown[1]
        points = tuple(
            BedPoint(place.x, place.y, round(z - below + place.offset_mm, 6))
            for place, z in self._measured
        )
        if not points:
            found: _ShownPoints = (), None, None
        else:
            left = [
                p.height_mm - (correction.plain(p.x_mm, p.y_mm) if correction else 0.0)
                for p in points
            ]
            rms = pstdev(p.height_mm for p in points)
            found = points, round(rms, 6), round(fmean(x * x for x in left) ** 0.5, 6)
        self._shown = key, found
        return found

    def _surface(self) -> BedSurface | None:
        """The heights that the correction adds to Z, sampled over the bed. Recomputed only after a
        change."""
        correction = self._correction.correction
        if correction is None:
            return None
        if self._drawn[0] is not correction:
            x0, y0, x1, y1 = self._rig.machine.bed_area_mm
            parts = range(_SURFACE_POINTS)
            xs = [x0 + (x1 - x0) * i / (_SURFACE_POINTS - 1) for i in parts]
            ys = [y0 + (y1 - y0) * j / (_SURFACE_POINTS - 1) for j in parts]
            rows = tuple(tuple(round(correction.plain(x, y), 4) for x in xs) for y in ys)
            self._drawn = correction, BedSurface((x0, y0), (x1, y1), rows)
        return self._drawn[1]
