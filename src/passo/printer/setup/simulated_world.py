"""Makes the simulated printer of a machine file: its boards, mechanics, heat and bed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import exp, inf
from typing import TYPE_CHECKING

from passo import _core
from passo.board.description import BoardDescription
from passo.config.inputs import button_input, sensor_input, width_inputs
from passo.config.pin_names import MAIN
from passo.config.probing import PROBE, SERVO
from passo.config.simulated_motion import simulated_masses
from passo.geometry.delta import Delta
from passo.levelling.least_squares import solve
from passo.motion.endstops import (
    Switch,
    is_actuator,
    motors_of_actuators,
    motors_of_extruders,
    pressed_point,
    steppers_of,
    switches,
    weights_of,
)
from passo.printer.setup.board_inputs import width_share
from passo.probes.base import SensingProbe
from passo.probes.eddy import EddyPoint, EddyProbe

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.geometry.base import GeometryModel
    from passo.simulator import (
        Actuator,
        Bed,
        BedProbe,
        Cable,
        FilamentInSensor,
        InputSwitch,
        Lift,
        SimulatedBoard,
        SimulatedMachine,
    )

_AWAY = 20.0  # mm or degrees
_ASKEW = 0.5
# The frequency of a usual coil falls by 31 kHz in the first millimetre.
_USUAL_COIL = [
    EddyPoint(mm=round(0.1 * i, 1), hz=round(3_218_000 + 68_000 * exp(-0.1 * i / 2.2), 3))
    for i in range(81)
]
_EDGES = 4  # edges of a simulated motion sensor in its `length_mm`


def simulated_board(
    machine: MachineConfig, board: BoardDescription, name: str = MAIN
) -> SimulatedBoard:
    """The simulated board `name` of a machine file, with its part of mechanics and heat."""
    from passo.simulator import (
        Air,
        Body,
        PlantDescription,
        Rotor,
        SimulatedBoard,
        StallPin,
        TravelStop,
    )
    from passo.simulator import Switch as PlantSwitch

    own, wired = {e.name for e in (*board.endstops, *board.eddies)}, {i.name for i in board.inputs}
    plant = PlantDescription(
        actuators=tuple(
            a for a in _actuators(machine) if a.stepper in {s.name for s in board.steppers}
        ),
        switches=tuple(
            PlantSwitch(s.name, weights, _felt_at(machine, s, weights), _at_maximum(machine, s))
            for s in switches(machine)
            for weights in (weights_of(machine, s),)
            if s.name in own and not s.watched
        ),
        stops=tuple(
            TravelStop(weights, _felt_at(machine, s, weights), _at_maximum(machine, s))
            for s in switches(machine)
            for weights in (weights_of(machine, s),)
            if s.name in own and s.watched
        ),
        stall_pins=tuple(
            StallPin(motor, machine.pin(pin), int(key == "diag1_pin"))
            for motor, key, pin in _stall_pins(machine)
            if motor in {s.name for s in board.steppers}
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
        airs=tuple(Air(s.name, machine.sensors[s.name].ambient_c) for s in board.shown),
        rotors=tuple(
            Rotor(name, machine.fan_output(name), tachometer.simulated_rpm, tachometer.pulses)
            for name in (counter.name for counter in board.counters)
            if (tachometer := machine.fans[name].tachometer)
        ),
        probe=_bed_probe(machine) if PROBE in own else None,
        inputs=tuple(i for i in _input_switches(machine) if i.name in wired),
        widths=tuple(_widths(machine, board)),
    )
    runs = "passo" if machine.all_boards[name].survives else "virtual"
    return SimulatedBoard(board, plant, firmware=runs)


def _stall_pins(machine: MachineConfig) -> Iterator[tuple[str, str, str]]:
    """Each motor whose stall detection homes an axis, with the key of its pin and the pin."""
    for motor in dict.fromkeys(m for s in switches(machine) for m in s.watched):
        tmc = machine.steppers[motor].tmc
        if tmc is not None and tmc.stall_pin is not None:
            yield motor, tmc.stall_key, tmc.stall_pin


def _input_switches(machine: MachineConfig) -> Iterator[InputSwitch]:
    """What is wired to the inputs of the simulated printer: filament of a given length, and buttons
    that are not pressed."""
    from passo.simulator import InputSwitch

    motors = dict(zip(machine.extruders, motors_of_extruders(machine), strict=True))
    for name, part in machine.filament_sensors.items():
        if part.width is not None:
            continue
        motor = motors[part.extruder] if part.extruder else next(iter(motors.values()), None)
        weights = ((motor, 1.0),) if motor else ()
        edge_mm = part.length_mm / _EDGES if part.kind == "motion" else 0.0
        length_mm = machine.simulated.filament_mm.get(name, inf)
        yield InputSwitch(sensor_input(name), weights, length_mm, active=False, edge_mm=edge_mm)
    for name, button in machine.buttons.items():
        if button.resistance_ohm is None:
            yield InputSwitch(button_input(name))


def _widths(machine: MachineConfig, board: BoardDescription) -> Iterator[FilamentInSensor]:
    from passo.simulator import FilamentInSensor

    own = {entry.name for entry in board.analog_inputs}
    for name, part in machine.filament_sensors.items():
        inputs = tuple(width_inputs(name, part))
        if inputs and own >= {*inputs}:
            shares = width_share(part, 0.0), width_share(part, 1.0)
            yield FilamentInSensor(sensor_input(name), inputs, *shares)


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
        simulated.probe.coil_c,
        _coil_curve(probe),
        _lifts(machine),
    )


def with_calibrated_probe(machine: MachineConfig) -> MachineConfig:
    """The same machine; an eddy current probe without a calibration has that of its simulated
    coil."""
    probe = machine.probe
    if not isinstance(probe, EddyProbe) or probe.calibration:
        return machine
    calibrated = probe.model_copy(update={"calibration": _USUAL_COIL})
    return machine.model_copy(update={"probe": calibrated})


def _coil_curve(probe: SensingProbe) -> tuple[tuple[float, float], ...]:
    """The simulated coil is as the machine file calibrates it, or a usual one."""
    points = (probe.calibration or _USUAL_COIL) if isinstance(probe, EddyProbe) else []
    return tuple(sorted((point.mm, point.hz) for point in points))


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
        if s["drive"] == "actuator" and (machine.homing or not machine.geometry.homes):
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
