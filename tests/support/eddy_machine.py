"""i3-probe with an eddy current probe on a board with Klipper's firmware, calibrated like the
simulated coil."""

from __future__ import annotations

from math import exp

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig
from passo.printer.setup.simulated_world import simulated_bed

_SWITCH = 'kind = "fixed"\npin = "^Z_MAX"'
_HOME = 'direction = "min"\nposition = 0.0\npin = "^Z_MIN"\nfast = 5.0\nslow = 1.0\n'
_HEAD = '\n[boards.head]\nbase = "klipper"\nclock_hz = 12_000_000\n'
HEIGHTS_MM = [round(0.05 + 0.1 * i, 2) for i in range(45)]


def hertz(mm: float) -> float:
    """The frequency of the simulated coil at 25 °C."""
    return 3_218_000 + 68_000 * exp(-mm / 2.2)


def eddy_text(calibration: str | None = None, more: str = "", *, homes_z: bool = True) -> str:
    """The machine file; `more` are further lines of the probe."""
    if calibration is None:
        rows = ", ".join(f"{{ mm = {mm}, hz = {hertz(mm):.3f} }}" for mm in HEIGHTS_MM)
        calibration = f"calibration = [{rows}]"
    probe = f'kind = "eddy"\nscl_pin = "head:gpio1"\nsda_pin = "head:gpio2"\n{more}{calibration}'
    text = shipped_text("i3-probe")
    for old, new in (
        (_SWITCH, probe),
        ("trigger_height_mm = 1.2", "trigger_height_mm = 2.0"),
        (_HOME, 'direction = "min"\nprobe = true\n' if homes_z else _HOME),
    ):
        assert old in text, old
        text = text.replace(old, new)
    return text + _HEAD


def eddy_machine(calibration: str | None = None, more: str = "") -> MachineConfig:
    """The machine."""
    return load_text(eddy_text(calibration, more))


def bed_mm(machine: MachineConfig, x: float, y: float) -> float:
    """The height of the simulated bed, as Z of the plan: 0 where the probe homes."""
    shape = simulated_bed(machine).shape
    return shape.height(x, y) - shape.height(*machine.probe_home_mm)
