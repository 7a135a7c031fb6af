"""[adxl345], [lis2dw] and [resonance_tester]."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from passo.config.accelerometer import FASTEST_HZ, RATES_HZ, Direction
from passo.config.importing.klipper.chips import LINUX
from passo.config.importing.numbers import number_of
from passo.config.pin_names import MAIN, bare, named_on, placed
from passo.config.pin_names import section as board_path

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_SPI_WIRES = {
    "clock_pin": "spi_software_sclk_pin",
    "mosi_pin": "spi_software_mosi_pin",
    "miso_pin": "spi_software_miso_pin",
}
_I2C_WIRES = {"scl_pin": "i2c_software_scl_pin", "sda_pin": "i2c_software_sda_pin"}
_LINUX_BUS = "spidev0.0"
_NONE = "none"  # the chip select of a bus that has its own


def put_accelerometer(job: Import) -> None:
    """Imports the accelerometer that the resonance tester uses for X, or the only one, after the
    boards."""
    chips = [*job.config.of("adxl345"), *job.config.of("lis2dw")]
    tester = job.config.get("resonance_tester")
    if not chips:
        return
    names = [tester.text(key) for key in ("accel_chip", "accel_chip_x")] if tester else []
    found = next((chip for name in names for chip in chips if chip.name == name), chips[0])
    if job.part(found, _put_chip) and ("accelerometer", "chip") in job.draft.keys and tester:
        job.part(tester, _put_test)


def _put_chip(job: Import, chip: Section) -> None:
    if not _put_wires(job, chip):
        chip.used.update(chip.options)
        return
    job.draft.put(("accelerometer", "chip"), chip.kind, chip.place)
    _put_rate(job, chip)
    _put_axes(job, chip)


def _put_wires(job: Import, chip: Section) -> bool:
    """Sets the pins of a chip, or the bus of its board. False if the file does not say enough for
    Passo, which is reported."""
    if chip.kind == "lis2dw" and "cs_pin" not in chip.options:  # as Klipper decides
        return _put_i2c(job, chip)
    put, path = job.draft.put, ("accelerometer",)
    board, _, pin = bare(chip.text("cs_pin")).rpartition(":")
    bus, select = chip.text("spi_bus"), None
    if pin.lower() == _NONE:
        board = job.pins.further.get(board, MAIN)
        bus = bus or _first_bus(job, board)
    else:
        select = job.pins.of(chip, "cs_pin")
        board = placed(select or "")[0]
    pins = {key: job.pins.of(chip, option) for key, option in _SPI_WIRES.items()}
    if select is not None and all(pins.values()):
        for key, option in _SPI_WIRES.items():
            put((*path, key), pins[key], chip.at(option))
    elif bus and pin and (*board_path(board), "link") in job.draft.keys:
        put((*path, "spi_bus"), named_on(board, bus), chip.at("spi_bus"))
    else:
        missing = "cs_pin, clock_pin, mosi_pin and miso_pin"
        if bus and pin:
            missing = f"spi_bus = {named_on(board, bus)!r} when its board has link and port"
        elif pin:
            missing = "its spi_bus, or clock_pin, mosi_pin and miso_pin"
        return _lacks(job, chip, missing)
    put((*path, "cs_pin"), select, chip.at("cs_pin"))
    return True


def _first_bus(job: Import, board: str) -> str:
    """The bus of a chip that names none, if its board is a computer; else empty."""
    port, _ = job.draft.keys.get((*board_path(board), "port"), ("", None))
    return _LINUX_BUS if LINUX in str(port) else ""


def _put_i2c(job: Import, chip: Section) -> bool:
    """Does the same for a chip on I2C."""
    put, path = job.draft.put, ("accelerometer",)
    board, bus = job.pins.further.get(chip.text("i2c_mcu"), MAIN), chip.text("i2c_bus")
    pins = {key: job.pins.of(chip, option) for key, option in _I2C_WIRES.items()}
    if all(pins.values()):
        for key, option in _I2C_WIRES.items():
            put((*path, key), pins[key], chip.at(option))
    elif bus and (*board_path(board), "link") in job.draft.keys:
        put((*path, "i2c_bus"), named_on(board, bus), chip.at("i2c_bus"))
    elif bus:
        place = f"i2c_bus = {named_on(board, bus)!r}"
        return _lacks(job, chip, f"{place} when its board has link and port")
    else:
        return _lacks(job, chip, "its i2c_bus, or scl_pin and sda_pin")
    job.put("accelerometer_i2c", chip)
    return True


def _lacks(job: Import, chip: Section, missing: str) -> bool:
    text = f"the accelerometer is not used: give [accelerometer] {missing}"
    job.draft.decide(chip.place, f"[{chip.name}]", text)
    return False


def _put_rate(job: Import, chip: Section) -> None:
    """Sets the samples a second: as many as Klipper has, or the next that Passo has."""
    rate = chip.read("rate")
    if rate is None:
        return
    rates = [hz for hz in RATES_HZ if hz <= FASTEST_HZ[chip.kind]]
    used = next((hz for hz in rates if hz >= rate.value), rates[-1])
    if used != rate.value:
        text = f"{rate.value:g} became {used}: the chip samples {', '.join(map(str, rates))} times"
        job.draft.changed(rate.place, f"[{chip.name}] rate", f"{text} a second")
    job.draft.put(("accelerometer", "rate_hz"), used, rate.place)


def _put_axes(job: Import, chip: Section) -> None:
    if "axes_map" not in chip.options:
        return
    axes = [part.strip() for part in chip.text("axes_map").split(",")]
    if len(axes) != 3 or not set(axes) <= {*get_args(Direction)}:
        raise chip.wrong("axes_map", "three of x, y, z, -x, -y and -z", ", ".join(axes))
    job.put_value(("accelerometer", "axes_map"), chip, "axes_map", list(axes))


def _put_test(job: Import, tester: Section) -> None:
    """Sets the place of the measurement, and its strength."""
    for key in ("accel_chip", "accel_chip_x", "accel_chip_y", "accel_chip_z"):
        tester.option(key)  # one chip measures all axes, one after the other
    points = tester.text("probe_points").strip().splitlines()
    if points:
        try:
            point = [number_of(part.strip()) for part in points[0].split(",")]
        except ValueError:
            point = []
        if len(point) != 3:
            raise tester.wrong("probe_points", "X, Y and Z in mm", points[0])
        job.put_value(("accelerometer", "point_mm"), tester, "probe_points", list(point))
        if points[1:]:
            what = f"probe_points in [{tester.name}]"
            text = "Passo measures at one place: the first"
            job.draft.changed(tester.at("probe_points"), what, text)
    job.put("resonance_tester", tester)
