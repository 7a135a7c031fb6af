"""Makes the descriptions of the boards, and connections to them, from a machine file."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.board.boards import Boards
from passo.board.connection import Connection
from passo.board.description import (
    BoardDescription,
    Endstop,
    Heater,
    Kick,
    Output,
    Sensor,
    Stepper,
    bare,
)
from passo.board.ports import Port, in_process, serial_port, tcp_port
from passo.config.pin_names import MAIN, named_on, placed
from passo.config.probing import PROBE, SERVO, SERVO_CYCLE_S
from passo.config.sensor_tables import (
    converter_of,
    converter_setup,
    open_is_high,
    sensor_table,
    share_at,
)
from passo.config.simulated_motion import simulated_masses
from passo.geometry.delta import Delta
from passo.heat.control import arrival_of, control_of, limits_of, model_of
from passo.levelling.least_squares import solve
from passo.motion.endstops import (
    Switch,
    inputs,
    is_actuator,
    motors_of_actuators,
    motors_of_extruders,
    pressed_point,
    steppers_of,
    switches,
    weights_of,
)
from passo.printer.commands.beeper import most_ticks
from passo.printer.setup.drivers import (
    accelerometers,
    converter_wires,
    current_settings,
    drivers,
    microstep_outputs,
)
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.heat import Heater as HeaterConfig
    from passo.config.machine import MachineConfig
    from passo.geometry.base import GeometryModel
    from passo.simulator import (
        Actuator,
        Bed,
        BedProbe,
        Cable,
        Lift,
        SimulatedBoard,
        SimulatedMachine,
    )

_log = logging.getLogger(__name__)

MAX_DURATION_S = 3.0  # the host must renew a heater within this time, or the board shuts down
_AWAY = 20.0  # mm or degrees
_ASKEW = 0.5


def board_description(machine: MachineConfig, board: str = MAIN) -> BoardDescription:
    """A board with its motors, heaters, fans and the laser. Message targets count the machine's
    steppers in the order of `core_spec()`, its outputs in the order of `_outputs`."""
    config = machine.all_boards[board]
    clock_hz = config.clock_hz
    steppers = [
        (i, _stepper(machine, s, clock_hz))
        for i, s in enumerate(machine.core_spec()["steppers"])
        if machine.board_of_stepper(s["name"]) == board
    ]
    outputs = [
        (i, _output(machine, name, pin, clock_hz))
        for i, (name, pin) in enumerate(_outputs(machine))
        if placed(pin)[0] == board
    ]
    heaters = {n: h for n, h in machine.heaters.items() if placed(h.pin)[0] == board}
    return BoardDescription(
        clock_hz=clock_hz,
        steppers=tuple(s for _, s in steppers),
        outputs=tuple(o for _, o in outputs),
        sensors=tuple(sensor_of(machine, n, h) for n, h in heaters.items()),
        heaters=tuple(_heater(n, h) for n, h in heaters.items()),
        endstops=tuple(
            Endstop(s.name, machine.pin(s.pin))
            for s in inputs(machine)
            if placed(s.pin)[0] == board
        ),
        drivers=tuple(d for d in drivers(machine) if machine.board_of_stepper(d.stepper) == board),
        settings=tuple(current_settings(machine, board)),
        accelerometers=tuple(accelerometers(machine, board)),
        move_count=config.move_count,
        mcu=config.mcu,
        survives=config.survives,
        endstops_elsewhere=tuple(
            s.name
            for s in inputs(machine)
            if placed(s.pin)[0] != board and any(m.name in s.steppers for _, m in steppers)
        ),
        stepper_targets=tuple(i for i, _ in steppers),
        output_targets=tuple(i for i, _ in outputs),
    )


def board_descriptions(machine: MachineConfig) -> dict[str, BoardDescription]:
    """All boards of the machine, the main one first."""
    return {name: board_description(machine, name) for name in machine.all_boards}


def _stepper(machine: MachineConfig, spec: dict[str, Any], clock_hz: int) -> Stepper:
    def ticks(seconds: float) -> int:
        return max(1, ceil(seconds * clock_hz - 1e-6))  # 30 µs are 1620 ticks of 54 MHz

    pulse = ticks(spec["pulse_s"])
    return Stepper(
        spec["name"],
        *_driver_pins(machine, spec["name"]),
        invert=spec["invert"],
        pulse_ticks=pulse,
        apart_ticks=max(2 * pulse, ticks(1 / spec["max_rate_hz"])),
        turning_ticks=pulse + ticks(spec["dir_setup_s"]) + ticks(spec["dir_hold_s"]),
    )


def _outputs(machine: MachineConfig) -> list[tuple[str, str]]:
    """All outputs and their pins as written, by number: those on the timeline, then enable pins of
    motors, microstep pins, status LEDs of boards, the power supply, the beeper, and the servo of
    the probe."""
    outputs = list(machine.timed_outputs.items())
    for name, output in enable_outputs(machine).items():
        if output == f"{name}-enable":
            outputs.append((output, str(enable_pin(machine, name))))
    outputs += microstep_outputs(machine)
    for name, board in machine.all_boards.items():
        if board.status_led:
            led = f"status-led-{name}" if name else "status-led"
            outputs.append((led, named_on(name, board.status_led)))
    if machine.mains:
        outputs.append(("mains", machine.mains.pin))
    if machine.beeper:
        outputs.append(("beeper", machine.beeper.pin))
    if machine.probe and (pin := machine.probe.servo_pin):
        outputs.append((SERVO, pin))
    return outputs


def _output(machine: MachineConfig, name: str, written: str, clock_hz: int) -> Output:
    pin = machine.pin(written)
    longest = round(MAX_DURATION_S * clock_hz)
    if name in machine.heaters:
        cycle = round(clock_hz / machine.heaters[name].pwm_hz)
        return Output(name, pin, "digital", cycle, longest)
    if name in machine.fans:
        fan = machine.fans[name]
        ticks = round(fan.kick_start_s * clock_hz)
        kick = Kick(ticks, fan.max_power, fan.kick_start_rise) if ticks > 0 else None
        return Output(name, pin, "digital", round(clock_hz / fan.pwm_hz), kick=kick)
    if name == "laser":
        return Output(name, pin, "pwm", round(0.001 * clock_hz), longest)
    if name == "beeper":
        config = machine.all_boards[placed(written)[0]]
        return Output(name, pin, "digital", round(clock_hz / 1000), most_ticks(config))
    if name == SERVO:
        return Output(name, pin, "digital", round(clock_hz * SERVO_CYCLE_S))
    if name.startswith("status-led"):
        return Output(name, pin, cycle_ticks=clock_hz, blinks=True)
    return Output(name, pin, "digital")


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
        arrival=arrival_of(heater),
    )


def sensor_of(machine: MachineConfig, name: str, heater: HeaterConfig) -> Sensor:
    """The description of a heater's sensor; also used for `Connection.set_sensor`."""
    table = sensor_table(heater.sensor)
    low, high = sorted((share_at(table, heater.min_c), share_at(table, heater.max_c)))
    pin = machine.pin(heater.sensor_pin)
    sensor, setup = heater.sensor, converter_setup(heater.sensor)
    return Sensor(
        name,
        pin,
        table,
        low,
        high,
        open_is_high(sensor),
        converter_of(sensor),
        converter_wires(machine, heater),
        setup.words,
        setup.clears_faults,
    )


