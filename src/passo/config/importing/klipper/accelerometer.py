"""[adxl345], [lis2dw] and [resonance_tester]."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.numbers import number_of
from passo.config.pin_names import named_on, placed
from passo.config.pin_names import section as board_path

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_WIRES = {
    "clock_pin": "spi_software_sclk_pin",
    "mosi_pin": "spi_software_mosi_pin",
    "miso_pin": "spi_software_miso_pin",
}
_DIRECTIONS = ("x", "y", "z", "-x", "-y", "-z")
_NONE = "none"  # the chip select of a bus that has its own


def put_accelerometer(job: Import) -> None:
    """Imports the accelerometer that the resonance tester uses for X, or the only one, after the
    boards. Raises ConfigError."""
    chips = [*job.config.of("adxl345"), *job.config.of("lis2dw")]
    tester = job.config.get("resonance_tester")
    if not chips:
        return
    names = [tester.text(key) for key in ("accel_chip", "accel_chip_x")] if tester else []
    found = next((chip for name in names for chip in chips if chip.name == name), chips[0])
    if not _put_wires(job, found):
        return
    job.used.add(found.name)
    job.draft.put(("accelerometer", "chip"), found.kind, found.place)
    _put_axes(job, found)
    if tester is not None:
        job.used.add(tester.name)
        for key in ("accel_chip", "accel_chip_x", "accel_chip_y", "accel_chip_z"):
            tester.option(key)  # one chip measures all axes, one after the other
        _put_test(job, tester)


def _put_wires(job: Import, chip: Section) -> bool:
    """Sets the pins of a chip. False if the file does not say enough for Passo."""
    draft, path = job.draft, ("accelerometer",)
    what = f"[{chip.name}]"
    written = chip.text("cs_pin")
    head, _, pin = written.rpartition(":")
    pins: dict[str, str | None] = {}
    for key, option in _WIRES.items():
        pins[key] = job.pins.of(chip, option) if option in chip.options else None
    if pin.lower() == _NONE:
        select, board = None, job.pins.further.get(head, "")
    else:
        select = job.pins.of(chip, "cs_pin")
        board = placed(select or "")[0]
    base, _ = draft.keys.get((*board_path(board), "base"), ("klipper", None))
    linked = (*board_path(board), "link") in draft.keys
    bus = chip.text("spi_bus")
    by_pins = select is not None and all(pins.values())
    if base != "klipper" or not (by_pins or (bus and linked)):
        text = "give the pins of its SPI bus, and a board that is fast enough"
        draft.decide(chip.place, what, f"the accelerometer is not used: {text} ([accelerometer])")
        chip.used.update(chip.options)
        job.used.add(chip.name)
        return False
    draft.put((*path, "cs_pin"), select, chip.at("cs_pin"))
    if by_pins:
        for key, option in _WIRES.items():
            draft.put((*path, key), pins[key], chip.at(option))
    else:
        draft.put((*path, "spi_bus"), named_on(board, bus), chip.at("spi_bus"))
    return True


def _put_axes(job: Import, chip: Section) -> None:
    if "axes_map" not in chip.options:
        return
    place = chip.at("axes_map")
    axes = [part.strip() for part in chip.text("axes_map").split(",")]
    if len(axes) != 3 or not set(axes) <= {*_DIRECTIONS}:
        limit = "three of x, y, z, -x, -y and -z"
        raise bad(place, f"axes_map in [{chip.name}]", ", ".join(axes), limit)
    job.draft.put(("accelerometer", "axes_map"), list(axes), place)


def _put_test(job: Import, tester: Section) -> None:
    draft, path = job.draft, ("accelerometer",)
    points = tester.text("probe_points")
    if points:
        place = tester.at("probe_points")
        first = points.strip().splitlines()[0]
        try:
            point = [number_of(part.strip()) for part in first.split(",")]
        except ValueError:
            point = []
        if len(point) != 3:
            raise bad(place, f"probe_points in [{tester.name}]", first, "X, Y and Z in mm")
        draft.put((*path, "point_mm"), list(point), place)
    put = draft.put
    put((*path, "accel_per_hz"), tester.number("accel_per_hz"), tester.at("accel_per_hz"))
    put((*path, "max_smoothing_mm"), tester.number("max_smoothing"), tester.at("max_smoothing"))
