"""TEST_RESONANCES, SHAPER_CALIBRATE and the commands of the accelerometer."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.shapers import Impulses, impulses
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, flag, ignored, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.resonance_test import Direction, ResonanceTest, direction
from passo.printer.commands.motion_filters import Shaper
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure
from passo.resonance.analysis import Analysis, analyse
from passo.resonance.excitation import Excitation

if TYPE_CHECKING:
    from passo.config.accelerometer import Accelerometer
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State
    from passo.resonance.measurement import Measurement

NO_ACCELEROMETER = "The machine file has no [accelerometer]."
_NUMPY = "numpy"  # calculates the spectra
_QUERY_S, _NOISE_S = 0.5, 2.0
_NAME = re.compile(r"[A-Za-z0-9_-]+")
_OUTPUTS = ("resonances", "raw_data")
_LEAST_SHARE = 0.2  # of the motors' acceleration: a chip that feels less is not on the moved part
_Z = Excitation(end_hz=100.0, accel_per_hz=15.0, sweep_accel_mm_s2=50.0)
_SWEEP = (
    number("FREQ_START", "the first frequency", "Hz", 1, 299),
    number("FREQ_END", "the last frequency", "Hz", 2, 300),
    number("ACCEL_PER_HZ", "the acceleration for each hertz", "mm/s²", 1, 500),
    number("HZ_PER_SEC", "how fast the frequency rises", "Hz/s", 0.1, 2),
    text("POINT", "X,Y,Z of the nozzle in mm"),
)


class ResonanceCommands:
    """The accelerometer `part` of one printer."""

    def __init__(
        self, rig: LiveRig, state: State, part: Accelerometer, test: ResonanceTest
    ) -> None:
        self._rig, self._state, self._part, self._test = rig, state, part, test

    @command(
        "ACCELEROMETER_QUERY",
        Subject.SPEED,
        When.EXCLUSIVE,
        "Reports what the accelerometer measures, in mm/s2: at rest about 9800 along Z, the gravity"
        " of the earth.",
        kind=Kind.SERVED,
        lacks=NO_ACCELEROMETER,
    )
    def _query(self, _: Command, reply: Reply) -> Wait | None:
        async def run() -> None:
            found = await self._test.still(_QUERY_S)
            values = ", ".join(f"{value:.6f}" for value in found.samples()[-1])
            reply.say(f"// accelerometer values (x, y, z): {values}")

        return WaitForProcedure(run)

    @command(
        "MEASURE_AXES_NOISE",
        Subject.SPEED,
        When.EXCLUSIVE,
        "Measures the noise of the accelerometer at rest: 1 to 100 is usual, 1000 and more is a"
        " fault, such as a fan that shakes it.",
        kind=Kind.SERVED,
        lacks=NO_ACCELEROMETER,
        package=_NUMPY,
    )
    def _noise(self, _: Command, reply: Reply) -> Wait | None:
        async def run() -> None:
            found = await self._test.still(_NOISE_S)
            x, y, z = (await analyse(found)).noise
            reply.say(f"// Axes noise: {x:.6f} (x), {y:.6f} (y), {z:.6f} (z)")

        return WaitForProcedure(run)

    @command(
        "TEST_RESONANCES",
        Subject.SPEED,
        When.EXCLUSIVE,
        "Vibrates the head along AXIS (X, Y, Z, or a direction such as 1,-1) with rising frequency,"
        " and writes the spectrum as CSV and as a picture (OUTPUT=resonances), or each sample"
        " (raw_data), or both. Shapers are off, unless INPUT_SHAPING=1.",
        text("AXIS", "X, Y, Z or a direction such as 1,-1"),
        text("OUTPUT", "resonances, raw_data or both"),
        text("NAME", "the name of the files"),
        *_SWEEP,
        flag("INPUT_SHAPING", "with the shapers"),
        ignored("CHIPS"),
        kind=Kind.SERVED,
        lacks=NO_ACCELEROMETER,
        package=_NUMPY,
    )
    def _measure(self, command: Command, reply: Reply) -> Wait | None:
        along = direction(command.string("AXIS"))
        given = command.string("OUTPUT", "resonances")
        outputs = [text.strip().lower() for text in given.split(",")]
        if not outputs or not set(outputs) <= {*_OUTPUTS}:
            limit = "resonances, raw_data or both"
            raise CommandError.of("command.value", axis="OUTPUT", value=given, limit=limit)
        excitation, point = self._sweep(along, command), self._point(command)
        shapes, name = command.flag("INPUT_SHAPING"), _named(command)

        async def run() -> None:
            found = await self._vibrate(along, excitation, point, shapes, reply)
            raw, spectrum = (
                _path(stem, along, name) if stem in outputs else ""
                for stem in ("raw_data", "resonances")
            )
            done = await analyse(
                found,
                title=f"Resonances of {along.name.upper()}",
                least_mm_s2=_LEAST_SHARE * excitation.rms_mm_s2,
                raw=raw,
                spectrum=spectrum,
            )
            reply.say(f"// Highest peak at {done.peak_hz:.1f} Hz")
            _tell_files(done, reply)

        return WaitForProcedure(run)

    @command(
        "SHAPER_CALIBRATE",
        Subject.SPEED,
        When.EXCLUSIVE,
        "Measures X and Y (or AXIS), chooses the input shaper for each, says why, and uses it. M500"
        " or SAVE_CONFIG stores it; U=1 does so at once.",
        choice("AXIS", "the axis, by default X and Y", "X", "Y", "Z"),
        text("NAME", "the name of the files"),
        number("MAX_SMOOTHING", "how much a shaper may smooth", "mm", 0.05, 10),
        *_SWEEP,
        flag("U", "stores the result"),
        kind=Kind.SERVED,
        lacks=NO_ACCELEROMETER,
        package=_NUMPY,
    )
    def _calibrate(self, command: Command, reply: Reply) -> Wait | None:
        axes = [command.string("AXIS").lower()] if command.has("AXIS") else ["x", "y"]
        along = [direction(axis) for axis in axes]
        sweeps = [self._sweep(one, command) for one in along]
        most = command.value("MAX_SMOOTHING", None) or self._part.max_smoothing_mm
        store = command.flag("U")
        point, name = self._point(command), _named(command)

        async def run() -> None:
            for one, sweep in zip(along, sweeps, strict=True):
                found = await self._vibrate(one, sweep, point, False, reply)
                least_mm_s2 = _LEAST_SHARE * sweep.rms_mm_s2
                # At once, so that the first axis is done even if the second cannot be measured.
                shaper = await self._fit(one, found, least_mm_s2, most, name, reply)
                self._rig.commands.filters.use_shapers({one.name.upper(): shaper})
            if store and self._state.stores:
                self._state.store_settings()
                reply.say("// The shapers are in use and stored")
            else:
                reply.say("// The shapers are in use. M500 or SAVE_CONFIG stores them")

        return WaitForProcedure(run)

    async def _fit(
        self,
        along: Direction,
        found: Measurement,
        least_mm_s2: float,
        max_smoothing_mm: float | None,
        name: str,
        reply: Reply,
    ) -> Shaper:
        """The shaper for what was measured along an axis."""
        axis = along.name
        reply.say(f"// Calculating the best input shaper parameters for {axis} axis")
        done = await analyse(
            found,
            title=f"Input shapers for {axis.upper()}",
            least_mm_s2=least_mm_s2,
            shapers=_path("calibration_data", along, name),
            max_smoothing_mm=max_smoothing_mm,
        )
        best = done.best
        assert best is not None  # as it was asked for
        for fit in done.fits:
            reply.say(f"// {fit.line}")
            reply.say(
                f"// To avoid too much smoothing with '{fit.kind}', suggested max_accel <="
                f" {round(fit.max_accel_mm_s2, -2):.0f} mm/sec^2"
            )
        reply.say(
            f"// Recommended shaper_type_{axis} = {best.kind}, shaper_freq_{axis} ="
            f" {best.frequency_hz:.1f} Hz"
        )
        reply.say(f"// {done.reason}")
        _tell_files(done, reply)
        return Shaper(best.kind, round(best.frequency_hz, 1))

    async def _vibrate(
        self,
        along: Direction,
        excitation: Excitation,
        point: Sequence[float],
        shapes: bool,
        reply: Reply,
    ) -> Measurement:
        await self._test.go_to(point)
        reply.say(
            f"// Testing axis {along.name}: {excitation.start_hz:g} to {excitation.end_hz:g} Hz in"
            f" {excitation.seconds:.0f} s"
        )
        return await self._test.vibrate(along, excitation, self._shapers() if shapes else {})

    def _shapers(self) -> dict[str, Impulses]:
        return {
            axis.lower(): impulses(shaper.kind, shaper.frequency_hz, shaper.damping)
            for axis, shaper in self._rig.commands.filters.shapers.items()
            if shaper.frequency_hz > 0
        }

    def _sweep(self, along: Direction, command: Command) -> Excitation:
        """The excitation of a direction with the parameters of a command. Raises CommandError."""
        usual = _Z if along.z else Excitation(accel_per_hz=self._part.accel_per_hz)
        low = command.value("FREQ_START", usual.start_hz)
        high = command.value("FREQ_END", usual.end_hz)
        if high < low + 1:
            raise CommandError.bad_value("FREQ_END", high, f"{low + 1:g} to 300 Hz")
        return replace(
            usual,
            start_hz=low,
            end_hz=high,
            accel_per_hz=command.value("ACCEL_PER_HZ", usual.accel_per_hz),
            hz_per_s=command.value("HZ_PER_SEC", usual.hz_per_s),
        )

    def _point(self, command: Command) -> Sequence[float]:
        """X, Y and Z of the nozzle for a measurement, mm. Raises CommandError."""
        if command.has("POINT"):
            given = command.string("POINT")
            try:
                point = [float(part) for part in given.split(",")]
            except ValueError:
                point = []
            if len(point) != 3 or not all(map(isfinite, point)):
                shown = given[:30]
                raise CommandError.of(
                    "command.value", axis="POINT", value=shown, limit="X,Y,Z in mm"
                )
            return point
        machine = self._rig.machine
        return self._part.point_of(machine.bed_area_mm, machine.axes["z"].max_mm)


def _named(command: Command) -> str:
    """The name of the files. Raises CommandError."""
    name = command.string("NAME", f"{datetime.now():%Y%m%d_%H%M%S}")
    if not _NAME.fullmatch(name):
        limit = "letters, digits, - and _"
        raise CommandError.of("command.value", axis="NAME", value=name or "missing", limit=limit)
    return name


def _path(stem: str, along: Direction, name: str) -> str:
    """The path of a file without its ending, where Klipper's tools look for it."""
    return str(Path(tempfile.gettempdir()) / f"{stem}_{along.name}_{name}")


def _tell_files(done: Analysis, reply: Reply) -> None:
    for file in done.files:
        reply.say(f"// Written: {file}")