def _driver_pins(machine: MachineConfig, name: str) -> tuple[str, str]:
    """Step and direction pin of a motor."""
    stepper, socket = machine.steppers[name], machine.socket(name)
    step = stepper.step_pin or (socket.step if socket else f"{name}_step")
    direction = stepper.direction_pin or (socket.direction if socket else f"{name}_dir")
    return machine.pin_of_stepper(name, step), machine.pin_of_stepper(name, direction)


def enable_outputs(machine: MachineConfig) -> dict[str, str]:
    """The output that enables each motor, for those that have one. Motors may share an output,
    which has the name of the first motor."""
    by_pin: dict[str, str] = {}
    outputs: dict[str, str] = {}
    for name in machine.steppers:
        pin = enable_pin(machine, name)
        if pin is not None:
            outputs[name] = by_pin.setdefault(bare(pin), f"{name}-enable")
    return outputs


def enable_pin(machine: MachineConfig, name: str) -> str | None:
    """The enable pin of a motor on the microcontroller, with the name of its board; None if it has
    none."""
    stepper, socket = machine.steppers[name], machine.socket(name)
    pin = stepper.enable_pin or (socket.enable if socket else None)
    if pin is None:
        return None
    return named_on(machine.board_of_stepper(name), machine.pin_of_stepper(name, pin))


