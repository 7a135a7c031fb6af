"""Each command that Klipper's clients are told of, on a whole printer in virtual time."""

import asyncio
from contextlib import suppress

import pytest

import passo
from passo import config
from passo.errors import CommandError, PassoError
from passo.gcode.registry import table
from passo.web.klippy.objects import PrinterObjects

# They end the printer or what follows on the console; other tests send them.
LEFT_OUT = {"M112", "M28", "M928", "M932", "EOF", "RESTART", "FIRMWARE_RESTART"}


def test_each_command_runs_or_reports_why_not(tmp_path):
    wrong: list[str] = []

    async def main():
        async with passo.Printer("i3", card=str(tmp_path)) as printer:
            bridge = printer._bridge
            for code in sorted(table().keys() - LEFT_OUT):
                with suppress(PassoError, TimeoutError):  # a wait for the user is ended
                    await asyncio.wait_for(bridge.run(code), 2)
                if printer.status.halted:
                    wrong.append(f"{code}: {printer.status.halted}")
                    await bridge.restart()

    passo.run(main(), clock="virtual")
    assert wrong == []


ALWAYS = {"G28", "PAUSE", "SAVE_GCODE_STATE", "M112", "FORCE_MOVE"}
PROBED = {"PROBE", "BED_MESH_CALIBRATE", "PROBE_CALIBRATE", "G29", "Z_OFFSET_APPLY_PROBE"}
WARM = {"SET_HEATER_TEMPERATURE", "PID_CALIBRATE", "SET_PRESSURE_ADVANCE"}


@pytest.mark.parametrize(
    ("machine", "has", "lacks"),
    [
        ("i3", WARM, PROBED | {"Z_TILT_ADJUST", "TEST_RESONANCES", "DELTA_CALIBRATE", "SET_PIN"}),
        ("i3-probe", PROBED | WARM, {"Z_TILT_ADJUST", "QUAD_GANTRY_LEVEL", "BLTOUCH_DEBUG"}),
        ("i3-two-z", {"Z_TILT_ADJUST"}, {"QUAD_GANTRY_LEVEL"}),
        ("voron-2-4", {"QUAD_GANTRY_LEVEL"}, {"Z_TILT_ADJUST", "SET_FAN_SPEED"}),
        ("delta-probe", {"DELTA_CALIBRATE"}, {"Z_TILT_ADJUST"}),
        ("cnc", set(), WARM | PROBED | {"SET_FAN_SPEED"}),
    ],
)
def test_clients_see_the_commands_that_the_machine_has(machine, has, lacks):
    async def main():
        async with passo.Printer(machine) as printer:
            objects = PrinterObjects(printer._bridge)
            known = objects.lookup()("gcode")["commands"].keys()
            assert has | ALWAYS <= known
            assert known.isdisjoint(lacks)

    passo.run(main(), clock="virtual")


MACROS = '[macros.LIGHTS]\ngcode = "SET_LED LED=a RED=1\\nM117 lit"\n'


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("SET_PIN PIN=light VALUE=1", "SET_PIN does nothing here: The machine file has no output"),
        ("SET_LED LED=a RED=1", "SET_LED does nothing here: The machine file has no light"),
        ("SET_FILAMENT_SENSOR SENSOR=a ENABLE=0", "The machine file has no filament sensor"),
        ("PROBE", "PROBE does nothing here: "),
        ("SYNC_EXTRUDER_MOTION EXTRUDER=extruder MOTION_QUEUE=", "MOTION is not there yet: One"),
        ("SDCARD_LOOP_BEGIN COUNT=3", "SDCARD_LOOP_BEGIN is for files that can be read again"),
        ("INIT_TMC STEPPER=stepper_x", "STEPPER is stepper_x: expected a motor whose driver"),
    ],
)
def test_script_without_its_part_fails_but_macros_continue(line, told):
    async def main():
        machine = config.load_text(config.shipped_text("i3") + MACROS, "mine.toml")
        async with passo.Printer(machine) as printer:
            bridge = printer._bridge
            with pytest.raises(CommandError, match=told):
                await bridge.run(line)
            await bridge.run("SDCARD_LOOP_DESIST")
            await bridge.run("LIGHTS")
            await asyncio.sleep(0.5)
            assert bridge.latest().status.message == "lit"

    passo.run(main(), clock="virtual")


def test_tilt_of_the_bed_is_measured_with_the_method_linear():
    text = config.shipped_text("i3-probe")

    async def run(method):
        machine = config.load_text(text.replace('method = "quadratic"', method), "mine.toml")
        async with passo.Printer(machine) as printer:
            bridge = printer._bridge
            await bridge.run("G28")
            await bridge.run("BED_TILT_CALIBRATE")
            await asyncio.sleep(0.5)
            return bridge.latest().status.bed

    async def main():
        bed = await run('method = "linear"')
        assert (bed.on, bed.method, len(bed.points)) == (True, "linear", 9)
        with pytest.raises(CommandError, match="is mesh, and only linear corrects a tilt"):
            await run('method = "mesh"')

    passo.run(main(), clock="virtual")
