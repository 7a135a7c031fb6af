"""The default purpose of each pin of a board, and the pins that a machine uses."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from passo.config.buses import I2C_WIRES, SPI_WIRES
from passo.config.findings import Finding, parts_with_sensors, table, tables
from passo.config.lights import LIGHT_PINS
from passo.config.motor_roles import Drive, Driven, axis_order
from passo.config.pin_names import MAIN, bare, placed, section
from passo.config.sensors import CONVERTERS, Converter
from passo.config.trinamic import CHIPS, chip_of
from passo.probes.base import SwitchProbe
from passo.probes.eddy import EddyProbe

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.machine import MachineConfig


_WIRES = ("uart_pin", "tx_pin", *SPI_WIRES)
_RESISTORS = ("thermistor", "pt100", "pt1000")
_TOWERS = {"a": "X", "b": "Y", "c": "Z"}


@dataclass(frozen=True, slots=True)
class Binding:
    """A part of a machine and its pin: `name` is the pin in the machine file, `pin` the pin of the
    microcontroller. `original_name` and `original` are the same for the board's default, or
    None."""

    key: str
    name: str
    pin: str
    original_name: str | None
    original: str | None

    @property
    def rebound(self) -> bool:
        """Whether the machine uses a pin or an inversion that differs from the board's default."""
        if self.original is None:
            return False
        pins = (self.pin, self.original)
        (pin, inverted), (own, own_inverted) = ((bare(p), "!" in p) for p in pins)
        return (pin, inverted) != (own, own_inverted)


def put_originals(data: dict[str, Any]) -> Iterator[Finding]:
    """Fills in the board's default pin for heaters and fans of a raw machine file without a pin;
    reports those without a default."""
    board = table(data, "board")
    functions, chosen = table(board, "functions"), board.get("variant")
    whose = "the board" if chosen is None else f"the board's variant {chosen}"
    for part in ("heaters", "fans"):
        for name, key, content in _functions(data, part):
            function = table(functions, key)
            for own, other in (("pin", "output"), ("sensor_pin", "sensor")):
                if own in content or (other == "sensor" and (part == "fans" or _selects(content))):
                    continue
                if other in function:
                    content[own] = function[other]
                else:
                    why = _missing(whose, other, key) if functions else ""
                    path = (part, name, own)
                    yield Finding("config.missing-key", path, None, f"a pin in quotes{why}")


def _missing(whose: str, other: str, key: str) -> str:
    """The reason why a pin has to be given; empty for a part of unknown kind."""
    return "" if key == "None" else f": {whose} has no {other} for {key}"


def put_pullups(data: dict[str, Any]) -> None:
    """Fills in the pull-up resistor of the board for resistive sensors of a raw machine file
    without one, if the board's file has a value."""
    for _, _, content in parts_with_sensors(data):
        board = table(data, *section(placed(str(content.get("sensor_pin")))[0]))
        sensor = table(content, "sensor") if "sensor" in content else {"kind": "thermistor"}
        if "pullup_ohm" not in board or not isinstance(content, dict):
            continue
        if sensor.get("kind") in _RESISTORS:
            content["sensor"] = {"pullup_ohm": board["pullup_ohm"], **sensor}


def put_driver_wires(data: dict[str, Any]) -> None:
    """Fills in the UART pins of drivers in a raw machine file that name none: the pins of the
    driver's socket, if the board's file has them."""
    for _, stepper in tables(data, "steppers"):
        written, tmc = stepper.get("socket"), table(stepper, "tmc")
        chip = chip_of(stepper.get("driver"))
        if not isinstance(written, str) or not isinstance(stepper, dict) or not tmc:
            continue
        board, word = placed(written)
        socket = table(data, *section(board), "sockets", word)
        if chip is None or "uart" not in CHIPS[chip].buses or "uart" not in socket:
            continue
        if {"uart_pin", "cs_pin", "clock_pin", "spi_bus"} & set(tmc):
            continue
        wires: dict[str, Any] = {"uart_pin": f"{written}_UART"}
        if "uart_send" in socket:
            wires["tx_pin"] = f"{written}_UART_SEND"
        if CHIPS[chip].addresses > 1 and "address" in socket:
            wires["address"] = socket["address"]
        stepper["tmc"] = {**wires, **tmc}


