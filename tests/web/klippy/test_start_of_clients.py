"""What Mainsail, Fluidd and KlipperScreen ask for at their start and on their pages, and send by
their buttons, as their sources have it (Mainsail 2.18.2, Fluidd 1.37.4, KlipperScreen 0.4.7)."""

import asyncio
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS
from tests.web.klippy.client import Served

from passo.printer.status import JobStatus, PrinterState, PrintObject

# Fields that a client reads without a check for their absence, or shows.
FIELDS = {
    "webhooks": "state state_message",
    "configfile": "config settings warnings save_config_pending save_config_pending_items",
    "gcode": "commands",
    "toolhead": "homed_axes axis_minimum axis_maximum position extruder max_velocity max_accel"
    " minimum_cruise_ratio square_corner_velocity print_time estimated_print_time stalls",
    "gcode_move": "speed_factor extrude_factor speed absolute_coordinates absolute_extrude"
    " homing_origin position gcode_position",
    "motion_report": "live_position live_velocity live_extruder_velocity steppers trapq",
    "extruder": "temperature target power can_extrude motion_queue pressure_advance smooth_time",
    "heater_bed": "temperature target power",
    "heaters": "available_heaters available_sensors available_monitors",
    "fan": "speed rpm",
    "virtual_sdcard": "file_path progress is_active file_position file_size",
    "print_stats": "filename state total_duration print_duration filament_used message info",
    "display_status": "progress message",
    "pause_resume": "is_paused",
    "idle_timeout": "state printing_time idle_timeout",
    "exclude_object": "objects excluded_objects current_object",
    "stepper_enable": "steppers",
    "input_shaper": "shaper_type_x shaper_freq_x damping_ratio_x",
    "query_endstops": "last_query",
    "mcu": "mcu_version mcu_build_versions mcu_constants last_stats",
    "system_stats": "sysload cputime memavail",
}
SETTINGS = {
    "printer": "kinematics max_velocity max_accel minimum_cruise_ratio",
    "stepper_x": "position_min position_max position_endstop endstop_pin",
    "stepper_y": "position_min position_max position_endstop endstop_pin",
    "stepper_z": "position_min position_max position_endstop endstop_pin",
    "extruder": "nozzle_diameter filament_diameter min_temp max_temp min_extrude_temp"
    " max_extrude_only_distance",
    "heater_bed": "min_temp max_temp",
    "fan": "max_power off_below",
    "virtual_sdcard": "path",
}
# Without these sections Mainsail (in any case), Fluidd (as written) or Moonraker warn.
SECTIONS = {
    *("virtual_sdcard", "pause_resume", "display_status", "gcode_macro PAUSE"),
    *("gcode_macro RESUME", "gcode_macro CANCEL_PRINT"),
}


def status(served, *names):
    """The objects of these names, all fields."""
    return served.client().ask("objects/query", objects=dict.fromkeys(names))


def run(test, **options):
    async def main():
        await test(Served(**options))

    asyncio.run(main())


def test_objects_have_each_field_that_pages_read(tmp_path):
    async def test(served):
        names = (await served.client().ask("objects/list"))["objects"]
        assert FIELDS.keys() <= set(names)
        found = (await status(served, *FIELDS))["status"]
        for name, fields in FIELDS.items():
            assert set(fields.split()) <= found[name].keys(), name

    run(test, card=str(tmp_path))


def test_configuration_has_what_pages_read_and_silences_their_warnings(tmp_path):
    served_status = replace(STATUS, files=replace(STATUS.files, folder=str(tmp_path)))

    async def test(served):
        served.bridge.show(served_status)
        found = (await status(served, "configfile"))["status"]["configfile"]
        assert found["config"].keys() >= SECTIONS
        assert found["config"]["virtual_sdcard"]["path"] == str(tmp_path)
        assert all(isinstance(v, str) for s in found["config"].values() for v in s.values())
        for section, keys in SETTINGS.items():
            assert set(keys.split()) <= found["settings"][section].keys(), section
        assert (found["warnings"], found["save_config_pending"]) == ([], False)

    run(test)


@pytest.mark.parametrize(
    ("machine", "kinematics", "section"),
    [
        ("i3", "cartesian", "stepper_x"),
        ("corexy", "corexy", "stepper_x"),
        ("delta", "delta", "stepper_a"),
        ("scara", "cartesian", "stepper_x"),
    ],
)
def test_machines_are_of_a_kind_that_pages_draw(machine, kinematics, section):
    async def test(served):
        settings = (await status(served, "configfile"))["status"]["configfile"]["settings"]
        assert settings["printer"]["kinematics"] == kinematics
        assert section in settings

    run(test, machine=machine)


def test_print_shows_file_progress_by_bytes_and_objects():
    objects = (
        PrintObject(0, "cube", centre_mm=(10.0, 20.0), outline_mm=((0.0, 0.0), (5.0, 5.0))),
        PrintObject(1, "ring", cancelled=True),
    )
    job = JobStatus(
        *("a.gcode", 0.5, 7, 2, 4, 60.0, 60.0, objects, 0),
        path="/sub/a.gcode",
        size=200,
        offset=50,
        elapsed_s=90.0,
        filament_mm=12.5,
        extruding_s=45.0,
    )
    printing = replace(
        STATUS,
        state=PrinterState.PRINTING,
        job=job,
        files=replace(STATUS.files, folder="/card"),
    )

    async def test(served):
        served.bridge.show(printing)
        names = ("print_stats", "virtual_sdcard", "exclude_object")
        shown = (await status(served, *names))["status"]
        stats, card, exclude = (shown[name] for name in names)
        assert (stats["filename"], stats["state"]) == ("sub/a.gcode", "printing")
        assert (stats["total_duration"], stats["print_duration"]) == (90.0, 45.0)
        assert stats["info"] == {"total_layer": 4, "current_layer": 2}
        assert card == {
            "file_path": "/card/sub/a.gcode",
            "progress": 0.25,
            "is_active": True,
            "file_position": 50,
            "file_size": 200,
        }
        assert exclude == {
            "objects": [
                {"name": "CUBE", "center": [10.0, 20.0], "polygon": [[0.0, 0.0], [5.0, 5.0]]},
                {"name": "RING"},
            ],
            "excluded_objects": ["RING"],
            "current_object": "CUBE",
        }

    run(test)