def simulated_board(
    machine: MachineConfig, board: BoardDescription, name: str = MAIN
) -> SimulatedBoard:
    """The simulated board `name` of a machine file, with its part of mechanics and heat."""
    from passo.simulator import Body, PlantDescription, SimulatedBoard
    from passo.simulator import Switch as PlantSwitch

    own = {e.name for e in board.endstops}
    plant = PlantDescription(
        actuators=tuple(
            a for a in _actuators(machine) if a.stepper in {s.name for s in board.steppers}
        ),
        switches=tuple(
            PlantSwitch(s.name, weights, _felt_at(machine, s, weights), _at_maximum(machine, s))
            for s in switches(machine)
            for weights in (weights_of(machine, s),)
            if s.name in own
        ),
        bodies=tuple(
            Body(
                heater.name,
                simulated.full_power_rise_c,
                simulated.time_constant_s,
                simulated.sensor_time_constant_s,
                fan=heater.fan,
                fan_loss=simulated.fan_loss,
            )
            for heater in board.heaters
            for simulated in (machine.heaters[heater.name].simulated,)
        ),
        probe=_bed_probe(machine) if PROBE in own else None,
    )
    runs = "passo" if machine.all_boards[name].survives else "virtual"
    return SimulatedBoard(board, plant, firmware=runs)


def simulated_geometry(machine: MachineConfig) -> GeometryModel:
    """The geometry of the simulated printer: that of the machine file, unless its table `simulated`
    gives another one."""
    geometry, true = machine.geometry, machine.simulated.delta
    if true is None or not isinstance(geometry, Delta):
        return geometry
    parts = {"radius": true.radius, "rods": true.rods, "angles": true.angles}
    given = {name: part for name, part in parts.items() if part is not None}
    return geometry.model_copy(update=given)


def _simulated_home(machine: MachineConfig, name: str) -> float:
    """The real position of an axis or actuator at its endstop."""
    true = machine.simulated.delta
    if true is None or true.endstops is None or not is_actuator(machine, name):
        return machine.homing[name].position
    return true.endstops[machine.geometry.actuators.index(name)]


def simulated_bed(machine: MachineConfig) -> Bed:
    """The bed of the simulated printer."""
    from passo.simulator import Bed

    bed = machine.simulated.bed
    (rise_x, rise_y), (wave_x, wave_y) = bed.tilt_mm, bed.wave_length_mm
    return Bed(
        machine.bed_area_mm,
        (rise_x, rise_y),
        bed.dome_mm,
        bed.wave_mm,
        (wave_x, wave_y),
        bed.height_mm,
    )


def home_errors_mm(machine: MachineConfig) -> dict[str, float]:
    """The real position of each motor of the simulated printer after homing, minus its position in
    the plan, mm or degrees. It follows from the true geometry and endstops, and from the bed if the
    probe homes Z."""
    errors = dict.fromkeys(machine.steppers, 0.0)
    for name, homing in machine.homing.items():
        for stepper in steppers_of(machine, name) if is_actuator(machine, name) else ():
            errors[stepper] += _simulated_home(machine, name) - homing.position
        for stepper in homing.stepper_pins:
            at_mm = machine.simulated.endstops_mm.get(stepper, 0.0)
            errors[stepper] += at_mm - homing.offsets_mm.get(stepper, 0.0)
    if machine.probe is not None and (z := machine.homing.get("z")) is not None and z.probe:
        x, y = machine.probe_home_mm
        for stepper in steppers_of(machine, "z"):
            errors[stepper] += simulated_bed(machine).shape.height(x, y)
    return errors


