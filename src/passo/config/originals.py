"""What the makers of a board meant each pin for, beside what a machine uses it for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from passo.config.findings import table, tables
from passo.config.places import bare, placed, section
from passo.config.sensors import CONVERTERS, Converter

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.machine import MachineConfig

_BUS = ("clock_pin", "mosi_pin", "miso_pin")
_WIRES = ("uart_pin", "tx_pin", *_BUS)
_RESISTORS = ("thermistor", "pt100", "pt1000")
_TOWERS = {"a": "X", "b": "Y", "c": "Z"}


@dataclass(frozen=True, slots=True)
class Binding:
    """A part of a machine and its pin: `name` as the machine file writes it, `pin` the
    microcontroller's. `original_name` and `original` are the board's own for such a part, None if
    it has none."""

    key: str
    name: str
    pin: str
    original_name: str | None
    original: str | None

    @property
    def rebound(self) -> bool:
        """Whether the machine uses another pin than the board's own."""
        return self.original is not None and bare(self.pin) != bare(self.original)


def put_originals(data: dict[str, Any]) -> None:
    """Gives heaters and fans of a raw machine file that name no pin the board's own."""
    functions = table(data, "board", "functions")
    for part in ("heaters", "fans"):
        for key, content in _functions(data, part):
            function = table(functions, key)
            for own, other in (("pin", "output"), ("sensor_pin", "sensor")):
                if other == "sensor" and (part == "fans" or _selects(content)):
                    continue
                if own not in content and other in function:
                    content[own] = function[other]


def put_pullups(data: dict[str, Any]) -> None:
    """Gives resistive sensors of a raw machine file that name no pull-up resistor the one that
    their board has, if its file says it."""
    for _, heater in tables(data, "heaters"):
        board = table(data, *section(placed(str(heater.get("sensor_pin")))[0]))
        sensor = table(heater, "sensor") if "sensor" in heater else {"kind": "thermistor"}
        if "pullup_ohm" not in board or not isinstance(heater, dict):
            continue
        if sensor.get("kind") in _RESISTORS:
            heater["sensor"] = {"pullup_ohm": board["pullup_ohm"], **sensor}


def _selects(heater: Mapping[str, Any]) -> bool:
    """Whether its sensor's pin selects a converter: the board's own is a thermistor's."""
    return table(heater, "sensor").get("kind") in CONVERTERS


def _functions(data: Mapping[str, Any], part: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Heaters or fans with the names of their functions."""
    names = _FunctionNames()
    for _, content in tables(data, part):
        if isinstance(content, dict):
            yield names.of("fan" if part == "fans" else str(content.get("kind"))), content


class _FunctionNames:
    """Names of functions, in the order of a machine's parts: hotend0, hotend1, bed, fan0, …"""

    def __init__(self) -> None:
        self._seen = Counter[str]()

    def of(self, kind: str) -> str:
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
        # Elsewhere nobody has meant anything for this part.
        if original is not None and placed(original)[0] != on:
            original = None
        own = None if original is None else machine.pin(original)
        found.append(Binding(key, name, machine.pin(name), original, own))

    for name, stepper in machine.steppers.items():
        socket = machine.socket(name)
        for key, given, word in (
            ("step_pin", stepper.step_pin, "STEP"),
            ("direction_pin", stepper.direction_pin, "DIR"),
            ("enable_pin", stepper.enable_pin, "ENABLE"),
        ):
            original = f"{stepper.socket}_{word}" if stepper.socket else None
            add(f"steppers.{name}.{key}", given or original, original)
        for i in range(1, 1 + len(socket.microstep if socket else ())):
            own = f"{stepper.socket}_MS{i}"
            add(f"steppers.{name}.ms{i}", own, own)
        if stepper.tmc:
            select = f"{stepper.socket}_SELECT" if socket and socket.select else None
            by_spi = stepper.tmc.uart_pin is None
            add(
                f"steppers.{name}.tmc.cs_pin",
                (stepper.tmc.cs_pin or select) if by_spi else None,
                select,
            )
            for key in _WIRES:
                add(f"steppers.{name}.tmc.{key}", getattr(stepper.tmc, key), None)
    names = _FunctionNames()
    for name, heater in machine.heaters.items():
        function = board.functions.get(names.of(heater.kind))
        add(f"heaters.{name}.pin", heater.pin, function.output if function else None)
        add(f"heaters.{name}.sensor_pin", heater.sensor_pin, function.sensor if function else None)
        if isinstance(heater.sensor, Converter):
            for key in _BUS:
                add(f"heaters.{name}.sensor.{key}", getattr(heater.sensor, key), None)
    for name, fan in machine.fans.items():
        function = board.functions.get(names.of("fan"))
        add(f"fans.{name}.pin", fan.pin, function.output if function else None)
    for name, homing in machine.homing.items():
        original = _switch(board, name, homing.direction)
        add(f"homing.{name}.pin", homing.pin, original)
        for stepper, pin in homing.stepper_pins.items():
            own = original if stepper == name else None
            add(f"homing.{name}.stepper_pins.{stepper}", pin, own)
    if machine.laser:
        add("laser.pin", machine.laser.pin, None)
    if machine.mains:
        add("mains.pin", machine.mains.pin, None)
    if machine.beeper:
        add("beeper.pin", machine.beeper.pin, None)
    add("board.status_led", board.status_led, "LED" if "LED" in board.pins else None)
    return found


def _switch(board: Board, axis: str, direction: str) -> str | None:
    """The board's switch for an end of an axis or for a tower."""
    letter = _TOWERS.get(axis, axis.upper())
    names = (f"{letter}_{direction.upper()}", f"{letter}_STOP")
    return next((name for name in names if name in board.endstops), None)
