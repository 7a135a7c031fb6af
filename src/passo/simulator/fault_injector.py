"""Injects faults into the simulated printer, by the names of its parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from passo.board.fault_injection import NO_FAULT
from passo.config.probing import PROBE
from passo.config.trinamic import CHIPS
from passo.errors import CommandError

if TYPE_CHECKING:
    from passo.config.trinamic import ChipName
    from passo.simulator.machine import SimulatedMachine
    from passo.simulator.sensor_chips import SensorChip

_SENSOR = (NO_FAULT, "open", "short", "noise", "loose")
_CHIP = (NO_FAULT, "silent")
_CHECKED_CHIP = (*_CHIP, "garbled")
_HEATER = (NO_FAULT, "on", "off")
_ENDSTOP = (NO_FAULT, "triggered", "open")
_FLICKERS = "flickering"
# The levels of an input by the beginning of its name: active or not.
_INPUTS = {
    "filament": {"present": True, "out": False},
    "button": {"pressed": True, "released": False},
}
_WIDTH = (NO_FAULT, "out", "width")
_CABLE = (NO_FAULT, "cut", "noise")
_FAN = (NO_FAULT, "stalled", "silent")
# The flags that a driver reports.
_DRIVER = {
    "hot": ("otpw",),
    "overheated": ("otpw", "ot"),
    "short": ("s2ga",),
    "open": ("ola",),
}
_SILENT = "silent"
_BED = (NO_FAULT, "tilted")
_COIL = (NO_FAULT, "open", "silent")
_TILT_MM = 1.0  # over the width of the bed
_SENSOR_NOISE = 0.05  # maximum, as a fraction of the ADC's full scale, in both directions
# The faults that may have an amount: its maximum, and its form in a message.
_AMOUNTS = {
    "noise": (1.0, " (or noise:SHARE, from 0 to 1)"),
    "width": (5.0, " (as width:MM, from 0 to 5)"),
}
_CABLE_NOISE = 0.01  # fraction of all bytes


class SimulatedFaults:
    """The faults of one simulated machine: see `board.fault_injection.FaultInjector`.

    Some faults may have an amount: `noise`, as in `noise:0.05`, for a sensor a fraction of the full
    scale of its ADC, for a cable the fraction of corrupted bytes; `width`, as in `width:1.70`, the
    diameter of the filament in mm.
    """

    def __init__(self, machine: SimulatedMachine) -> None:
        self._machine = machine
        self._setters: dict[str, Callable[[str, float | None], None]] = {}
        self._values: dict[str, tuple[str, ...]] = {}
        self._active: dict[str, str] = {}
        board = machine.board
        for heater in board.heaters:
            self._add(f"{heater.name}-sensor", _SENSOR, self._sensor_setter(heater.sensor))
            self._add(f"{heater.name}-heater", _HEATER, self._heater_setter(heater.sensor))
        for sensor in board.shown:
            self._add(f"{sensor.name}-sensor", _SENSOR, self._sensor_setter(sensor.name))
        for sensor in board.i2c_sensors:
            chip = machine.sensor_chips[sensor.name]
            faults = _CHECKED_CHIP if chip.checked else _CHIP
            self._add(f"{sensor.name}-sensor", faults, _chip_setter(chip))
        for endstop in board.endstops:
            self._add(f"{endstop.name}-endstop", _ENDSTOP, self._endstop_setter(endstop.name))
            if endstop.name == PROBE:
                self._add("bed", _BED, self._set_bed)
        for eddy in board.eddies:
            self._add(f"{eddy.name}-coil", _COIL, self._coil_setter(eddy.name))
            if eddy.name == PROBE:
                self._add("bed", _BED, self._set_bed)
        digital = {entry.name for entry in board.inputs}
        for name in board.input_names:
            levels = _INPUTS[name.partition("-")[0]]
            values = (NO_FAULT, *levels, *([_FLICKERS] if name in digital else []))
            self._add(name, values, self._input_setter(name, levels))
        for name in machine.widths:
            self._add(name, _WIDTH, self._width_setter(name))
        for counter in board.counters:
            self._add(f"{counter.name}-fan", _FAN, self._fan_setter(counter.name))
        for driver in board.drivers:
            setter = self._driver_setter(driver.stepper, driver.settings.chip)
            self._add(f"{driver.stepper}-driver", (NO_FAULT, *_DRIVER, _SILENT), setter)
        for name in machine.boards:
            self._add(f"{name}-cable" if name else "cable", _CABLE, self._cable_setter(name))

    @property
    def values(self) -> Mapping[str, tuple[str, ...]]:
        """The faults of each part."""
        return self._values

    @property
    def active(self) -> Mapping[str, str]:
        """The parts that have a fault now, with the fault."""
        return self._active

    def check(self, part: str, value: str) -> None:
        """Raises CommandError for a part or a fault that does not exist."""
        self._read(part, value)

    def inject(self, part: str, value: str) -> None:
        """Gives a part this fault from now on, or `none`. Raises CommandError."""
        fault, amount = self._read(part, value)
        self._setters[part](fault, amount)
        self._active.pop(part, None)
        if fault != NO_FAULT:
            self._active[part] = value

    def _read(self, part: str, value: str) -> tuple[str, float | None]:
        """The fault and its amount."""
        if part not in self._values:
            limit = ", ".join(self._values)
            raise CommandError.of("command.no-fault", value=part or "''", limit=limit)
        fault, colon, text = value.partition(":")
        most = _AMOUNTS.get(fault)
        amount = _amount(text, most[0]) if most and colon else None
        if fault not in self._values[part] or (colon and amount is None):
            limit = ", ".join(self._values[part])
            limit += "".join(_AMOUNTS[v][1] for v in self._values[part] if v in _AMOUNTS)
            raise CommandError.of("command.no-fault", value=f"{part}={value}", limit=limit)
        return fault, amount

    def _add(
        self, part: str, values: tuple[str, ...], setter: Callable[[str, float | None], None]
    ) -> None:
        self._values[part], self._setters[part] = values, setter

    def _sensor_setter(self, sensor: str) -> Callable[[str, float | None], None]:
        machine = self._machine
        open_is_high = next(s.open_is_high for s in machine.board.sensors if s.name == sensor)

        def set_fault(fault: str, amount: float | None) -> None:
            ratios = {"open": float(open_is_high), "short": float(not open_is_high)}
            machine.force_sensor(sensor, ratios.get(fault))
            machine.drop_sensor(sensor, fault == "loose")
            noise = _SENSOR_NOISE if amount is None else amount
            machine.add_noise(sensor, noise if fault == "noise" else 0.0)

        return set_fault

    def _heater_setter(self, sensor: str) -> Callable[[str, float | None], None]:
        powers = {"on": 1.0, "off": 0.0}
        return lambda fault, _: self._machine.force_heater(sensor, powers.get(fault))

    def _endstop_setter(self, endstop: str) -> Callable[[str, float | None], None]:
        pressed = {"triggered": True, "open": False}
        return lambda fault, _: self._machine.force_switch(endstop, pressed.get(fault))

    def _input_setter(
        self, name: str, levels: Mapping[str, bool]
    ) -> Callable[[str, float | None], None]:
        def set_fault(fault: str, _: float | None) -> None:
            if fault == _FLICKERS:
                self._machine.flicker(name)
            else:
                self._machine.force_input(name, levels.get(fault))

        return set_fault

    def _width_setter(self, name: str) -> Callable[[str, float | None], None]:
        def set_fault(fault: str, amount: float | None) -> None:
            none = None if fault == NO_FAULT else 0.0
            self._machine.force_width(name, amount if fault == "width" else none)

        return set_fault

    def _fan_setter(self, counter: str) -> Callable[[str, float | None], None]:
        return lambda fault, _: self._machine.force_rotor(
            counter, stalled=fault == "stalled", silent=fault == "silent"
        )

    def _driver_setter(self, motor: str, kind: ChipName) -> Callable[[str, float | None], None]:
        chip, status = self._machine.drivers[motor], CHIPS[kind].status

        def set_fault(fault: str, _: float | None) -> None:
            flags = (status.fields[flag].placed(1) for flag in _DRIVER.get(fault, ()))
            chip.set(status.address, sum(flags))
            chip.plugged = fault != _SILENT

        return set_fault

    def _coil_setter(self, sensor: str) -> Callable[[str, float | None], None]:
        return lambda fault, _: self._machine.break_coil(
            sensor, open_coil=fault == "open", silent=fault == "silent"
        )

    def _set_bed(self, fault: str, _: float | None) -> None:
        self._machine.tilt_bed(_TILT_MM if fault == "tilted" else 0.0)

    def _cable_setter(self, board: str) -> Callable[[str, float | None], None]:
        def set_fault(fault: str, amount: float | None) -> None:
            self._machine.cut_cable(board, fault == "cut")
            noise = _CABLE_NOISE if amount is None else amount
            self._machine.spoil_cable(board, noise if fault == "noise" else 0.0)

        return set_fault


def _chip_setter(chip: SensorChip) -> Callable[[str, float | None], None]:
    def set_fault(fault: str, _: float | None) -> None:
        chip.plugged, chip.garbled = fault != "silent", fault == "garbled"

    return set_fault


def _amount(text: str, most: float) -> float | None:
    try:
        amount = float(text)
    except ValueError:
        return None
    return amount if 0 <= amount <= most else None
