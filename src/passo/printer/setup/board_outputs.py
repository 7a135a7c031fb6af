"""The descriptions of a board's outputs, from a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.board.description import Kick, Output, bare
from passo.config.lights import Led, led_outputs
from passo.config.outputs import first_name, timed_name
from passo.config.pin_names import named_on, placed
from passo.config.probing import SERVO
from passo.config.servos import SERVO_CYCLE_S, servo_output
from passo.printer.commands.beeper import most_ticks
from passo.printer.setup.drivers import microstep_outputs

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.config.outputs import Output as OutputConfig

MAX_DURATION_S = 3.0  # the host must renew a heater within this time, or the board shuts down


def outputs_of(machine: MachineConfig) -> list[tuple[str, str]]:
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


def output_of(machine: MachineConfig, name: str, written: str, clock_hz: int) -> Output:
    """The description of an output by its name and its pin as written."""
    pin, own = machine.pin(written), first_name(name)
    longest = round(MAX_DURATION_S * clock_hz)
    if own in machine.heaters:
        cycle = round(clock_hz / machine.heaters[own].pwm_hz)
        return Output(name, pin, "digital", cycle, longest)
    fans = {machine.fan_output(fan): part for fan, part in machine.fans.items()}
    if (fan := fans.get(own)) is not None:
        ticks = round(fan.kick_start_s * clock_hz)
        kick = Kick(ticks, fan.max_power, fan.kick_start_rise) if ticks > 0 else None
        return Output(name, pin, "digital", round(clock_hz / fan.pwm_hz), kick=kick)
    if name == "laser":
        return Output(name, pin, "pwm", round(0.001 * clock_hz), longest)
    if name == "beeper":
        config = machine.all_boards[placed(written)[0]]
        return Output(name, pin, "digital", round(clock_hz / 1000), most_ticks(config))
    if name == SERVO or name in map(servo_output, machine.servos):
        return Output(name, pin, "digital", round(clock_hz * SERVO_CYCLE_S))
    if name.startswith("status-led"):
        return Output(name, pin, cycle_ticks=clock_hz, blinks=True)
    for lamp, light in machine.lights.items():
        if isinstance(light, Led) and name in led_outputs(lamp, light):
            hardware = light.pwm == "hardware"
            kind = "pwm" if hardware else "digital"
            return Output(name, pin, kind, round(clock_hz / light.pwm_hz))
    free = {timed_name(part): output for part, output in machine.outputs.items()}.get(own)
    return Output(name, pin, "digital") if free is None else _free(name, pin, free, clock_hz)


def _free(name: str, pin: str, output: OutputConfig, clock_hz: int) -> Output:
    """An output for SET_PIN. A value between off and on that the board cannot have from the start
    is set after it."""
    hardware = output.pwm == "hardware"
    return Output(
        name,
        pin,
        "pwm" if hardware else "digital",
        0 if output.pwm == "none" else round(clock_hz / output.pwm_hz),
        round(output.max_on_s * clock_hz),
        start=output.start if hardware or output.start == 1.0 else 0.0,
        at_halt=output.at_halt,
    )


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
