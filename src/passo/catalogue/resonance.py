"""Errors of the accelerometer and of the measurement of resonances."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _resonance(says: str, action: str) -> Entry:
    return Entry("resonance", says, action, ExitStatus.MACHINE_FAULT)


RESONANCE: Mapping[str, Entry] = {
    "resonance.silent": _resonance(
        "the accelerometer {value} at {limit} does not answer",
        "Check that it is plugged in, its supply, and the pins of [accelerometer]",
    ),
    "resonance.no-acknowledge": _resonance(
        "the accelerometer {value} at address 0x{address:02x} of {limit} does not answer: {found}",
        "Check its cable, its supply, and i2c_address in [accelerometer]: 0x18 if its pin SA0 is"
        " low, else 0x19",
    ),
    "resonance.other-chip": _resonance(
        "the chip at {limit} identifies itself as 0x{found:02x}, but {value} would be"
        " 0x{wanted:02x}",
        "Check its wires, and the key chip in [accelerometer]",
    ),
    "resonance.deaf": _resonance(
        "register 0x{register:02x} of the accelerometer {value} reads 0x{found:02x} after 0x"
        "{wanted:02x} was written",
        "Check its wires, or use shorter ones",
    ),
    "resonance.lost": _resonance(
        "{value} of {all} samples of the accelerometer were lost (limit {limit})",
        "Lower rate_hz in [accelerometer], or use a faster link for its board or shorter wires",
    ),
    "resonance.overflow": _resonance(
        "the FIFO of the accelerometer overflowed {value} times in {all} samples, of at most"
        " {limit}: the board reads it too slowly",
        "Lower rate_hz in [accelerometer], or raise i2c_hz. Many boards with Klipper's firmware use"
        " 100 kHz for I2C, which is enough for 800 samples a second",
    ),
    "resonance.still": _resonance(
        "the accelerometer measured only {value:.0f} mm/s² while its axis vibrated (minimum"
        " {limit:.0f} mm/s²)",
        "Fix it to the part that this axis moves: the head, or the bed if Y moves the bed",
    ),
    "resonance.reach": _resonance(
        "the vibration along {axis} needs {value:.1f} mm to either side of {position:g} mm, and the"
        " axis ends at {limit:g} mm",
        "Move point_mm in [accelerometer] (or POINT) towards the middle",
    ),
    "resonance.motion": _resonance(
        "the vibration cannot be made: {value}", "Lower ACCEL_PER_HZ or FREQ_END, or move POINT"
    ),
    "resonance.short": _resonance(
        "the measurement has only {value} samples (minimum {limit})",
        "Measure a wider range of frequencies, or more slowly (HZ_PER_SEC)",
    ),
    "resonance.failed": _resonance(
        "the calculation of spectra failed: {value}", "Report this text as an error of Passo"
    ),
    "resonance.no-file": _resonance(
        "{axis} could not be written: {value}", "Free space, or give another NAME"
    ),
}
