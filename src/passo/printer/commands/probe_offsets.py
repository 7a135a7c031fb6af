"""M851, G31 and Z_OFFSET_APPLY_PROBE: the offsets from the nozzle to the probe."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import ignored, number, rest
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.axis_slots import Z
from passo.motion.probing import Prober
from passo.printer.commands.bed_correction import BedCorrectionCommands, exact
from passo.printer.commands.probing import NO_PROBE
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.offsets import Offsets
    from passo.motion.rig import Rig

_VALUE = re.compile(r"([FTHASR])\s*([\d.]+)(?:\s*:\s*([\d.]+))?", re.ASCII)
_KEYS = {
    "T": ("travel_mm_s", 1 / 60),
    "H": ("start_mm", 1.0),
    "S": ("tolerance_mm", 1.0),
    "R": ("settle_s", 1.0),
}


class ProbeOffsetCommands:
    """The only owner of the probe offsets of one printer. A change of the trigger height changes
    the first layer exactly once: with the zero of Z if the probe homes Z, else with the active
    correction."""

    def __init__(
        self,
        rig: Rig,
        prober: Prober,
        correction: BedCorrection,
        corrections: BedCorrectionCommands,
        offsets: Offsets,
    ) -> None:
        self._rig, self._prober, self._correction = rig, prober, correction
        self._corrections, self._offsets = corrections, offsets
        homing = rig.machine.homing.get("z")
        self._homes_z = homing is not None and homing.probe
        self._measures_bed = rig.machine.levelling.reference is None and not self._homes_z

    @command(
        "M851",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the place of the probe from the nozzle. Z is below 0 if the probe triggers while the"
        " nozzle is above the bed. Without parameters it reports them.",
        number("X Y", "the place of the probe", "mm", -300, 300),
        number("Z", "the height, below 0 if it triggers above the bed", "mm", -20, 20),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _probe_offset(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(f"  {self.line()} ; (mm)")
            return None
        return WaitForMoves(lambda: self.set_offsets(words))

    def set_offsets(self, words: dict[str, float], *, faded: bool = False) -> None:
        """Sets the offsets of M851, mm: X and Y from the nozzle to the probe, and Z, the negative
        trigger height. What was measured with the earlier height is adjusted: the active
        correction (see BedCorrectionCommands.raise_by for `faded`), or the zero of Z if the probe
        has homed it. No motor moves. Raises CommandError without any change."""
        prober = self._prober
        for letter, value in words.items():
            most = 20.0 if letter == "Z" else 300.0
            if abs(value) > most:
                raise CommandError.bad_value(letter, value, f"-{most:g} to {most:g} mm")
        dx, dy = prober.offset_mm
        # A lower trigger height means that the bed is higher.
        higher = prober.trigger_height_mm + words.get("Z", -prober.trigger_height_mm)
        if higher and self._measures_bed:
            self._corrections.raise_by(higher, faded=faded)
        elif higher and self._homes_z and Z not in self._rig.job.locked_axes:
            self._rig.job.axes.set_position([(Z, self._rig.job.machine_position[Z] - higher)])
        prober.offset_mm = words.get("X", dx), words.get("Y", dy)
        prober.trigger_height_mm = -words.get("Z", -prober.trigger_height_mm)

    @command(
        "G31",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As M851 in RepRapFirmware's words: Z is the height of the nozzle at which the probe"
        " triggers.",
        number("X Y", "the place of the probe", "mm", -300, 300),
        number("Z", "the height at which the probe triggers", "mm", -20, 20),
        ignored("P T"),
        kind=Kind.PROBED,
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
        return WaitForMoves(lambda: self.set_offsets(turned))

    @command(
        "M558",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets until a restart how the probe measures: speeds of the first and of the measured"
        " descents (F300:120), of travel (T), start height (H), samples (A), what they may differ"
        " (S), pause before a descent (R). Without parameters it reports them.",
        rest(
            "F(mm/min) T(mm/min) H(mm) A S(mm) R(s)",
            "speeds, start height, number of samples, what they may differ, pause",
        ),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _measuring(self, command: Command, reply: Reply) -> Wait | None:
        found = {m[1]: (float(m[2]), m[3]) for m in _VALUE.finditer(command.text.upper())}
        values: dict[str, float] = {}
        for letter, (value, second) in found.items():
            if letter == "F":
                values["fast_mm_s"] = value / 60
                values["slow_mm_s"] = float(second or value) / 60
            elif letter == "A":
                values["samples"] = int(value)
            elif letter in _KEYS:
                key, scale = _KEYS[letter]
                values[key] = value * scale
        if values:
            self._prober.change(values)
            return None
        probe = self._prober.probe
        reply.say(
            f"Z probe 0: type {self._prober.kind}, dive height {probe.start_mm:.1f}mm, probe speed"
            f" {60 * probe.fast_mm_s:.0f}:{60 * probe.slow_mm_s:.0f}mm/min, travel speed"
            f" {60 * probe.travel_mm_s:.0f}mm/min, max taps {probe.samples}, tolerance"
            f" {probe.tolerance_mm:.3f}mm, recovery time {probe.settle_s:.2f} sec"
        )
        return None

    @command(
        "Z_OFFSET_APPLY_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Makes the babysteps of Z (M290, SET_GCODE_OFFSET) part of the trigger height of the probe,"
        " and of the correction in force or, if the probe homes Z, of its zero. No motor moves."
        " M500 stores it.",
        kind=Kind.SERVED,
        lacks=NO_PROBE,
    )
    def _apply(self, _: Command, reply: Reply) -> Wait | None:
        return WaitForMoves(lambda: self._apply_babysteps(reply))

    def _apply_babysteps(self, reply: Reply) -> None:
        by = self._offsets.babysteps_mm["z"]
        if by == 0:
            reply.say("// Nothing to do: Z Offset is 0")
            return
        if not self.holds_babysteps:
            raise CommandError.of("probe.no-correction", value=f"{by:.3f}")
        before, job = self._prober.trigger_height_mm, self._rig.job
        z = job.machine_position[Z]
        # Where the correction has faded out, later layers need the babysteps too.
        self.set_offsets({"Z": -round(before - by, 6)}, faded=True)
        # Z of the machine has changed with the zero or the correction; that of the program stays.
        job.plan.absorb_shift(Z, z - job.machine_position[Z])
        job.modes.keep_offset(Z, self._offsets.absorbed("z"))
        after = self._prober.trigger_height_mm
        reply.say(f"// z_offset: {before:.3f} -> {after:.3f}")
        held = "the zero of Z" if self._homes_z else "the correction of the bed"
        lower = "lower" if by < 0 else "higher"
        reply.say(f"// The nozzle stays {abs(by):.3f} mm {lower}, now by {held}")

    @property
    def holds_babysteps(self) -> bool:
        """Whether the trigger height of the probe decides where the nozzle prints, so that
        Z_OFFSET_APPLY_PROBE can store babysteps: it homes Z, or its correction is on."""
        return self._homes_z or (self._measures_bed and self._correction.on)

    @property
    def zero_below_trigger_mm(self) -> float:
        """How far below a trigger of the probe Z counts as 0, mm: the trigger height if the probe
        homes Z. 0 if an endstop does: the trigger height does not change what Z counts."""
        return self._prober.trigger_height_mm if self._homes_z else 0.0

    def line(self) -> str:
        """M851 with the current values."""
        dx, dy = self._prober.offset_mm
        return f"M851 X{exact(dx)} Y{exact(dy)} Z{exact(-self._prober.trigger_height_mm + 0.0)}"
