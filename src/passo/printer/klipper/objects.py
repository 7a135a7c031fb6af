"""Klipper's objects of a printer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from passo.config.klipper_names import (
    board_object,
    chip_object,
    driver_object,
    fan_object,
    heater_object,
    light_object,
    number_of,
    sensor_object,
    stepper_object,
    temperature_object,
)
from passo.config.servos import share_of
from passo.printer.klipper.bed import bed_mesh, levelled, manual_probe, probe, screws_tilt_adjust
from passo.printer.klipper.configfile import configfile
from passo.printer.klipper.heat import (
    extruder,
    fan,
    heater,
    heaters,
    i2c_sensor,
    light,
    output_pin,
    temperature_fan,
    temperature_sensor,
)
from passo.printer.klipper.job import (
    display_status,
    exclude_object,
    idle_timeout,
    pause_resume,
    print_stats,
    virtual_sdcard,
)
from passo.printer.klipper.machine import filament_sensor, mcu, webhooks
from passo.printer.klipper.motion import (
    driver,
    firmware_retraction,
    gcode_move,
    input_shaper,
    motion_report,
    stepper_enable,
    toolhead,
)

if TYPE_CHECKING:
    from passo.config.exporting.settings import Sections
    from passo.config.machine import MachineConfig
    from passo.printer.status import Status

Object = dict[str, Any]
Objects = dict[str, Callable[[], Object]]
Variables = Mapping[str, Mapping[str, object]]


def objects(
    machine: MachineConfig, sections: Sections, status: Status, variables: Variables
) -> Objects:
    """For each object of a printer, by name, a function that computes it. `sections` are those of
    the machine; `variables` maps the name of a macro to the variables of the macro."""
    found: Objects = {
        "webhooks": lambda: webhooks(status),
        "configfile": lambda: configfile(sections, status.files.folder, status.unsaved),
        "toolhead": lambda: toolhead(machine, status),
        "gcode_move": lambda: gcode_move(status),
        "motion_report": lambda: motion_report(machine, status),
        "stepper_enable": lambda: stepper_enable(machine, status),
        "heaters": lambda: heaters(machine),
        "print_stats": lambda: print_stats(status),
        "virtual_sdcard": lambda: virtual_sdcard(status),
        "pause_resume": lambda: pause_resume(status),
        "display_status": lambda: display_status(status),
        "idle_timeout": lambda: idle_timeout(machine, status),
        "exclude_object": lambda: exclude_object(status),
        "save_variables": lambda: {"variables": dict(status.saved_variables)},
    }
    bed = status.bed
    if bed is not None:
        found["bed_mesh"] = lambda: bed_mesh(bed)
        found["probe"] = lambda: probe(bed)
        found["manual_probe"] = lambda: manual_probe(bed)
    motors = machine.levelling.motors
    if motors is not None:
        name = "quad_gantry_level" if len(motors.pivots) == 4 else "z_tilt"
        found[name] = lambda: levelled(status)
    if status.skew_profile is not None:
        found["skew_correction"] = lambda: {"current_profile_name": status.skew_profile}
    if machine.levelling.screws is not None:
        found["screws_tilt_adjust"] = lambda: screws_tilt_adjust(status)
    for name, part in machine.heaters.items():
        shown = heater_object(machine, name)
        if part.kind == "hotend":
            number = number_of(shown)
            found[shown] = lambda name=name, number=number: extruder(status, name, number)
        else:
            found[shown] = lambda name=name: heater(status, name)
    retraction = status.retraction
    if retraction is not None:
        found["firmware_retraction"] = lambda: firmware_retraction(retraction)
    if status.shapers:
        found["input_shaper"] = lambda: input_shaper(status)
    for name in machine.fans:
        found[fan_object(machine, name)] = (
            (lambda name=name: temperature_fan(machine, status, name))
            if name in status.fan_targets_c
            else (lambda name=name: fan(status, name))
        )
    for name in status.outputs:
        found[f"output_pin {name}"] = lambda name=name: output_pin(status, name)
    for name, width_us in status.servos_us.items():
        found[f"servo {name}"] = lambda us=width_us: {"value": share_of(us)}
    for name in status.lights:
        found[light_object(machine, name)] = lambda name=name: light(status, name)
    for name in status.sensors:
        shown = temperature_object(machine, name)
        if shown not in found:  # that of a fan shows its sensor
            found[shown] = lambda name=name: temperature_sensor(status, name)
        if (chip := chip_object(machine, name)) is not None:
            found[chip] = lambda name=name: i2c_sensor(status, name)
    for name, sensor in status.filament_sensors.items():
        found[sensor_object(machine, name)] = lambda sensor=sensor: filament_sensor(sensor)
    for name, pressed in status.buttons.items():
        found[f"gcode_button {name}"] = lambda pressed=pressed: {
            "state": "PRESSED" if pressed else "RELEASED"
        }
    for name, part in status.drivers.items():
        found[driver_object(part.chip, stepper_object(machine, name))] = lambda name=name: driver(
            status, name
        )
    for name in status.boards:
        found[board_object(name)] = lambda name=name: mcu(status, name)
    for name, values in variables.items():
        found[f"gcode_macro {name}"] = lambda values=values: dict(values)
    return found
