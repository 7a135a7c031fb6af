"""Errors of probes."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _probe(says: str, action: str) -> Entry:
    return Entry("probe", says, action, ExitStatus.MACHINE_FAULT)


PROBE: Mapping[str, Entry] = {
    "probe.none": _probe("this machine has no probe", "Describe it in [probe] of the machine file"),
    "probe.paper": _probe(
        "this machine's probe is a sheet of paper, which measures nothing by itself",
        "Use MANUAL_PROBE, G29 or G32, and ACCEPT at each point",
    ),
    "probe.manual-active": _probe(
        "a paper test is under way", "Finish it with ACCEPT or ABORT, then send the command again"
    ),
    "probe.manual-idle": _probe(
        "no paper test is under way", "Start one with MANUAL_PROBE, PROBE_CALIBRATE or G29"
    ),
    "probe.no-correction": _probe(
        "the {value} mm of babysteps are not an offset of the probe: an endstop homes Z, and no bed"
        " correction with the heights of the probe is on",
        "Send Z_OFFSET_APPLY_ENDSTOP, or measure the bed first (G29, G32)",
    ),
    "probe.wrong-state": _probe(
        "the probe is {value} already before the move",
        "Move the probe away from the part, or onto it for G38.4 and G38.5",
    ),
    "probe.no-contact": _probe(
        "the probe did not change during the whole move to {position}",
        "Move it nearer first, or use G38.3 or G38.5, for which this is not an error",
    ),
    "probe.no-servo": _probe(
        "{value} needs a probe with a servo, and this machine's has none",
        "Give control_pin in [probe] of the machine file",
    ),
    "probe.not-deployed": _probe(
        "the probe did not deploy: it is {value}, and it should be {limit}",
        "Check whether something blocks it, its cables, and the pins of [probe]",
    ),
    "probe.not-stowed": _probe(
        "the probe did not stow: it is {value}, and it should be {limit}",
        "Stow it by hand before the next move, and check its cables",
    ),
    "probe.gcode-moves": _probe(
        "the G-code of {axis} moves the axes from {position} to {value}",
        "Take the moves out of it: a probe that the head fetches has the kind dock",
    ),
    "probe.no-twist": _probe(
        "{axis} needs [probe.twist.{value}], which the machine file does not have",
        "Give the places there: from_mm, to_mm and across_mm",
    ),
    "probe.out-of-reach": _probe(
        "{axis} is out of reach: with the probe at {value} the nozzle is at {position},"
        " and {limit}",
        "Move the point, or correct offset_mm of [probe]",
    ),
    "probe.triggered": _probe(
        "{axis} was not measured: the probe is triggered at {value} with the nozzle at {position},"
        " also after a lift by {limit}",
        "Check whether something touches the probe, its cable, and the ! in front of its pin",
    ),
    "probe.missed": _probe(
        "{axis} was not measured: the probe was not triggered at {value}. The nozzle descended to"
        " {position}, and the search ends at {limit}",
        "Check the cable of the probe, what M119 reports while you trigger it, and the height of"
        " the bed",
    ),
    "probe.home-missed": _probe(
        "Z is not homed: the probe was not triggered at {value} in a descent of {limit}",
        "Check the cable of the probe, and what M119 reports while you trigger it",
    ),
    "probe.early": _probe(
        "{axis} was not measured: the probe was triggered at {value} with the nozzle at {position},"
        " less than {limit} below the start of the descent",
        "Check the cable of the probe. If vibration triggers the sensor, increase settle_s",
    ),
    "probe.apart": _probe(
        "{axis} was not measured: at {value} two descents differ by {position} (limit {limit})",
        "Clean the nozzle and the bed, and check that the probe is not loose",
    ),
    "probe.unsteady": _probe(
        "{axis} was not measured: at {value} the samples differ by {position} (limit {limit})",
        "Clean the nozzle and the bed, check that the probe is not loose, or raise tolerance_mm",
    ),
    "probe.not-calibrated": _probe(
        "the eddy current probe has no calibration, so that its frequencies have no heights",
        "Home X and Y, bring the nozzle near the bed, and send PROBE_EDDY_CURRENT_CALIBRATE",
    ),
    "probe.bad-calibration": _probe(
        "the frequency of the probe falls only up to {value} above the bed, and {limit} are needed",
        "Send LDC_CALIBRATE_DRIVE_CURRENT far from the bed, and calibrate again, or lower"
        " trigger_height_mm and scan_mm",
    ),
    "probe.no-values": _probe(
        "the scan has no height of the bed with the nozzle at {value}",
        "Scan more slowly (travel_mm_s of [probe]), or with METHOD=scan; check scan_mm",
    ),
    "probe.no-scan": _probe(
        "this probe measures only by descents", "Leave METHOD out; an eddy current probe can scan"
    ),
    "probe.out-of-range": _probe(
        "the frequency of the probe, {value}, is outside of its calibration, from {limit}",
        "Measure nearer to the bed. If the bed or the coil was changed, send"
        " PROBE_EDDY_CURRENT_CALIBRATE",
    ),
    "probe.no-touch": _probe(
        "an eddy current probe does not touch, so that it cannot find a part",
        "Use a probe with a switch for G38",
    ),
    "probe.no-answer": _probe(
        "the probe at address 0x{address:02x} of {value} does not answer: {found}",
        "Check its cable, its supply, and i2c_address in [probe]",
    ),
    "probe.other-chip": _probe(
        "the chip at {value} identifies itself as 0x{found:04x}, but an LDC1612 would be"
        " 0x{wanted:04x}",
        "Check the cable of the probe, and its pins in [probe]",
    ),
    "probe.sensor": _probe(
        "the probe at {value} cannot be used: {found}",
        "Check the cable and the coil of the probe, then send LDC_CALIBRATE_DRIVE_CURRENT far from"
        " the bed",
    ),
    "probe.lost": _probe(
        "{axis} was not measured: the boards of the probe and of a motor lost their connection",
        "Check the cables of the boards, and whether other programs keep this computer busy",
    ),
}
