"""Checks of an eddy current probe."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.findings import Finding, table
from passo.config.klippers_firmware import runs_klippers
from passo.config.pin_names import placed, section
from passo.probes.eddy import LEAST_POINTS, EddyCurve, EddyProbe, falls

_WIRES = ("scl_pin", "sda_pin")


def check_eddy_wiring(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that the probe has a bus, on a board with Klipper's firmware."""
    probe = table(data, "probe")
    if probe.get("kind") != "eddy":
        return
    bus = probe.get("i2c_bus")
    for key in _WIRES:
        if bus is None and key not in probe:
            yield Finding("config.missing-key", ("probe", key), None, "a pin, or the key i2c_bus")
        elif bus is not None and key in probe:
            limit = "no such key: i2c_bus has the pins"
            yield Finding("config.conflict", ("probe", key), probe[key], limit)
    written = str(probe.get("scl_pin") or bus or "")
    name = placed(written)[0]
    if not runs_klippers(table(data, *section(name))):
        limit = (
            f"a kind with a pin: Passo's firmware does not read this probe. Keep Klipper's firmware"
            f' on {f"the board {name}" if name else "the main board"} (base = "klipper")'
        )
        yield Finding("config.conflict", ("probe", "kind"), "eddy", limit)


def check_calibration(probe: EddyProbe) -> Iterator[Finding]:
    """Checks that the calibration is one, and has the heights at which the probe is used."""
    points, path = probe.calibration, ("probe", "calibration")
    if not points:
        return
    if len(points) < LEAST_POINTS or not falls(points):
        limit = f"at least {LEAST_POINTS} points, whose frequencies fall with the height"
        yield Finding("config.value", path, f"{len(points)} points", limit)
        return
    low, high = EddyCurve(points).range_mm
    for key in ("trigger_height_mm", "scan_mm"):
        mm = getattr(probe, key)
        if not low < mm < high:
            limit = f"between {low:g} and {high:g}, which is the range of calibration"
            yield Finding("config.value", ("probe", key), mm, limit)
