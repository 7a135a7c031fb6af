"""Makes the descriptions of the boards from a machine file."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from passo.board.description import BoardDescription, Counter, Endstop, Heater, Stepper
from passo.config.pin_names import MAIN, placed
from passo.heat.control import arrival_of, control_of, limits_of, model_of
from passo.motion.endstops import endstop_pins, inputs
from passo.printer.setup.board_inputs import analog_inputs_of, inputs_of
from passo.printer.setup.board_outputs import output_of, outputs_of
from passo.printer.setup.drivers import accelerometers, current_settings, drivers, eddies
from passo.printer.setup.lights import lights_of
from passo.printer.setup.sensors import i2c_sensors_of, sensor_of, shown_sensors

if TYPE_CHECKING:
    from passo.config.heat import Heater as HeaterConfig
    from passo.config.machine import MachineConfig


def board_description(machine: MachineConfig, board: str = MAIN) -> BoardDescription:
    """A board with its motors, heaters, fans and the laser. Message targets count the machine's
    steppers in the order of `core_spec()`, its outputs in the order of `outputs_of`."""
    config = machine.all_boards[board]
    clock_hz = config.clock_hz
    steppers = [
        (i, _stepper(machine, s, clock_hz))
        for i, s in enumerate(machine.core_spec()["steppers"])
        if machine.board_of_stepper(s["name"]) == board
    ]
    outputs = [
        (i, output_of(machine, name, pin, clock_hz))
        for i, (name, pin) in enumerate(outputs_of(machine))
        if placed(pin)[0] == board
    ]
    heaters = {n: h for n, h in machine.heaters.items() if placed(h.pin)[0] == board}
    return BoardDescription(
        clock_hz=clock_hz,
        steppers=tuple(s for _, s in steppers),
        outputs=tuple(o for _, o in outputs),
        sensors=(
            *(sensor_of(machine, n, h) for n, h in heaters.items()),
            *shown_sensors(machine, board),
        ),
        heaters=tuple(_heater(machine, n, h) for n, h in heaters.items()),
        endstops=tuple(
            Endstop(name, machine.pin(pin))
            for name, pin in endstop_pins(machine).items()
            if placed(pin)[0] == board
        ),
        drivers=tuple(d for d in drivers(machine) if machine.board_of_stepper(d.stepper) == board),
        settings=tuple(current_settings(machine, board)),
        accelerometers=tuple(accelerometers(machine, board)),
        eddies=tuple(eddies(machine, board)),
        inputs=tuple(inputs_of(machine, board)),
        analog_inputs=tuple(analog_inputs_of(machine, board)),
        counters=tuple(
            Counter(name, machine.pin(tachometer.pin), tachometer.poll_ms / 1000)
            for name, fan in machine.fans.items()
            if (tachometer := fan.tachometer) and placed(tachometer.pin)[0] == board
        ),
        lights=tuple(lights_of(machine, board)),
        i2c_sensors=tuple(i2c_sensors_of(machine, board)),
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


def _heater(machine: MachineConfig, name: str, heater: HeaterConfig) -> Heater:
    return Heater(
        name,
        output=name,
        further=tuple(pin for pin, _ in machine.further_pins.get(name, ())),
        sensor=name,
        control=control_of(heater),
        limits=limits_of(heater),
        model=model_of(heater),
        fan=machine.fan_output(heater.fan) if heater.fan else None,
        max_power=heater.max_power,
        arrival=arrival_of(heater),
    )


def _driver_pins(machine: MachineConfig, name: str) -> tuple[str, str]:
    """Step and direction pin of a motor."""
    stepper, socket = machine.steppers[name], machine.socket(name)
    step = stepper.step_pin or (socket.step if socket else f"{name}_step")
    direction = stepper.direction_pin or (socket.direction if socket else f"{name}_dir")
    return machine.pin_of_stepper(name, step), machine.pin_of_stepper(name, direction)
