"""From a machine file to what is wired to its board."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

from passo.board.connection import Connection
from passo.board.description import (
    BoardDescription,
    Endstop,
    Heater,
    Output,
    Sensor,
    Stepper,
    bare,
)
from passo.board.ports import InProcess, Port, serial_port, tcp_port
from passo.heat.control import control_of, limits_of, model_of
from passo.heat.sensors import converter_of, open_is_high, sensor_table, share_at
from passo.printer.driver_wiring import converter_wires, drivers
from passo.printer.switches import (
    Switch,
    axes_of_arms,
    home_point,
    is_actuator,
    pressed_point,
    switches,
    weights_of,
)

if TYPE_CHECKING:
    from passo.config.heat import Heater as HeaterConfig
    from passo.config.machine import MachineConfig
    from passo.simulator import Actuator, SimulatedBoard

_PWM_PERIOD_S = 0.1
_MAX_DURATION_S = 3.0
_AWAY = 20.0  # mm or degrees
_ASKEW = 0.5


def board_description(machine: MachineConfig) -> BoardDescription:
    """The board with all motors, heaters, fans and the laser. Message targets count the steppers in
    the order of `core_spec()`, the outputs in the order of `output_names`."""
    clock_hz = machine.board.clock_hz
    spec = machine.core_spec()
    steppers = tuple(
        Stepper(
            s["name"],
            *_driver_pins(machine, s["name"]),
            invert=s["invert"],
            pulse_ticks=max(1, ceil(s["pulse_s"] * clock_hz)),
        )
        for s in spec["steppers"]
    )
    outputs: list[Output] = []
    sensors: list[Sensor] = []
    heaters: list[Heater] = []
    for name, heater in machine.heaters.items():
        cycle = round(_PWM_PERIOD_S * clock_hz)
        longest = round(_MAX_DURATION_S * clock_hz)
        outputs.append(Output(name, machine.board.pin(heater.pin), "digital", cycle, longest))
        sensors.append(sensor_of(machine, name, heater))
        heaters.append(_heater(name, heater))
    for name, fan in machine.fans.items():
        outputs.append(
            Output(name, machine.board.pin(fan.pin), "digital", round(_PWM_PERIOD_S * clock_hz))
        )
    if machine.laser:
        longest = round(_MAX_DURATION_S * clock_hz)
        pin = machine.board.pin(machine.laser.pin)
        outputs.append(Output("laser", pin, "pwm", round(0.001 * clock_hz), longest))
    enables = enable_outputs(machine)
    for name, output in enables.items():
        if output == f"{name}-enable":
            outputs.append(Output(output, str(enable_pin(machine, name)), "digital"))
    if machine.board.status_led:
        pin = machine.board.pin(machine.board.status_led)
        outputs.append(Output("status-led", pin, cycle_ticks=clock_hz, blinks=True))
    return BoardDescription(
        clock_hz=clock_hz,
        steppers=steppers,
        outputs=tuple(outputs),
        sensors=tuple(sensors),
        heaters=tuple(heaters),
        endstops=tuple(Endstop(s.name, machine.board.pin(s.pin)) for s in switches(machine)),
        drivers=tuple(drivers(machine)),
        move_count=machine.board.move_count,
        mcu=machine.board.mcu,
    )


def _heater(name: str, heater: HeaterConfig) -> Heater:
    return Heater(
        name,
        output=name,
        sensor=name,
        control=control_of(heater),
        limits=limits_of(heater),
        model=model_of(heater),
        fan=heater.fan,
        max_power=heater.max_power,
    )


def sensor_of(machine: MachineConfig, name: str, heater: HeaterConfig) -> Sensor:
    """The sensor of a heater as its board has it; also for `Connection.set_sensor`."""
    table = sensor_table(heater.sensor)
    low, high = sorted((share_at(table, heater.min_c), share_at(table, heater.max_c)))
    pin = machine.board.pin(heater.sensor_pin)
    sensor, spi = heater.sensor, converter_wires(machine, heater)
    return Sensor(name, pin, table, low, high, open_is_high(sensor), converter_of(sensor), spi)


def _driver_pins(machine: MachineConfig, name: str) -> tuple[str, str]:
    """Step and direction pin of a motor."""
    stepper = machine.steppers[name]
    socket = machine.board.sockets[stepper.socket] if stepper.socket else None
    step = stepper.step_pin or (socket.step if socket else f"{name}_step")
    direction = stepper.direction_pin or (socket.direction if socket else f"{name}_dir")
    return machine.board.pin(step), machine.board.pin(direction)


def enable_outputs(machine: MachineConfig) -> dict[str, str]:
    """The output that switches each motor on, for those that have one. Motors may share an output:
    it has the name of the first of them."""
    by_pin: dict[str, str] = {}
    outputs: dict[str, str] = {}
    for name in machine.steppers:
        pin = enable_pin(machine, name)
        if pin is not None:
            outputs[name] = by_pin.setdefault(bare(pin), f"{name}-enable")
    return outputs


def enable_pin(machine: MachineConfig, name: str) -> str | None:
    """The pin that switches a motor on, if it has one."""
    stepper = machine.steppers[name]
    socket = machine.board.sockets[stepper.socket] if stepper.socket else None
    pin = stepper.enable_pin or (socket.enable if socket else None)
    return None if pin is None else machine.board.pin(pin)


def output_count(machine: MachineConfig) -> int:
    """Number of outputs on the timeline: heaters, fans, the laser."""
    return len(machine.heaters) + len(machine.fans) + (machine.laser is not None)


def simulated_board(machine: MachineConfig, board: BoardDescription) -> SimulatedBoard:
    """The simulated board that a machine file names, with mechanics and heat around it."""
    from passo.simulator import Body, PlantDescription, SimulatedBoard
    from passo.simulator import Switch as PlantSwitch

    plant = PlantDescription(
        actuators=_actuators(machine),
        switches=tuple(
            PlantSwitch(s.name, weights, _felt_at(machine, s, weights), _at_maximum(machine, s))
            for s in switches(machine)
            for weights in (weights_of(machine, s),)
        ),
        bodies=tuple(
            Body(
                name,
                heater.simulated.full_power_rise_c,
                heater.simulated.time_constant_s,
                heater.simulated.sensor_time_constant_s,
                fan=heater.fan,
                fan_loss=heater.simulated.fan_loss,
            )
            for name, heater in machine.heaters.items()
        ),
    )
    return SimulatedBoard(board, plant, firmware=machine.board.firmware)


def _actuators(machine: MachineConfig) -> tuple[Actuator, ...]:
    """Before it is homed, a simulated machine stands a little away from its switches, and askew
    where it has two motors with a switch each."""
    from passo.simulator import Actuator

    geometry = machine.geometry
    q = list(geometry.inverse(home_point(machine)))
    point = list(home_point(machine))
    for name, homing in machine.homing.items():
        away = -_AWAY if homing.direction == "max" else _AWAY
        if axes_of_arms(machine) and name in geometry.actuators:
            q[geometry.actuators.index(name)] += away
        elif name in "xyz":
            point["xyz".index(name)] += away
    if not axes_of_arms(machine):
        x, y, z = point
        q = list(geometry.inverse((x, y, z)))
    askew = {n: i * _ASKEW for h in machine.homing.values() for i, n in enumerate(h.stepper_pins)}
    starts: list[Actuator] = []
    for s in machine.core_spec()["steppers"]:
        start = askew.get(s["name"], 0.0)
        if s["drive"] == "actuator" and machine.homing:
            start += q[int(s["index"])]
        starts.append(Actuator(s["name"], s["steps_per_unit"], start))
    return tuple(starts)


def _felt_at(
    machine: MachineConfig, switch: Switch, weights: tuple[tuple[str, float], ...]
) -> float:
    """The sum of weighted positions at which the switch is pressed."""
    homing = machine.homing[switch.home]
    if is_actuator(machine, switch.home) or len(weights) == 1:
        return homing.position
    q = machine.geometry.inverse(pressed_point(machine, switch))
    total = 0.0
    for name, weight in weights:
        driven = machine.drivable.of(name, machine.steppers[name].drives)
        total += weight * q[driven.index] if driven else 0.0
    return total


def _at_maximum(machine: MachineConfig, switch: Switch) -> bool:
    return machine.homing[switch.home].direction == "max"


def connect_simulated(machine: MachineConfig) -> tuple[Connection, SimulatedBoard]:
    """A connection to a simulated board for the machine, identified and configured, and the board
    itself, to look at. Raises MachineError."""
    board = board_description(machine)
    simulated = simulated_board(machine, board)
    return _connected(board, InProcess(simulated.device)), simulated


def connect(machine: MachineConfig) -> tuple[Connection, SimulatedBoard | None]:
    """A connection to the board that the machine file names, identified and configured, and the
    board itself where it is simulated. A board that has outlived another host is adopted. Raises
    MachineError."""
    board = machine.board
    if board.link == "simulated":
        return connect_simulated(machine)
    place = board.port or ""
    if board.link == "serial":
        port = serial_port(place, board.baud)
    else:
        host, _, number = place.rpartition(":")
        port = tcp_port(host.strip("[]"), int(number))
    return _connected(board_description(machine), port, adopt=True), None


def reconnected(old: Connection) -> Connection:
    """A new connection to the board of `old`, which is reset. Raises MachineError."""
    return _connected(old.board, old.port)


def _connected(board: BoardDescription, port: Port, *, adopt: bool = False) -> Connection:
    connection = Connection(board, port)
    connection.connect(adopt=adopt)
    return connection
