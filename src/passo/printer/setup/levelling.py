"""Builds the parts that level the bed and calibrate the geometry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from passo.geometry.skewable import SkewableModel
from passo.levelling.areas import Area
from passo.levelling.mesh_files import MeshStore
from passo.printer.commands.axis_twist import AxisTwistCommands
from passo.printer.commands.bed_correction import BedCorrectionCommands
from passo.printer.commands.bed_screws import ScrewCommands
from passo.printer.commands.delta_calibration import DeltaCommands, is_calibrated
from passo.printer.commands.eddy import EddyCommands
from passo.printer.commands.endstop_offsets import EndstopCommands
from passo.printer.commands.levelling import LevellingCommands
from passo.printer.commands.manual_probe import ManualProbe
from passo.printer.commands.probe_deployment import ProbeDeploymentCommands
from passo.printer.commands.probe_moves import ProbeMoveCommands
from passo.printer.commands.probe_offsets import ProbeOffsetCommands
from passo.printer.commands.probing import ProbeCommands
from passo.printer.commands.skew import SkewCommands
from passo.printer.commands.z_motors import EndstopOffsets, ZMotorCommands, has_endstops
from passo.printer.live_rig import LiveRig
from passo.printer.setup.motion import Motion
from passo.probes.eddy import EddyProbe


@dataclass(frozen=True, slots=True)
class Levelling:
    """The levelling of one printer: `bed` has its points and mesh, `correction` the bed correction.
    What the machine does not have is None."""

    bed: LevellingCommands
    correction: BedCorrectionCommands
    manual_probe: ManualProbe
    delta: DeltaCommands | None
    z_endstops: EndstopOffsets | None
    gantry: ZMotorCommands | None
    screws: ScrewCommands | None
    skew: SkewCommands | None
    twist: AxisTwistCommands | None
    eddy: EddyCommands | None
    handlers: list[object]  # the parts that handle commands


def build_levelling(
    rig: LiveRig, motion: Motion, meshes: MeshStore, printed_area: Callable[[], Area | None]
) -> Levelling:
    """Builds the levelling of a connected machine. `meshes` are its stored meshes; `printed_area`
    gives the area that the print covers, mm, if it is known."""
    machine, config = rig.machine, rig.machine.levelling
    prober = motion.prober
    correction = BedCorrectionCommands(rig, motion.correction, meshes)
    offsets = ProbeOffsetCommands(rig, prober, motion.correction, correction, motion.offsets)
    manual = ManualProbe(prober, motion.correction, offsets)
    bed = LevellingCommands(
        *(rig, prober, motion.correction, correction, offsets, manual, motion.predefined),
        printed_area,
    )
    delta = None
    if is_calibrated(machine):
        delta = DeltaCommands(rig, prober, motion.correction, manual)
    z_endstops = EndstopOffsets(rig) if has_endstops(machine) else None
    skew = SkewCommands(rig) if isinstance(machine.geometry, SkewableModel) else None
    gantry = screws = twist = eddy = None
    handlers: list[object] = []
    if machine.probe is not None:
        handlers += [ProbeCommands(rig, prober), bed, correction, ProbeDeploymentCommands(prober)]
        handlers += [offsets, manual, ProbeMoveCommands(rig, prober)]
        if prober.twist:
            twist = AxisTwistCommands(prober, manual)
        if isinstance(machine.probe, EddyProbe):
            eddy = EddyCommands(machine.probe, prober, manual, offsets)
        if config.motors is not None:
            gantry = ZMotorCommands(
                rig,
                config.motors,
                prober,
                motion.correction,
                motion.triggered,
                motion.lone_motors,
                z_endstops,
            )
        if config.screws is not None:
            screws = ScrewCommands(config.screws, prober, manual)
    elif delta is not None:
        handlers.append(manual)
    if delta is not None or z_endstops is not None:
        handlers.append(EndstopCommands(delta, z_endstops))
    handlers += [part for part in (delta, gantry, screws, skew, twist, eddy) if part is not None]
    return Levelling(
        bed, correction, manual, delta, z_endstops, gantry, screws, skew, twist, eddy, handlers
    )
