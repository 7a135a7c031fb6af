"""Makes the descriptions of the boards from a machine file."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from passo.board.description import (
    BoardDescription,
    Endstop,
    Heater,
    Input,
    Kick,
    Output,
    Sensor,
    Stepper,
    bare,
)
from passo.config.pin_names import MAIN, named_on, placed
from passo.config.probing import SERVO, SERVO_CYCLE_S
from passo.config.sensor_tables import (
    converter_of,
    converter_setup,
    open_is_high,
    sensor_table,
    share_at,
)
from passo.heat.control import arrival_of, control_of, limits_of, model_of
from passo.motion.endstops import inputs
from passo.printer.commands.beeper import most_ticks
from passo.printer.setup.drivers import (
    accelerometers,
    converter_wires,
    current_settings,
    drivers,
    microstep_outputs,
)

if TYPE_CHECKING:
    from passo.config.heat import Heater as HeaterConfig
    from passo.config.machine import MachineConfig

MAX_DURATION_S = 3.0  # the host must renew a heater within this time, or the board shuts down


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
        inputs=tuple(
            Input(name, machine.pin(pin))
            for name, pin in machine.input_pins.items()
            if placed(pin)[0] == board
        ),
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