def put_probe_home(data: dict[str, Any]) -> None:
    """Fills in the trigger height of the probe as the home position of Z in a raw machine file, if
    the probe homes Z."""
    homing, probe = table(data, "homing", "z"), table(data, "probe")
    if homing.get("probe") is True and "position" not in homing and isinstance(homing, dict):
        homing["position"] = probe.get("trigger_height_mm", 0.0)


def _selects(heater: Mapping[str, Any]) -> bool:
    """Whether the sensor pin of a heater selects a converter; then the default pin, that of a
    thermistor, does not apply."""
    return table(heater, "sensor").get("kind") in CONVERTERS


def _functions(data: Mapping[str, Any], part: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Heaters or fans: their names and those of their functions."""
    functions = _FunctionNames()
    for name, content in tables(data, part):
        if isinstance(content, dict):
            kind = "fan" if part == "fans" else str(content.get("kind"))
            yield name, functions.of(kind), content


class _FunctionNames:
    """Names of functions, in the order of a machine's parts: hotend0, hotend1, bed, fan0."""

    def __init__(self) -> None:
        self._seen = Counter[str]()

    def of(self, kind: str) -> str:
        """The name of the next part of this kind; a bed and a chamber have their own."""
        if kind not in ("hotend", "fan"):
            return kind
        self._seen[kind] += 1
        return f"{kind}{self._seen[kind] - 1}"


def bindings(machine: MachineConfig) -> list[Binding]:
    """Every pin of the machine's motors, drivers, heaters, sensors, fans, switches, laser and
    status light."""
    board = machine.board
    found: list[Binding] = []

    def add(key: str, name: str | None, original: str | None) -> None:
        if name is None:
            return
        on = placed(name)[0]
        # A part that the board does not have gets no binding.
        if original is not None and placed(original)[0] != on:
            original = None
        own = None if original is None else machine.pin(original)
        found.append(Binding(key, name, machine.pin(name), original, own))

    sockets = _own_sockets(machine)
    for name, stepper in machine.steppers.items():
        used, meant = _socket_pins(machine, stepper.socket), _socket_pins(machine, sockets[name])
        for key, given, word in (
            ("step_pin", stepper.step_pin, "STEP"),
            ("direction_pin", stepper.direction_pin, "DIR"),
            ("enable_pin", stepper.enable_pin, "ENABLE"),
        ):
            add(f"steppers.{name}.{key}", given or used.get(word), meant.get(word))
        for word in used:
            if word.startswith("MS"):
                add(f"steppers.{name}.{word.lower()}", used[word], meant.get(word))
        if stepper.tmc:
            select = None if stepper.tmc.uart_pin else stepper.tmc.cs_pin or used.get("SELECT")
            add(f"steppers.{name}.tmc.cs_pin", select, meant.get("SELECT"))
            for key in _WIRES:
                add(f"steppers.{name}.tmc.{key}", getattr(stepper.tmc, key), None)
    names = _FunctionNames()
    for name, heater in machine.heaters.items():
        function = board.functions.get(names.of(heater.kind))
        add(f"heaters.{name}.pin", heater.pin, function.output if function else None)
        add(f"heaters.{name}.sensor_pin", heater.sensor_pin, function.sensor if function else None)
        if isinstance(heater.sensor, Converter):
            for key in SPI_WIRES:
                add(f"heaters.{name}.sensor.{key}", getattr(heater.sensor, key), None)
    fans = [f.output for name, f in board.functions.items() if name.startswith("fan")]
    for name, fan in machine.fans.items():
        function = board.functions.get(names.of("fan"))
        default = function.output if function else None
        # fans may be on each other's outputs
        own = (output for output in fans if output and machine.pin(output) == machine.pin(fan.pin))
        add(f"fans.{name}.pin", fan.pin, next(own, default))
        if fan.tachometer:
            add(f"fans.{name}.tachometer.pin", fan.tachometer.pin, None)
    for name, output in machine.outputs.items():
        add(f"outputs.{name}.pin", output.pin, None)
    for name, servo in machine.servos.items():
        add(f"servos.{name}.pin", servo.pin, None)
    for name, light in machine.lights.items():
        for key in LIGHT_PINS:
            add(f"lights.{name}.{key}", getattr(light, key, None), None)
    for name, shown in machine.sensors.items():
        add(f"sensors.{name}.sensor_pin", shown.sensor_pin, None)
        for key in (*SPI_WIRES, *I2C_WIRES):
            add(f"sensors.{name}.sensor.{key}", getattr(shown.sensor, key, None), None)
    for name, homing in machine.homing.items():
        original = _switch(board, name, homing.direction)
        add(f"homing.{name}.pin", homing.pin, original)
        for stepper, pin in homing.stepper_pins.items():
            own = original if stepper == name else None
            add(f"homing.{name}.stepper_pins.{stepper}", pin, own)
    if isinstance(machine.probe, EddyProbe):
        for key in ("scl_pin", "sda_pin", "intb_pin"):
            add(f"probe.{key}", getattr(machine.probe, key), None)
    if isinstance(machine.probe, SwitchProbe):
        add("probe.pin", machine.probe.pin, None)
        if machine.probe.servo_pin:
            add("probe.control_pin", machine.probe.servo_pin, None)
    if machine.laser:
        add("laser.pin", machine.laser.pin, None)
    if machine.mains:
        add("mains.pin", machine.mains.pin, None)
    if machine.beeper:
        add("beeper.pin", machine.beeper.pin, None)
    add("board.status_led", board.status_led, "LED" if "LED" in board.pins else None)
    return found


def _own_sockets(machine: MachineConfig) -> dict[str, str | None]:
    """The default socket of the board for each motor: X, Y and Z for the actuators, E or E0 and so
    on for the extruders, U for an axis u. Without a default, as for a second motor of the same
    actuator or one on another board, it is the socket that the motor uses."""
    sockets, axes = machine.board.sockets, axis_order(machine.axes)
    meant: dict[Driven | None, str] = {}
    for i, name in enumerate(word for word in sockets if re.fullmatch("E[0-9]*", word)):
        meant[Driven("extruder", i)] = name
    kinds: tuple[tuple[Drive, Iterable[str]], ...] = (("actuator", "xyz"), ("axis", axes))
    for drive, words in kinds:
        for i, word in enumerate(words):
            if word.upper() in sockets:
                meant[Driven(drive, i)] = word.upper()
    own: dict[str, str | None] = {}
    for name, stepper in machine.steppers.items():
        first = meant.pop(machine.driven_by(name), None)
        here = machine.board_of_stepper(name) == MAIN
        own[name] = first if first and here else stepper.socket
    return own


def _socket_pins(machine: MachineConfig, written: str | None) -> dict[str, str]:
    """Names of the pins of a socket by their last words, STEP, DIR and so on."""
    if written is None:
        return {}
    board, name = placed(written)
    socket = machine.all_boards[board].sockets[name]
    words = ["STEP", "DIR", "ENABLE", *(["SELECT"] if socket.select else [])]
    words += [f"MS{i}" for i in range(1, 1 + len(socket.microstep))]
    return {word: f"{written}_{word}" for word in words}


def _switch(board: Board, axis: str, direction: str) -> str | None:
    """The board's endstop for an end of an axis or for a tower."""
    letter = _TOWERS.get(axis, axis.upper())
    names = (f"{letter}_{direction.upper()}", f"{letter}_STOP")
    return next((name for name in names if name in board.endstops), None)
