"""M420, M561 and other commands that switch, edit and store the bed correction."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal
from itertools import pairwise
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import flag, ignored, integer, number, rest, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.levelling.correction import Correction, Fade
from passo.levelling.fits import Fit
from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import MeshStore, StoredMesh, check_name
from passo.levelling.replies import bilinear_grid, probed_rows
from passo.printer.commands.mesh_words import MOST_POINTS
from passo.printer.commands.probing import NO_PROBE
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.rig import Rig

_P = re.compile(r'P\s*(?:"([^"]*)"|(\S+))', re.ASCII)
TERMS = ("C0", "CX", "CY", "CXX", "CXY", "CYY")
DEFAULT = "default"
"""The name of a mesh that was just measured."""


def exact(value: float) -> str:
    """A number as text that is read back as the same double, without an exponent."""
    return f"{Decimal(repr(value)):f}"


class BedCorrectionCommands:
    """The commands for the bed correction of one printer. `profile` is the name of the active
    stored mesh, or empty; `meshes` are the stored meshes."""

    def __init__(self, rig: Rig, correction: BedCorrection, meshes: MeshStore) -> None:
        self._rig, self._correction = rig, correction
        self._config = rig.machine.levelling
        self.profile = ""
        self._raised_mm = 0.0  # by `raise_to`
        self.meshes = meshes

    @property
    def fade(self) -> Fade | None:
        """The fade of the current correction, which a new correction takes over; None without a
        fade."""
        correction = self._correction.correction
        if correction is not None:
            return correction.fade
        return Fade(0.0, self._config.fade_mm) if self._config.fade_mm else None

    def put(self, correction: Correction | None, *, on: bool, profile: str = "") -> None:
        """Sets the correction, and switches it on or off. It fades to the mean of its mesh.
        `profile` is the name of the stored mesh, if it is one. Raises CommandError if the
        correction is switched on and exceeds the limits of the machine file."""
        if correction is not None and correction.fade is not None:
            mean = round(correction.mesh.mean, 2) if correction.mesh else 0.0
            correction = replace(correction, fade=replace(correction.fade, target_mm=mean))
        if correction is not None and on:
            self._check_limits(correction)
        before = self._correction.correction
        self._correction.use(correction, on=on)
        self.profile = profile if correction is not None else ""
        if correction is None or before is None or correction.mesh != before.mesh:
            self._raised_mm = 0.0

    def raise_by(self, mm: float, *, faded: bool = False) -> None:
        """Raises the correction, if there is one, by `mm`; with `faded` until a restart also where
        it has faded out. Raises CommandError without any change if it is on and would exceed the
        limits of the machine file."""
        now = self._correction
        if now.correction is None:
            return
        fade = now.correction.fade
        self.put(now.correction.raised(mm), on=now.on)
        if faded and fade is not None:
            fade = replace(fade, target_mm=fade.target_mm + mm)
            now.use(replace(now.correction, fade=fade), on=now.on)

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
        "BED_MESH_OUTPUT",
        Subject.LEVELLING,
        When.PLANNED,
        "Prints the measured heights of the mesh, its front row first.",
        kind=Kind.QUIET,
        lacks=NO_PROBE,
    )
    def _print_mesh(self, _: Command, reply: Reply) -> Wait | None:
        for line in probed_rows(self.mesh()):
            reply.say(line)
        return None

    @command(
        "BED_MESH_MAP",
        Subject.LEVELLING,
        When.PLANNED,
        "Prints the measured heights of the mesh as JSON.",
        kind=Kind.QUIET,
        lacks=NO_PROBE,
    )
    def _map_mesh(self, _: Command, reply: Reply) -> Wait | None:
        mesh = self.mesh()
        shown = {
            "mesh_min": [mesh.xs[0], mesh.ys[0]],
            "mesh_max": [mesh.xs[-1], mesh.ys[-1]],
            "z_positions": [list(row) for row in mesh.heights],
        }
        reply.say(f"mesh_map_output {json.dumps(shown)}")
        return None

    def mesh(self) -> Mesh:
        """The mesh of the current correction. Raises CommandError without one."""
        correction = self._correction.correction
        if correction is None:
            raise CommandError.of("levelling.none")
        if correction.mesh is None:
            raise CommandError.of("levelling.no-mesh")
        return correction.mesh

    @command(
        "M421",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the height of a point of the mesh to Z, or adds Q to it; I counts in X, J in Y.",
        integer("I J", "the point: column and row"),
        number("Z", "its height", "mm"),
        number("Q", "a change of its height", "mm"),
        kind=Kind.PROBED,
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
        "As M561.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "M561",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Forgets the correction of the bed.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def forget(self, _: Command, __: Reply) -> Wait | None:
        """Removes the correction at standstill."""
        return WaitForMoves(lambda: self.put(None, on=False))

    @command(
        "M420",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Switches the correction of the bed on (S1) or off (S0). Z is the height at which it has"
        " faded out; 0: it does not fade. V prints its heights: at the points of the mesh, or of a"
        " surface at 11 × 11 points over the bed.",
        number("S", "1: on, 0: off"),
        number("Z", "the height at which the correction has faded out; 0: it does not fade", "mm"),
        flag("V", "prints the heights"),
        ignored("T L"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _switch(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        verbose = command.flag("V")
        return WaitForMoves(lambda: self._switched(words, reply, verbose=verbose))

    @command(
        "M376",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the height at which the correction of the bed has faded out, as M420 Z; 0: it does"
        " not fade.",
        number("H", "the height at which the correction has faded out; 0: it does not fade", "mm"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _taper(self, command: Command, reply: Reply) -> Wait | None:
        faded = {"Z": command.value("H")} if command.has("H") else dict[str, float]()
        return WaitForMoves(lambda: self._switched(faded, reply, verbose=False))

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
            on = words.get("S", float(now.on)) != 0
            self.put(correction, on=on, profile=self.profile)
        correction = now.correction
        if verbose and correction is not None:
            for line in bilinear_grid(correction.table(self._rig.machine.bed_area_mm)):
                reply.say(line)
        reply.say(f"echo:Bed Leveling {'ON' if now.on else 'OFF'}")
        height = f"{self.fade.end_mm:.2f}" if self.fade else "OFF"
        reply.say(f"echo:Fade Height {height}")

    @command(
        "M937",
        Subject.LEVELLING,
        When.PLANNED,
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

    # -- as settings -------------------------------------------------------------------------------

    @command(
        "SET_BED_FIT",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the surface that is added to Z, as M500 stores it: C0 + CX·x + CY·y + CXX·x² +"
        " CXY·x·y + CYY·y².",
        number("C0", "the height in the middle", "mm"),
        number("CX CY CXX CXY CYY", "a factor of x, y, x², x·y, y²"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _set_fit(self, command: Command, _: Reply) -> Wait | None:
        now = self._correction.correction or Correction(fade=self.fade)
        terms = list((now.fit or Fit()).coefficients)
        for i, name in enumerate(TERMS):
            terms[i] = command.value(name, terms[i])
        found = Fit(*terms) if any(terms) else None
        return WaitForMoves(lambda: self._store(replace(now, fit=found)))

    @command(
        "SET_BED_MESH",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Makes a mesh of the bed with all heights 0, as M500 stores it; G29 W sets them. COLUMNS=0"
        " forgets the mesh.",
        integer("COLUMNS ROWS", "2 to 41 points along X and Y", 0, MOST_POINTS, default=0),
        number("X0 Y0", "the first point", "mm"),
        number("X1 Y1", "the last point", "mm"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _set_mesh(self, command: Command, _: Reply) -> Wait | None:
        columns, rows = command.integer("COLUMNS"), command.integer("ROWS")
        now = self._correction.correction or Correction(fade=self.fade)
        if columns == 0:
            return WaitForMoves(lambda: self._store(replace(now, mesh=None)))
        if min(columns, rows) < 2:
            raise CommandError.of(
                "command.value",
                axis="SET_BED_MESH",
                value=f"{columns} × {rows}",
                limit=f"2 to {MOST_POINTS} COLUMNS and ROWS",
            )
        x0, y0, x1, y1 = (command.value(name) for name in ("X0", "Y0", "X1", "Y1"))
        xs = tuple(round(x0 + (x1 - x0) * i / (columns - 1), 6) for i in range(columns))
        ys = tuple(round(y0 + (y1 - y0) * j / (rows - 1), 6) for j in range(rows))
        mesh = Mesh(xs, ys, ((0.0,) * columns,) * rows)
        interpolation = self._config.interpolation
        return WaitForMoves(
            lambda: self._store(replace(now, mesh=mesh, interpolation=interpolation))
        )

    def set_point(self, words: dict[str, float]) -> None:
        """Sets the height Z of the point I, J of the mesh, or adds Q to it. Raises CommandError."""
        now, mesh = self._correction.correction, self.mesh()
        assert now is not None
        i, j = int(words.get("I", -1)), int(words.get("J", -1))
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
        self.put(None if empty else correction, on=self._correction.on and not empty)

    def raise_to(self, mm: float, reply: Reply) -> None:
        """G29 S4: raises the whole mesh by this height above its measured, loaded or edited
        heights. Raises CommandError."""
        self.mesh()
        now = self._correction
        assert now.correction is not None
        self.put(now.correction.raised(mm - self._raised_mm), on=now.on, profile=self.profile)
        self._raised_mm = mm
        reply.say(f"echo:The mesh is {mm:.3f} mm higher than it was measured")

    # -- stored meshes ----------------------------------------------------------------------------

    @command(
        "BED_MESH_PROFILE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Stores the mesh under a name, loads it, or removes it. It stays on the disk, with its date"
        " and the temperature of the bed. Without parameters it lists them.",
        text("LOAD", "the name of a mesh to use"),
        text("SAVE", "the name under which the mesh is stored"),
        text("REMOVE", "the name of a mesh to delete"),
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _profile(self, command: Command, reply: Reply) -> Wait | None:
        pairs = command.pairs()
        if not pairs:
            for name, stored in sorted(self.meshes.all.items()):
                reply.say(f"// {name}: {describe(stored)}")
        if "SAVE" in pairs:
            self.save_mesh(check_name(pairs["SAVE"]))
            reply.say(f"// Bed Mesh state has been saved to profile [{pairs['SAVE']}]")
        if "REMOVE" in pairs:
            self.meshes.remove(pairs["REMOVE"])
            if self.profile == pairs["REMOVE"]:
                self.profile = ""
        if "LOAD" not in pairs:
            return None
        stored = self.meshes.named(pairs["LOAD"])
        return WaitForMoves(lambda: self.load_mesh(stored, reply))

    @command(
        "M374",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Stores the mesh under a name, as BED_MESH_PROFILE SAVE; without P as `default`.",
        rest('P"name"', "the name of the mesh, by default `default`"),
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _save(self, command: Command, reply: Reply) -> Wait | None:
        name = _file_name(command)
        self.save_mesh(name)
        reply.say(f"echo:Height map saved as {name}")
        return None

    @command(
        "M375",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Corrects by a stored mesh, as BED_MESH_PROFILE LOAD; without P by `default`.",
        rest('P"name"', "the name of the mesh, by default `default`"),
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _load(self, command: Command, reply: Reply) -> Wait | None:
        stored = self.meshes.named(_file_name(command))
        return WaitForMoves(lambda: self.load_mesh(stored, reply))

    def save_mesh(self, name: str) -> None:
        """Stores the current mesh under `name`. Raises CommandError."""
        mesh, bed_c = self.mesh(), None
        for heater, config in self._rig.machine.heaters.items():
            if config.kind == "bed":
                reading = self._rig.connection.reading(heater, self._rig.queue.board_now)
                now_c = reading.current_c
                bed_c = None if now_c is None else round(now_c, 1)
        correction = self._correction.correction
        assert correction is not None
        reference = self._config.reference
        text = f"X{reference[0]:g} Y{reference[1]:g}" if reference else "home"
        stored = StoredMesh(name, mesh, "", bed_c, text, correction.interpolation)
        self.meshes.save(stored)
        self.profile = name

    def load_mesh(self, stored: StoredMesh, reply: Reply) -> None:
        """Activates a stored mesh. Raises CommandError."""
        fade = self.fade
        correction = Correction(None, stored.mesh, stored.interpolation, fade)
        self.put(correction, on=True, profile=stored.name)
        reply.say(f"// Mesh {stored.name} is in use: {describe(stored)}")

    def setting_lines(self) -> Iterator[str]:
        """Commands that restore the correction exactly."""
        now = self._correction
        correction = now.correction or Correction()
        terms = (correction.fit or Fit()).coefficients
        pairs = zip(TERMS, terms, strict=True)
        yield "SET_BED_FIT " + " ".join(f"{k}={exact(v)}" for k, v in pairs)
        mesh = correction.mesh
        if mesh is None:
            yield "SET_BED_MESH COLUMNS=0 ROWS=0 X0=0 Y0=0 X1=0 Y1=0"
        else:
            corners = zip(
                ("X0", "Y0", "X1", "Y1"),
                (mesh.xs[0], mesh.ys[0], mesh.xs[-1], mesh.ys[-1]),
                strict=True,
            )
            area = " ".join(f"{k}={exact(v)}" for k, v in corners)
            yield f"SET_BED_MESH COLUMNS={len(mesh.xs)} ROWS={len(mesh.ys)} {area}"
            for j, row in enumerate(mesh.heights):
                for i, z in enumerate(row):
                    yield f"G29 W I{i} J{j} Z{exact(z)}"
        fade = self.fade.end_mm if self.fade else 0.0
        yield f"M420 S{int(now.on)} Z{exact(fade)}"


def _file_name(command: Command) -> str:
    """The parameter P of RepRapFirmware, a file name that ends in .csv. Raises CommandError."""
    given = _P.search(command.text)
    return check_name((given[1] or given[2]).removesuffix(".csv")) if given else DEFAULT


def describe(stored: StoredMesh) -> str:
    """A line that describes a stored mesh."""
    size = f"{len(stored.mesh.xs)} × {len(stored.mesh.ys)} points"
    warmth = "" if stored.bed_c is None else f", bed at {stored.bed_c:g} °C"
    return f"{size}, {stored.date or 'no date'}{warmth}"
