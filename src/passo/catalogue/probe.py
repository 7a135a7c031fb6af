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
        "no correction of the bed follows the probe, which could take over the {value} mm",
        "Measure the bed first (G29, G32), or set the offset of home (M206 Z)",
    ),
    "probe.wrong-state": _probe(
        "the probe is {value} before the move that should change that",
        "Move the probe away from the part, or onto it for G38.4 and G38.5",
    ),
    "probe.no-contact": _probe(
        "the probe did not change down the whole move, to {position}",
        "Move it nearer first; G38.3 and G38.5 take this for no error",
    ),
    "probe.no-servo": _probe(
        "{value} needs a probe with a servo, and this machine's has none",
        "Give control_pin in [probe] of the machine file",
    ),
    "probe.not-deployed": _probe(
        "the probe does not get to the bed: it is {value}, and it should be {limit}",
        "Look whether something blocks it, at its cables, and at the pins of [probe]",
    ),
    "probe.not-stowed": _probe(
        "the probe does not get away from the bed: it is {value}, and it should be {limit}",
        "Bring it away by hand before the next move, and look at its cables",
    ),
    "probe.out-of-reach": _probe(
        "{axis} is out of reach: with the probe at {value} the nozzle is at {position},"
        " and {limit}",
        "Move the point, or correct offset_mm of [probe]",
    ),
    "probe.triggered": _probe(
        "{axis} was not measured: the probe is triggered at {value} with the nozzle at {position},"
        " also after a lift by {limit}",
        "Look whether something touches the probe, at its cable, and at the ! in front of its pin",
    ),
    "probe.missed": _probe(
        "{axis} was not measured: the probe was not triggered at {value} down to {limit} of the"
        " nozzle, which was at {position}",
        "Look at the cable of the probe, at what M119 reports while you trigger it, and at the"
        " height of the bed",
    ),
    "probe.home-missed": _probe(
        "Z is not homed: the probe was not triggered at {value} in a descent of {limit}",
        "Look at the cable of the probe, and at what M119 reports while you trigger it",
    ),
    "probe.early": _probe(
        "{axis} was not measured: the probe was triggered at {value} with the nozzle at {position},"
        " less than {limit} below the start of the descent",
        "Look at the cable of the probe; a sensor that is shaken needs settle_s",
    ),
    "probe.apart": _probe(
        "{axis} was not measured: at {value} two descents differ by {position}, of at most {limit}",
        "Clean the nozzle and the bed, and look whether the probe is loose",
    ),
    "probe.unsteady": _probe(
        "{axis} was not measured: at {value} the samples differ by {position}, of at most {limit}",
        "Clean the nozzle and the bed, look whether the probe is loose, or raise tolerance_mm",
    ),
    "probe.lost": _probe(
        "{axis} was not measured: the boards of the probe and of a motor lost each other",
        "Look at the cables of the boards, and at how busy this computer is",
    ),
}
