"""G32, G29 and the other commands that measure and correct the bed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from itertools import pairwise
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.registry import ANY, Kind, Subject, When, command
from passo.levelling.areas import Grid
from passo.levelling.correction import Correction, Fade
from passo.levelling.fits import Fit, check_points, fit
from passo.levelling.mesh import Mesh
from passo.levelling.replies import bilinear_grid, probed_rows
from passo.motion.probing import Measured, Place, Prober
from passo.printer.commands.klipper_commands import number
from passo.printer.commands.probing import NO_PROBE
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure

if TYPE_CHECKING:
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.rig import Rig

_TERMS = ("C0", "CX", "CY", "CXX", "CXY", "CYY")


def _exact(value: float) -> str:
    """A number without an exponent that reads back as the same double."""
    return f"{Decimal(repr(value)):f}"


class LevellingCommands:
    """Bed levelling of one printer."""

    def __init__(self, rig: Rig, prober: Prober, correction: BedCorrection) -> None:
        self._rig, self._prober, self._correction = rig, prober, correction
        self._config = rig.machine.levelling

    # -- measuring --------------------------------------------------------------------------------

    @command(
        "G32",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "D, P R(mm)",
        "Measures all enabled points of the machine file, and corrects the bed by them; D only"
        " measures. P measures one point, and leaves the nozzle R above it.",
        kind=Kind.SERVED,
        bare="D",
        lacks=NO_PROBE,
    )
    def _measure_points(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if "P" in words:
            return self._one_point(words, reply)
        places = list(self._places())
        if not places:
            raise CommandError.of("levelling.no-points")
        dry = "D" in command.letters()
        return WaitForProcedure(lambda: self._correct_by_points(places, reply, dry=dry))

    def _places(self) -> Iterator[Place]:
        for n, point in enumerate(self._config.points, 1):
            if point.enabled:
                yield Place(point.x, point.y, f"point {n}", point.offset)

    def _one_point(self, words: dict[str, float], reply: Reply) -> Wait | None:
        n = int(words["P"])
        if not 1 <= n <= len(self._config.points):
            limit = f"a point from 1 to {len(self._config.points)}"
            raise CommandError.bad_value("P", words["P"], limit)
        point = self._config.points[n - 1]
        place = Place(point.x, point.y, f"point {n}", point.offset)
        above = words.get("R")

        async def measure() -> None:
            (found,) = await self._prober.measure([place], above_mm=above)
            reply.say(f"//ProbeHeight@P{n} {found.height_mm:.5f}")

        return WaitForProcedure(measure)

    async def _correct_by_points(self, places: Sequence[Place], reply: Reply, *, dry: bool) -> None:
        """As in APrinter: the measured heights include the correction in force, and the fit to them
        is added to it."""
        now = self._correction
        before = now.correction if now.on else None
        method = self._config.method
        fitted = method in ("linear", "quadratic")
        if fitted:
            check_points([(p.x, p.y) for p in places], method)
        points: list[tuple[float, float, float]] = []

        def report(found: Measured) -> None:
            place = found.place
            left = found.height_mm - (before.plain(place.x, place.y) if before else 0.0)
            points.append((place.x, place.y, left))
            reply.say(f"//ProbeHeight@P{place.name.removeprefix('point ')} {left:.5f}")

        await self._prober.measure(places, report)
        if not fitted:
            return
        found = fit(points, method)
        words = zip(("Z", "X", "Y", "XX", "XY", "YY"), found.coefficients, strict=True)
        shown = list(words)[: 3 if method == "linear" else 6]
        reply.say("RelativeCorrections " + " ".join(f"{k}:{v:.8f}" for k, v in shown))
        reply.say(f"The points deviate from it by {found.residual_rms:.4f} mm rms")
        if not dry:
            self._put((before or Correction()).accumulated(found), on=True)

    @command(
        "G29",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "D, W I J Z(mm)",
        "Measures the bed by the method of the machine file; this replaces the correction before."
        " D only measures. W sets one point of the mesh.",
        kind=Kind.SERVED,
        bare=ANY,
        lacks=NO_PROBE,
    )
    def _level(self, command: Command, reply: Reply) -> Wait | None:
        if "W" in command.letters():
            words = command.words()
            return WaitForMoves(lambda: self.set_point(words))
        dry = "D" in command.letters()
        if self._config.method in ("linear", "quadratic"):
            places = list(self._places())
            check_points([(p.x, p.y) for p in places], self._config.method)
            return WaitForProcedure(lambda: self._level_anew(places, reply, dry=dry))
        return self.measure_mesh(reply, dry=dry)

    async def _level_anew(self, places: Sequence[Place], reply: Reply, *, dry: bool) -> None:
        method = self._config.method
        assert method in ("linear", "quadratic")
        measured = await self._prober.measure(places)
        found = fit([(m.place.x, m.place.y, m.height_mm) for m in measured], method)
        shown = zip(_TERMS, found.coefficients, strict=True)
        reply.say("Bed: " + " ".join(f"{k}:{v:.8f}" for k, v in shown))
        reply.say(f"The points deviate from it by {found.residual_rms:.4f} mm rms")
        if not dry:
            self._put(Correction(fit=found, fade=self._fade), on=True)

    def grid(self) -> Grid:
        """The places of a mesh. Raises CommandError if the machine file gives no area."""
        area = self._config.area
        if area is None:
            raise CommandError.of("levelling.no-area")
        x0, y0, x1, y1 = area
        columns, rows = self._config.count
        return Grid((x0, y0, x1, y1), (columns, rows))

    def measure_mesh(self, reply: Reply, *, dry: bool = False) -> Wait:
        """Measures a mesh, which replaces the correction before, unless it is `dry`. Raises
        CommandError."""
        grid = self.grid()
        return WaitForProcedure(lambda: self._measure_mesh(grid, reply, dry=dry))

    async def _measure_mesh(self, grid: Grid, reply: Reply, *, dry: bool) -> None:
        places = [Place(x, y, f"mesh point {n}") for n, (x, y) in enumerate(grid.probed(), 1)]
        measured = await self._prober.measure(places)
        heights = {(m.place.x, m.place.y): m.height_mm for m in measured}
        mesh = grid.mesh(lambda x, y: heights[x, y])
        if not dry:
            interpolation = self._config.interpolation
            self._put(Correction(None, mesh, interpolation, self._fade), on=True)
        for line in bilinear_grid(mesh):
            reply.say(line)

    @property
    def _fade(self) -> Fade | None:
        """The fade that a new correction keeps."""
        correction = self._correction.correction
        return correction.fade if correction else None

    def _put(self, correction: Correction | None, *, on: bool) -> None:
        """Sets the correction, and switches it on or off. It fades to the mean of its mesh. Raises
        CommandError if it is on and beyond the limits of the machine file."""
        if correction is not None and correction.fade is not None:
            mean = round(correction.mesh.mean, 2) if correction.mesh else 0.0
            correction = replace(correction, fade=replace(correction.fade, target_mm=mean))
        if correction is not None and on:
            self._check_limits(correction)
        self._correction.use(correction, on=on)

    def _check_limits(self, correction: Correction) -> None:
        x0, y0, x1, y1 = self._rig.machine.bed_area_mm
        _, spacing, heights = correction.even_map((x0, y0, x1, y1))
        most = max(abs(z) for row in heights for z in row)
        limits = self._config
        if most > limits.max_correction_mm:
            raise CommandError.of(
                "levelling.too-much", value=f"{most:.3f}", limit=f"{limits.max_correction_mm:g}"
            )
        along_x = (abs(b - a) / spacing[0] for r in heights for a, b in pairwise(r))
        along_y = (
            abs(b - a) / spacing[1] for r, s in pairwise(heights) for a, b in zip(r, s, strict=True)
        )
        steepest = max(*along_x, *along_y)
        if steepest > limits.max_slope:
            raise CommandError.of(
                "levelling.too-steep", value=f"{steepest:.4f}", limit=f"{limits.max_slope:g}"
            )

    @command(
        "BED_MESH_CALIBRATE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "",
        "Measures a mesh of the area in the machine file; this replaces the correction before.",
        kind=Kind.SERVED,
        bare=None,
        lacks=NO_PROBE,
    )
    def _calibrate_mesh(self, _: Command, reply: Reply) -> Wait | None:
        return self.measure_mesh(reply)

    @command(
        "BED_MESH_OUTPUT",
        Subject.LEVELLING,
        When.PLANNED,
        "",
        "Prints the measured heights of the mesh, its front row first.",
        kind=Kind.QUIET,
        bare=None,
        lacks=NO_PROBE,
    )
    def _print_mesh(self, _: Command, reply: Reply) -> Wait | None:
        for line in probed_rows(self._mesh()):
            reply.say(line)
        return None

    def _mesh(self) -> Mesh:
        correction = self._correction.correction
        if correction is None or correction.mesh is None:
            raise CommandError.of("levelling.none")
        return correction.mesh

    @command(
        "M421",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "I J Z(mm) Q(mm)",
        "Sets the height of a point of the mesh to Z, or adds Q to it; I counts in X, J in Y.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _edit_mesh(self, command: Command, _: Reply) -> Wait | None:
        words = command.words()
        return WaitForMoves(lambda: self.set_point(words))

    # -- on and off -------------------------------------------------------------------------------

    @command(
        "BED_MESH_CLEAR",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "",
        "As M561.",
        kind=Kind.SERVED,
        bare=None,
        lacks=NO_PROBE,
    )
    @command(
        "M561",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "",
        "Forgets the correction of the bed.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def forget(self, _: Command, __: Reply) -> Wait | None:
        """Deletes it at standstill."""
        return WaitForMoves(lambda: self._put(None, on=False))

    @command(
        "M420",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "S Z(mm) V T",
        "Switches the correction of the bed on (S1) or off (S0). Z is the height at which it has"
        " faded out; 0: it does not fade. V prints it.",
        kind=Kind.SERVED,
        bare="VT",
        lacks=NO_PROBE,
    )
    def _switch(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        verbose = "V" in command.letters()
        return WaitForMoves(lambda: self._switched(words, reply, verbose=verbose))

    def _switched(self, words: dict[str, float], reply: Reply, *, verbose: bool) -> None:
        now = self._correction
        correction = now.correction
        if words.get("S", 0.0) and correction is None:
            reply.say("Invalid mesh.")
            raise CommandError.of("levelling.none")
        if "Z" in words and correction is not None:
            fade = Fade(0.0, words["Z"]) if words["Z"] > 0 else None
            correction = replace(correction, fade=fade)
        if "S" in words or "Z" in words:
            self._put(correction, on=words.get("S", float(now.on)) != 0)
        correction = now.correction
        if verbose and correction is not None and correction.mesh is not None:
            for line in bilinear_grid(correction.mesh):
                reply.say(line)
        reply.say(f"echo:Bed Leveling {'ON' if now.on else 'OFF'}")
        fade = correction.fade if correction else None
        reply.say(f"echo:Fade Height {f'{fade.end_mm:.2f}' if fade else 'OFF'}")

    @command(
        "M937",
        Subject.LEVELLING,
        When.PLANNED,
        "",
        "Reports the correction of the bed.",
        kind=Kind.QUIET,
        lacks=NO_PROBE,
    )
    def _report(self, _: Command, reply: Reply) -> Wait | None:
        now = self._correction
        if not now.on:
            reply.say("echo:No corrections of the bed are in effect")
            return None
        found = now.correction.fit if now.correction and now.correction.fit else Fit()
        words = zip(("Z", "X", "Y", "XX", "XY", "YY"), found.coefficients, strict=True)
        reply.say("EffectiveCorrections " + " ".join(f"{k}:{v:.8f}" for k, v in words))
        return None

    # -- settings ---------------------------------------------------------------------------------

    @command(
        "M851",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "X Y Z (mm)",
        "Sets the place of the probe from the nozzle. Z is below 0 if the probe triggers while the"
        " nozzle is above the bed. Without parameters it reports them.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _probe_offset(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(f"  {self._offset_line()} ; (mm)")
            return None
        self._set_offsets(words)
        return None

    def _set_offsets(self, words: dict[str, float]) -> None:
        prober = self._prober
        for letter, value in words.items():
            most = 20.0 if letter == "Z" else 300.0
            if abs(value) > most:
                raise CommandError.bad_value(letter, value, f"-{most:g} to {most:g} mm")
        dx, dy = prober.offset_mm
        before = prober.trigger_height_mm
        prober.offset_mm = words.get("X", dx), words.get("Y", dy)
        prober.trigger_height_mm = -words.get("Z", -before)

    @command(
        "G31",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "X Y Z (mm)",
        "As M851 in RepRapFirmware's words: Z is the height of the nozzle at which the probe"
        " triggers.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _probe_height(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reading = 1000 if self._prober.triggered() else 0
            dx, dy = self._prober.offset_mm
            reply.say(
                f"Z probe 0: current reading {reading}, threshold 500, trigger height"
                f" {self._prober.trigger_height_mm:.3f}, offsets X{dx:.1f} Y{dy:.1f}"
            )
            return None
        turned = {k: -v if k == "Z" else v for k, v in words.items() if k in "XYZ"}
        self._set_offsets(turned)
        return None

    def _offset_line(self) -> str:
        dx, dy = self._prober.offset_mm
        return f"M851 X{_exact(dx)} Y{_exact(dy)} Z{_exact(-self._prober.trigger_height_mm + 0.0)}"

    @command(
        "SET_BED_FIT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "C0(mm) CX CY CXX CXY CYY",
        "Sets the surface that is added to Z, as M500 stores it: C0 + CX·x + CY·y + CXX·x² +"
        " CXY·x·y + CYY·y².",
        kind=Kind.SERVED,
        bare=None,
        lacks=NO_PROBE,
    )
    def _set_fit(self, command: Command, _: Reply) -> Wait | None:
        pairs = command.pairs()
        now = self._correction.correction or Correction()
        terms = list((now.fit or Fit()).coefficients)
        for i, name in enumerate(_TERMS):
            terms[i] = number(pairs, name, terms[i])
        found = Fit(*terms) if any(terms) else None
        return WaitForMoves(lambda: self._store(replace(now, fit=found)))

    @command(
        "SET_BED_MESH",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "COLUMNS ROWS X0 Y0 X1 Y1 (mm)",
        "Makes a mesh of the bed with all heights 0, as M500 stores it; G29 W sets them. COLUMNS=0"
        " forgets the mesh.",
        kind=Kind.SERVED,
        bare=None,
        lacks=NO_PROBE,
    )
    def _set_mesh(self, command: Command, _: Reply) -> Wait | None:
        pairs = command.pairs()
        columns, rows = (int(number(pairs, name, 0.0)) for name in ("COLUMNS", "ROWS"))
        now = self._correction.correction or Correction()
        if columns == 0:
            return WaitForMoves(lambda: self._store(replace(now, mesh=None)))
        if not (2 <= columns <= 41 and 2 <= rows <= 41):
            raise CommandError.of(
                "command.value",
                axis="SET_BED_MESH",
                value=f"{columns} × {rows}",
                limit="2 to 41 COLUMNS and ROWS",
            )
        x0, y0, x1, y1 = (number(pairs, name) for name in ("X0", "Y0", "X1", "Y1"))
        xs = tuple(round(x0 + (x1 - x0) * i / (columns - 1), 6) for i in range(columns))
        ys = tuple(round(y0 + (y1 - y0) * j / (rows - 1), 6) for j in range(rows))
        mesh = Mesh(xs, ys, ((0.0,) * columns,) * rows)
        interpolation = self._config.interpolation
        return WaitForMoves(
            lambda: self._store(replace(now, mesh=mesh, interpolation=interpolation))
        )

    def set_point(self, words: dict[str, float]) -> None:
        """Sets the height Z of the point I, J of the mesh, or adds Q to it. Raises CommandError."""
        now = self._correction.correction
        mesh = now.mesh if now else None
        i, j = int(words.get("I", -1)), int(words.get("J", -1))
        if now is None or mesh is None:
            raise CommandError.of("levelling.none")
        if not (0 <= i < len(mesh.xs) and 0 <= j < len(mesh.ys)) or not words.keys() & {"Z", "Q"}:
            limit = f"I below {len(mesh.xs)}, J below {len(mesh.ys)}, and Z or Q"
            raise CommandError.of(
                "command.value", axis="the mesh point", value=f"I{i} J{j}", limit=limit
            )
        rows = [list(row) for row in mesh.heights]
        rows[j][i] = words["Z"] if "Z" in words else round(rows[j][i] + words["Q"], 6)
        heights = tuple(tuple(row) for row in rows)
        self._store(replace(now, mesh=replace(mesh, heights=heights)))

    def _store(self, correction: Correction) -> None:
        empty = correction.fit is None and correction.mesh is None
        self._put(None if empty else correction, on=self._correction.on and not empty)

    def setting_lines(self) -> Iterator[str]:
        """Commands that restore offsets and correction exactly."""
        now = self._correction
        correction = now.correction or Correction()
        yield self._offset_line()
        terms = (correction.fit or Fit()).coefficients
        pairs = zip(_TERMS, terms, strict=True)
        yield "SET_BED_FIT " + " ".join(f"{k}={_exact(v)}" for k, v in pairs)
        mesh = correction.mesh
        if mesh is None:
            yield "SET_BED_MESH COLUMNS=0 ROWS=0 X0=0 Y0=0 X1=0 Y1=0"
        else:
            corners = zip(
                ("X0", "Y0", "X1", "Y1"),
                (mesh.xs[0], mesh.ys[0], mesh.xs[-1], mesh.ys[-1]),
                strict=True,
            )
            area = " ".join(f"{k}={_exact(v)}" for k, v in corners)
            yield f"SET_BED_MESH COLUMNS={len(mesh.xs)} ROWS={len(mesh.ys)} {area}"
            for j, row in enumerate(mesh.heights):
                for i, z in enumerate(row):
                    yield f"G29 W I{i} J{j} Z{_exact(z)}"
        fade = correction.fade.end_mm if correction.fade else 0.0
        yield f"M420 S{int(now.on)} Z{_exact(fade)}"