def nozzle_gap(
    machine: MachineConfig, board: SimulatedMachine
) -> tuple[_core.NozzleGap, tuple[str, ...]]:
    """Returns the object that follows the distance of the nozzle from the simulated bed, and the
    motors that it observes. Call it before any motor moves."""
    lifts = _lifts(machine)
    motors = motors_of_actuators(machine)
    motors += tuple(lift.stepper for lift in lifts if lift.stepper not in motors)
    gap = _core.NozzleGap(
        machine.board.clock_hz,
        simulated_geometry(machine).spec(),
        simulated_bed(machine).shape,
        [board.motor(name) for name in motors],
        [(motors.index(lift.stepper), lift.weight) for lift in lifts],
    )
    return gap, motors


def head_dynamics(machine: MachineConfig, board: SimulatedMachine) -> _core.HeadDynamics:
    """Returns the object that follows how the head of the simulated printer really moves, and what
    its nozzles extrude. It follows nothing until its `follow` is called."""
    masses = simulated_masses(machine.geometry.kind, machine.simulated.masses)
    x, y, z = ((mass.frequency_hz, mass.damping) for mass in masses)
    motors = motors_of_actuators(machine) + motors_of_extruders(machine)
    return _core.HeadDynamics(
        machine.board.clock_hz,
        simulated_geometry(machine).spec(),
        (x, y, z),
        [machine.simulated.nozzle_pressure_s] * len(machine.extruders),
        [board.motor(name) for name in motors],
    )


def _bed_probe(machine: MachineConfig) -> BedProbe | None:
    from passo.simulator import BedProbe

    probe, simulated = machine.probe, machine.simulated
    if not isinstance(probe, SensingProbe):
        return None
    dx, dy = probe.offset_mm
    stuck = simulated.probe.stuck
    return BedProbe(
        PROBE,
        motors_of_actuators(machine),
        simulated_geometry(machine).spec(),
        simulated_bed(machine),
        (dx, dy),
        probe.trigger_height_mm,
        simulated.probe.hysteresis_mm,
        simulated.bed.noise_mm,
        simulated.bed.seed,
        None if stuck is None else stuck == "triggered",
        tuple(_corners(area) for area in simulated.probe.dead_areas),
        tuple(_corners(area) for area in simulated.probe.touchy_areas),
        probe.mechanism,
        SERVO if probe.servo_pin else None,
        simulated.probe.jammed,
        _lifts(machine),
    )


def _lifts(machine: MachineConfig) -> tuple[Lift, ...]:
    """The Z motors as carriers of the gantry, if the file gives their pivots: each motor determines
    Z at its pivot."""
    from passo.simulator import Lift

    motors = machine.levelling.motors
    if motors is None:
        return ()
    pivots = [(x, y) for x, y in motors.pivots.values()]
    if len(pivots) == 2:
        (x0, y0), (x1, y1) = pivots
        dx, dy = x1 - x0, y1 - y0
        square = dx * dx + dy * dy
        second = (-(x0 * dx + y0 * dy) / square, dx / square, dy / square, 0.0)
        first = (1 - second[0], -second[1], -second[2], 0.0)
        weights = [first, second]
    else:
        rows = [[1.0, x, y, x * y][: len(pivots)] for x, y in pivots]
        unit = [[float(i == k) for i in range(len(pivots))] for k in range(len(pivots))]
        found = [[*solve(rows, values), 0.0] for values in unit]
        weights = [(c[0], c[1], c[2], c[3]) for c in found]
    named = zip(motors.pivots, weights, strict=True)
    return tuple(Lift(name, weight) for name, weight in named)


def _corners(area: Sequence[float]) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = area
    return x0, y0, x1, y1


