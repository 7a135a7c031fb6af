"""All modules that declare commands: importing this one completes the table of
`passo.gcode.registry`. A new module with commands gets a line here; a test looks for it."""

from passo.console import (
    aprinter_options,
    card_commands,
    commands,
    job_commands,
    json_status,
    object_commands,
    recovery_commands,
    settings_commands,
)
from passo.gcode import ignored_commands, interpreter_commands
from passo.job.live import statistics
from passo.printer import delayed_gcode, macros
from passo.printer.commands import (
    bed_correction,
    bed_screws,
    beeper,
    delta_calibration,
    drivers,
    endstop_offsets,
    heater_control,
    heater_tuning,
    klipper_commands,
    levelling,
    limits,
    manual_probe,
    motion_filters,
    motor_moves,
    motors,
    outputs,
    power_supply,
    predefined_moves,
    probe_deployment,
    probe_moves,
    probe_offsets,
    probing,
    program_flow,
    reports,
    set_points,
    simulated_faults,
    skew,
    speed_and_flow,
    steps_and_offsets,
    temperature,
    tuning_tower,
    user_prompts,
    z_motors,
)
from passo.printer.watch import endstops

MODULES = (
    *(aprinter_options, card_commands, commands, job_commands, json_status, object_commands),
    *(recovery_commands, settings_commands, ignored_commands, interpreter_commands, statistics),
    *(
        bed_screws,
        beeper,
        delta_calibration,
        drivers,
        endstop_offsets,
        heater_control,
        heater_tuning,
        limits,
        motion_filters,
        motor_moves,
        motors,
        outputs,
        skew,
        z_motors,
    ),
    *(power_supply, klipper_commands, levelling, probe_deployment, probing, program_flow, reports),
    *(bed_correction, manual_probe, predefined_moves, probe_moves, probe_offsets, set_points),
    *(simulated_faults, speed_and_flow, steps_and_offsets, temperature, tuning_tower),
    user_prompts,
    *(endstops, delayed_gcode, macros),
)
