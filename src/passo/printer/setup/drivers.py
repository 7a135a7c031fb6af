"""The buses of drivers, temperature converters and sensors of motion, from a machine file."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from passo.board.description import Accelerometer, Driver, Eddy, I2cPins, Setting, SpiPins, UartPins
from passo.board.trinamic import DriverSettings, threshold_of
from passo.config.board import joined_marks
from passo.config.pin_names import named_on, placed
from passo.config.probing import PROBE
from passo.config.sensors import Converter, ThermocoupleConverter
from passo.config.stalls import STALL_KINDS, watched_motors
from passo.config.trinamic import CHIPS, ChipName, Tmc, chip_of, tuned_fields
from passo.probes.eddy import EddyProbe

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.config.motion import Stepper
    from passo.config.sensors import AnySensor

ACCELEROMETER_HZ = 5_000_000  # the greatest clock of an ADXL345


def drivers(machine: MachineConfig) -> Iterator[Driver]:
    """The drivers that Passo sets up, in the order of the machine file. Drivers on the same UART
    have equal descriptions of it."""
    for name, stepper in machine.steppers.items():
        tmc = stepper.tmc
        chip = chip_of(stepper.driver)
        if tmc is None or chip is None:
            continue
        pin = partial(machine.pin_of_stepper, name)
        below = tmc.stealthchop_below_mm_s or tmc.stealthchop_below_deg_s
        settings = DriverSettings(
            chip,
            tmc.run_current_a,
            tmc.hold_current_a or tmc.run_current_a,
            tmc.resistor_ohm(chip),
            stepper.microsteps,
            tmc.interpolate,
            threshold_of(chip, below * stepper.steps_per_unit, stepper.microsteps)
            if below
            else None,
            _fields(chip, stepper, tmc) | _stall_fields(machine, name, chip),
        )
        if tmc.uart_pin:
            wire = UartPins(pin(tmc.uart_pin), pin(tmc.tx_pin or tmc.uart_pin))
            yield Driver(name, wire, settings, tmc.address)
        else:
            socket = machine.socket(name)
            select = tmc.cs_pin or (socket.select if socket else None) or ""
            wires = (tmc.clock_pin, tmc.mosi_pin, tmc.miso_pin)
            clock, mosi, miso = (pin(wire) if wire else "" for wire in wires)
            bus = placed(tmc.spi_bus)[1] if tmc.spi_bus else ""
            yield Driver(name, SpiPins(pin(select), clock, mosi, miso, bus=bus), settings)


def _stall_fields(machine: MachineConfig, motor: str, chip: ChipName) -> dict[str, int]:
    """The threshold of the stall detection of a motor, if an axis homes by it."""
    for home, homing in machine.homing.items():
        if homing.stall is not None and motor in watched_motors(machine, home):
            return {STALL_KINDS[chip].field: homing.stall.threshold}
    return {}


def _fields(chip: ChipName, stepper: Stepper, tmc: Tmc) -> dict[str, int]:
    """The fields of a driver that do not have their start values."""
    fields: dict[str, int] = {}
    if tmc.motor is not None:
        full = stepper.full_steps_per_rotation
        fields |= tuned_fields(CHIPS[chip], tmc.motor, tmc.run_current_a, full, tmc.registers)
    for field, speed in (
        ("tcoolthrs", tmc.coolstep_above_mm_s or tmc.coolstep_above_deg_s),
        ("thigh", tmc.high_speed_above_mm_s or tmc.high_speed_above_deg_s),
    ):
        if speed:
            fields[field] = threshold_of(chip, speed * stepper.steps_per_unit, stepper.microsteps)
    return fields | tmc.registers


def microstep_outputs(machine: MachineConfig) -> Iterator[tuple[str, str]]:
    """The pins that select the microsteps of drivers in sockets. These outputs are always off; a
    pin that must be high is inverted."""
    for name, stepper in machine.steppers.items():
        socket, on = machine.socket(name), machine.board_of_stepper(name)
        board = machine.all_boards[on]
        levels = board.microstep_levels.get(str(stepper.microsteps))
        if socket is None or levels is None:
            continue
        for i, (pin, high) in enumerate(zip(socket.microstep, levels, strict=True), 1):
            written = joined_marks("!", board.pin(pin)) if high else board.pin(pin)
            yield f"{name}-ms{i}", named_on(on, written)


def current_settings(machine: MachineConfig, on: str) -> Iterator[Setting]:
    """The settings that a board's current setter receives for the motors in the board's sockets."""
    board = machine.all_boards[on]
    setter = board.current_setter
    if setter is None:
        return
    words: list[bytes] = []
    for name, stepper in machine.steppers.items():
        socket = machine.socket(name)
        if machine.board_of_stepper(name) != on or socket is None or socket.current is None:
            continue
        if stepper.peak_current_a is not None:
            words.append(setter.word(socket.current, stepper.peak_current_a))
    pins = (setter.cs_pin, setter.clock_pin, setter.mosi_pin, setter.miso_pin)
    cs, clock, mosi, miso = (board.pin(pin) for pin in pins)
    if words:
        yield Setting(SpiPins(cs, clock, mosi, miso, mode=0), tuple(words))


def converter_wires(machine: MachineConfig, sensor: AnySensor, select: str) -> SpiPins | None:
    """The bus of a sensor, if it is a converter, which the pin `select` selects."""
    pin = machine.pin
    if not isinstance(sensor, Converter):
        return None
    clock, mosi, miso = (pin(p) for p in (sensor.clock_pin, sensor.mosi_pin, sensor.miso_pin))
    mode = 0 if isinstance(sensor, ThermocoupleConverter) else 1
    return SpiPins(pin(select), clock, mosi, miso, mode)


def accelerometers(machine: MachineConfig, on: str) -> Iterator[Accelerometer]:
    """The accelerometer of the machine, if it is on this board."""
    part = machine.accelerometer
    if part is None or part.written_board != on:
        return
    select, clock, mosi, miso, scl, sda = (
        machine.pin(pin) if pin else ""
        for pin in (
            *(part.cs_pin, part.clock_pin, part.mosi_pin, part.miso_pin),
            *(part.scl_pin, part.sda_pin),
        )
    )
    if part.on_i2c:
        bus = placed(part.i2c_bus)[1] if part.i2c_bus else ""
        wire = I2cPins(scl, sda, part.i2c_address, part.i2c_hz, bus)
    else:
        bus = placed(part.spi_bus)[1] if part.spi_bus else ""
        wire = SpiPins(select, clock, mosi, miso, 3, ACCELEROMETER_HZ, bus)
    axes = tuple(("xyz".index(d[-1]), -1 if d[0] == "-" else 1) for d in part.axes_map)
    yield Accelerometer(part.chip, wire, axes, part.rate_hz or 0)


def eddies(machine: MachineConfig, on: str) -> Iterator[Eddy]:
    """The eddy current probe of the machine, if it is on this board."""
    probe = machine.probe
    if not isinstance(probe, EddyProbe) or placed(probe.wired_at)[0] != on:
        return
    scl, sda, intb = (
        machine.pin(pin) if pin else "" for pin in (probe.scl_pin, probe.sda_pin, probe.intb_pin)
    )
    bus = placed(probe.i2c_bus)[1] if probe.i2c_bus else ""
    wire = I2cPins(scl, sda, probe.i2c_address, probe.i2c_hz, bus)
    yield Eddy(PROBE, wire, probe.chip_hz, probe.divider, intb)
