"""Errors of bed correction and of calibration."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _levelling(says: str, action: str) -> Entry:
    return Entry("levelling", says, action, ExitStatus.BAD_INPUT)


LEVELLING: Mapping[str, Entry] = {
    "levelling.no-points": _levelling(
        "the machine file has no enabled points to measure", "Add points to [levelling]"
    ),
    "levelling.no-area": _levelling(
        "the machine file has no area to measure", "Add area to [levelling], or another method"
    ),
    "levelling.none": _levelling(
        "the bed was not measured, and no correction is stored", "Measure it (G29 or G32)"
    ),
    "levelling.no-mesh": _levelling(
        "the correction of the bed is a surface, not a mesh",
        'Set [levelling] method = "mesh", and measure the bed (G29)',
    ),
    "levelling.too-much": _levelling(
        "the bed would be corrected by {value} mm (max_correction_mm is {limit} mm)",
        "Adjust the bed or its endstop, and measure it again",
    ),
    "levelling.too-steep": _levelling(
        "the correction would rise by {value} mm per mm (max_slope is {limit})",
        "Adjust the bed, and measure it again",
    ),
    "levelling.few-points": _levelling(
        "{value} points are too few for the {method} correction: at least {limit} are needed",
        "Enable or add points of [levelling]",
    ),
    "levelling.close-points": _levelling(
        "points {first} and {second} are {value:.3f} mm apart and count as one: at least {limit:g}"
        " mm are needed",
        "Move or remove one of them",
    ),
    "levelling.line": _levelling(
        "the {value} points are too close to one line: they deviate from it by {deviation:.3f}"
        " mm, and at least {limit:g} mm are needed",
        "Move points, so that they surround the bed",
    ),
    "levelling.conic": _levelling(
        "the {value} points are on one conic (a circle, for example): they determine only {rank} of"
        " {limit} coefficients",
        "Add a point in the middle, or use the linear correction",
    ),
    "levelling.no-height": _levelling(
        "the height at point {place} is {value}, not a finite number", "Probe the bed again"
    ),
    "levelling.mesh-size": _levelling(
        "the mesh has {value}: expected {limit}", "Give a height for each point, or probe again"
    ),
    "levelling.uneven": _levelling(
        "{axis} {value:g} is not on the even grid of the mesh: expected {limit:g} mm",
        "Give points at even distances, in ascending order",
    ),
    "levelling.empty-area": _levelling(
        "no point of the grid is within {value:g} mm of its middle", "Give a larger radius"
    ),
    "levelling.outside-job": _levelling(
        "the job covers {value}, outside of the mesh: {limit}",
        "Move the objects onto the mesh, or probe the whole bed",
    ),
    "levelling.bad-area": _levelling(
        "the area {value} is empty", "Give its lower corner first: [x0, y0, x1, y1]"
    ),
    "levelling.overlap": _levelling(
        "the areas to avoid {value} and {limit} overlap", "Make one area of both"
    ),
    "levelling.all-avoided": _levelling(
        "point {value} lies in the area to avoid {limit}, and no place around it is on the mesh",
        "Make the area smaller, or the mesh larger",
    ),
    "levelling.fade": _levelling(
        "the correction fades over {value:g} mm, but the bed differs by {limit:.3f} mm: the fade"
        " must be longer than that",
        "Let the fade end higher (M420 Z), or adjust the screws of the bed",
    ),
    "levelling.motor-adjustment": _levelling(
        "motor {axis} would move {value:.3f} mm relative to another motor: at most {limit:g} mm are"
        " allowed",
        "Level the gantry by hand, check the pivots, or raise max_adjust_mm",
    ),
    "levelling.motor-order": _levelling(
        "the adjustment made the tilt worse: the points differ by {value:.3f} mm, before it by"
        " {limit:.3f} mm. Probably the Z motors {order} are in another order",
        "Compare the order of motors and pivots; move one motor and see which corner rises",
    ),
    "levelling.motor-retries": _levelling(
        "the motors of Z still tilt by {value:.4f} mm after {times} adjustments: at most {limit:g}"
        " mm are allowed",
        "Look for play in the gantry and the probe (M48), or raise tolerance_mm",
    ),
    "levelling.no-screw": _levelling(
        "no screw of the bed is being adjusted",
        "Begin with BED_SCREWS_ADJUST; a paper test ends with ACCEPT or ABORT",
    ),
    "levelling.screws": _levelling(
        "the screws of the bed differ by {value:.3f} mm: at most {limit:g} mm are allowed",
        "Turn the screws as reported, then measure again",
    ),
    "levelling.skew-limits": _levelling(
        "skew moves a carriage beyond its axis: {axis} of the machine file is {value}, expected"
        " {limit}",
        "Set it in the machine file, and send RESTART",
    ),
    "levelling.skew": _levelling(
        "no parallelogram has the lengths {value} of AC, BD and AD",
        "Measure both diagonals and the side AD of the printed square again",
    ),
    "levelling.delta-rods": _levelling(
        "the lengths of rods cannot be found from heights alone: measured distances are needed",
        "Calibrate 6 factors, or give distances of a print",
    ),
    "levelling.delta-points": _levelling(
        "the {value} measurements determine {rank} of {limit} parameters",
        "Probe more points, in the middle and around the bed",
    ),
    "levelling.delta-nowhere": _levelling(
        "the calibration leads to a delta that cannot reach the probed points: {value}",
        "Correct radius, rods and endstops of the machine file, then calibrate again",
    ),
    "levelling.delta-worse": _levelling(
        "the calibration makes the deviation of the points worse: {value:.4f} mm rms, before it"
        " {limit:.4f} mm",
        "The old parameters stay. Check the probe, then calibrate again",
    ),
    "levelling.delta-change": _levelling(
        "{axis} would change from {before:.4f} to {value:.4f}: at most {limit:g} {unit} are"
        " allowed",
        "The old parameters stay. Correct the machine file, or check the probe",
    ),
    "levelling.mesh-name": _levelling(
        "{value!r} cannot be the name of a mesh",
        "Use at most 40 letters, digits, dots, dashes and underscores; begin with a letter or"
        " digit",
    ),
    "levelling.mesh-unreadable": _levelling(
        "the stored mesh cannot be read", "Remove the file, and measure the bed again"
    ),
    "levelling.mesh-unwritable": _levelling(
        "the mesh cannot be stored: {value}",
        "Free space on the disk, or correct the permissions of the folder",
    ),
    "levelling.mesh-file": _levelling(
        "holds {value!r} in a mesh: expected {limit}",
        "Probe the bed again, or restore the file",
    ),
}
