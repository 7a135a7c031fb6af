"""Plays the output of Klipper's batch mode on the simulated printer, so that it is measured like a
print of Passo."""

from __future__ import annotations

import os
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from passo import _core
from passo.board.dictionary import Dictionary, DictionaryError
from passo.config.simulated_motion import simulated_masses
from passo.errors import InputError
from passo.job.batch.quality_watch import Measurement, quality_of, shown_corner
from passo.motion.endstops import motors_of_actuators, motors_of_extruders

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_FITS = 0.02  # the ranges of a motor in two prints of one file differ at most by this fraction
_FITS_UNITS = 1.0  # or by this, mm or degrees


class RecordedStream:
    """The output of Klipper's batch mode: the file that `klippy.py` wrote with `-o`, and the data
    dictionary that it read with `-d`."""

    def __init__(
        self, path: str | os.PathLike[str], dictionary: str | os.PathLike[str] | None = None
    ) -> None:
        """Without a dictionary, it is the file of the same name that ends in `.dict`. Raises
        InputError if one of them is unreadable, or the stream does not fit the dictionary."""
        self.name = os.fspath(path)
        data = _read(path)
        given = Path(self.name).with_suffix(".dict") if dictionary is None else Path(dictionary)
        raw = _read(given)
        try:
            packed = zlib.compress(raw) if raw.lstrip().startswith(b"{") else raw
            known = Dictionary.parse(packed)
            self._hz = known.number("CLOCK_FREQ")
        except DictionaryError as error:
            raise InputError.of("input.stream-dictionary", str(given), value=str(error)) from None
        if self._hz <= 0:
            raise InputError.of("input.stream-dictionary", str(given), value="it has no CLOCK_FREQ")
        try:
            formats = _core.Formats(list(known.commands))
            self._recording = _core.StepRecording(formats, data)
        except ValueError as error:
            raise InputError.of("input.stream", self.name, value=str(error)) from None

    def play(
        self,
        machine: MachineConfig,
        measured: _core.PrintQuality,
        steps: dict[str, int],
        corner: int | None,
    ) -> Measurement:
        """Measures the stream on this machine against the path of a print without filters, which
        `measured` has kept; `steps` are the steps of each motor in that print. Only the last part
        of the stream, with the same number of steps, is measured, so that Klipper's homing is left
        out. Motors are matched by their order: those of the geometry, then the extruders; or, if
        the stream has as many as the machine file, in the order of that file. Raises InputError if
        the stream is not one of this file on this machine."""
        motors = self._motors(machine, measured, steps)
        masses = simulated_masses(machine.geometry.kind, machine.simulated.masses)
        x, y, z = ((mass.frequency_hz, mass.damping) for mass in masses)
        quality, lasts_s, commands = self._recording.measure(
            measured,
            float(self._hz),
            machine.geometry.spec(),
            (x, y, z),
            [machine.simulated.nozzle_pressure_s] * len(machine.extruders),
            motors,
            corner,
        )
        total = sum(kept for _, kept, _, _ in motors)
        return Measurement(quality_of(quality), shown_corner(quality), lasts_s, total, commands)

    def _motors(
        self, machine: MachineConfig, measured: _core.PrintQuality, steps: dict[str, int]
    ) -> list[tuple[int, int, float, float]]:
        """For each motor of an actuator and then of an extruder: its index in the stream, its
        number of last steps that count, mm or degrees per step, and its position before these."""
        names = motors_of_actuators(machine) + motors_of_extruders(machine)
        count = len(self._recording.motors)
        order = names if count == len(names) else tuple(machine.steppers)
        if count != len(order):
            raise InputError.of(
                "input.stream-motors",
                self.name,
                value=count,
                limit=len(names),
            )
        ranges = _core.actuator_ranges(measured, machine.geometry.spec())
        motors = list[tuple[int, int, float, float]]()
        for number, name in enumerate(names):
            index = order.index(name)
            scale = machine.steppers[name].steps_per_unit
            made = self._recording.motors[index][1]
            # advance adds steps, and homing moves no extruder
            kept = min(steps[name], made) if number < len(ranges) else made
            net, lowest, highest = self._recording.range(index, kept)
            if number >= len(ranges):  # an extruder, which pushes more than it pulls
                motors.append((index, kept, (1 if net >= 0 else -1) / scale, 0.0))
                continue
            _, end, low, high = ranges[number]
            to_end = [(lowest - net) / scale, (highest - net) / scale]
            wanted = [low - end, high - end]
            sign = min((1, -1), key=lambda s: _apart(sorted(s * at for at in to_end), wanted))
            found = sorted(sign * at for at in to_end)
            if _apart(found, wanted) > max(_FITS_UNITS, _FITS * (high - low)):
                raise InputError.of(
                    "input.stream-path",
                    self.name,
                    axis=name,
                    value=found[1] - found[0],
                    limit=high - low,
                )
            motors.append((index, kept, sign / scale, end - sign * net / scale))
        return motors


def _apart(found: Sequence[float], wanted: Sequence[float]) -> float:
    return max(abs(a - b) for a, b in zip(found, wanted, strict=True))


def _read(path: str | os.PathLike[str]) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise InputError.of(
            "input.unreadable", os.fspath(path), value=error.strerror or str(error)
        ) from None