def _actuators(machine: MachineConfig) -> tuple[Actuator, ...]:
    """The actuators of a simulated machine. At the start they are a little away from their
    endstops, and skewed if an axis has two motors with an endstop each."""
    from passo.simulator import Actuator

    geometry = machine.geometry.square
    q = list(geometry.inverse(machine.home_point))
    point = list(machine.home_point)
    for name, homing in machine.homing.items():
        away = -_AWAY if homing.direction == "max" else _AWAY
        if machine.axes_of_arms and name in geometry.actuators:
            q[geometry.actuators.index(name)] += away
        elif name in "xyz":
            point["xyz".index(name)] += away
    if not machine.axes_of_arms:
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
    """The weighted sum of positions at which the endstop triggers."""
    if is_actuator(machine, switch.home) or len(weights) == 1:
        off_mm = machine.simulated.endstops_mm.get(switch.name, 0.0)
        return _simulated_home(machine, switch.home) + off_mm
    q = machine.geometry.square.inverse(pressed_point(machine, switch))
    total = 0.0
    for name, weight in weights:
        driven = machine.driven_by(name)
        total += weight * q[driven.index] if driven else 0.0
    return total


def _at_maximum(machine: MachineConfig, switch: Switch) -> bool:
    return machine.homing[switch.home].direction == "max"


def connect_simulated(
    machine: MachineConfig, cable: Cable | None = None
) -> tuple[Boards, SimulatedMachine]:
    """Connections to simulated boards for the machine, identified and configured, and the boards
    themselves, for tests. Only boards with a `cable`, even a perfect one, can have faults of the
    link. Raises MachineError."""
    from passo.simulator import without_buses

    boards = {name: without_buses(b) for name, b in board_descriptions(machine).items()}
    simulated = simulated_machine(machine, boards, cable)
    ports = in_process([simulated.devices[name] for name in boards])
    connected = _connected(boards, ports)
    if cable is not None:
        from passo.simulator import SimulatedFaults

        connected.injector = SimulatedFaults(simulated)
    return connected, simulated


def simulated_machine(
    machine: MachineConfig, boards: dict[str, BoardDescription], cable: Cable | None = None
) -> SimulatedMachine:
    """All simulated boards of a machine; the file gives the clocks of further boards."""
    from passo.simulator import SimulatedMachine

    simulated = SimulatedMachine(
        {name: simulated_board(machine, board, name) for name, board in boards.items()},
        {name: (config.start_s, config.drift_ppm) for name, config in machine.boards.items()},
        cable,
    )
    if machine.accelerometer is not None:
        simulated.carry_accelerometers(head_dynamics(machine, simulated))
    return simulated


def connect(machine: MachineConfig) -> tuple[Boards, SimulatedMachine | None]:
    """Connections to the boards that the machine file names, identified and configured, and the
    boards themselves if they are simulated. A board that has survived the loss of another host is
    adopted. Raises MachineError."""
    if machine.board.link == "simulated":
        from passo.simulator import Cable

        return connect_simulated(machine, Cable())
    ports = [_port(board) for board in machine.all_boards.values()]
    return _connected(board_descriptions(machine), ports, adopt=True), None


def _port(board: Board) -> Port:
    place = board.port or ""
    if board.link == "serial":
        paced = board.console is not None and board.console.connector == "serial"
        return serial_port(place, board.baud, paced=paced)
    host, _, number = place.rpartition(":")
    return tcp_port(host.strip("[]"), int(number))


def reconnected(old: Boards) -> Boards:
    """New connections to the boards of `old`, which are reset. Raises MachineError."""
    ports = [connection.port for connection in old.connections]
    connected = _connected({c.name: c.board for c in old.connections}, ports)
    connected.injector = old.injector
    return connected


def _connected(
    boards: dict[str, BoardDescription], ports: Sequence[Port], *, adopt: bool = False
) -> Boards:
    named = zip(boards.items(), ports, strict=True)
    connected = Boards([Connection(board, port, name) for (name, board), port in named])
    connected.connect(adopt=adopt)
    for connection in connected.connections:
        _log.info(
            "Board %s connected: firmware %s, %g MHz, %d move commands%s",
            *(connection.name or "main", connection.dictionary.version or "unknown"),
            *(connection.board.clock_hz / 1e6, connection.move_count),
            ", as another host left it" if connection.adopted else "",
        )
    return connected
