"""Klipper's status objects of a whole printer in virtual time."""

import asyncio

import pytest

import passo
from passo.config.exporting.settings import Sections
from passo.errors import CommandError
from passo.library.bridge import LiveBridge
from passo.printer.klipper.objects import objects
from passo.web.klippy.engine import Engine

HEAT_AND_PRINT = "\n".join(
    [
        "M109 S200",
        "G28",
        "G90",
        "M83",
        "G1 X20 Y20 Z1 F6000",
        "G1 E20 F300",
        *(f"G1 X{20 + i % 2 * 80} E4 F1200" for i in range(1, 60)),
    ]
)


def shown(bridge: LiveBridge, *names: str):
    """The objects of these names, as clients see them now."""
    status = bridge.latest().status
    found = objects(bridge.machine, Sections(bridge.machine), status, status.macros)
    return [found[name]() for name in names]


def on_printer(test, tmp_path, machine="i3"):
    """Runs a test with the bridge of a printer that has a card and a store of settings."""
    card, state = tmp_path / "card", tmp_path / "state"
    card.mkdir()
    (card / "part.gcode").write_text(HEAT_AND_PRINT + "\n")

    async def main():
        async with passo.Printer(machine, card=str(card), state=str(state)) as printer:
            engine = Engine(printer._bridge, lambda _: None, now_s=lambda: 0.0)
            printer._bridge.listen(engine)  # as the socket does
            await test(printer._bridge)

    passo.run(main(), clock="virtual")


async def _until(condition):
    while not condition():
        await asyncio.sleep(0.25)


def test_printing_time_counts_from_the_last_standstill(tmp_path):
    async def test(bridge: LiveBridge):
        def times():
            (found,) = shown(bridge, "idle_timeout")
            return found["state"], found["printing_time"]

        assert times() == ("Idle", 0.0)
        await bridge.run("G28\nM400")
        await asyncio.sleep(1)
        assert times() == ("Ready", 0.0)
        await bridge.run("G1 X100 F600")  # 10 s, by hand
        await asyncio.sleep(5)
        assert times() == ("Printing", pytest.approx(5, abs=0.6))
        await asyncio.sleep(10)
        assert times() == ("Ready", 0.0)
        await bridge.start_print("/part.gcode")
        await asyncio.sleep(60)
        assert times() == ("Printing", pytest.approx(60, abs=0.6))
        await bridge.pause_print()
        await asyncio.sleep(20)
        assert times() == ("Ready", 0.0)

    on_printer(test, tmp_path)


def test_print_duration_begins_with_the_first_extrusion(tmp_path):
    async def test(bridge: LiveBridge):
        def stats():
            return shown(bridge, "print_stats")[0]

        await bridge.start_print("/part.gcode")
        await _until(lambda: bridge.latest().status.heaters["hotend"].target_c == 200)
        await asyncio.sleep(20)
        assert (stats()["state"], stats()["print_duration"]) == ("printing", 0.0)
        assert stats()["total_duration"] >= 20
        await _until(lambda: stats()["print_duration"] > 0)
        heated_s = stats()["total_duration"] - stats()["print_duration"]
        await asyncio.sleep(10)
        assert stats()["total_duration"] - stats()["print_duration"] == pytest.approx(
            heated_s, abs=0.1
        )
        await bridge.pause_print()
        await asyncio.sleep(1)
        printed_s = stats()["print_duration"]
        await asyncio.sleep(30)
        assert stats()["print_duration"] == printed_s
        await bridge.cancel_print()
        assert stats()["print_duration"] == printed_s

    on_printer(test, tmp_path)


def test_filament_of_a_pause_does_not_count_for_the_print(tmp_path):
    async def test(bridge: LiveBridge):
        def used_mm():
            return shown(bridge, "print_stats")[0]["filament_used"]

        await bridge.start_print("/part.gcode")
        await _until(lambda: used_mm() > 30)
        await bridge.pause_print()
        await asyncio.sleep(5)
        paused_mm = used_mm()
        assert paused_mm > 20
        await bridge.run("M83\nG1 E-50 F1200\nM400")
        assert used_mm() == paused_mm
        await bridge.resume_print()
        await _until(lambda: bridge.latest().status.ended is not None)
        assert used_mm() == pytest.approx(20 + 59 * 4)
        assert (await bridge.past_prints(1))[0].filament_mm == pytest.approx(20 + 59 * 4)

    on_printer(test, tmp_path)


def test_print_that_is_cancelled_in_a_pause_has_used_filament(tmp_path):
    async def test(bridge: LiveBridge):
        await bridge.start_print("/part.gcode")
        await _until(lambda: shown(bridge, "print_stats")[0]["filament_used"] > 30)
        await bridge.pause_print()
        await asyncio.sleep(5)
        await bridge.run("M83\nG1 E-90 F1200\nM400")
        await bridge.cancel_print()
        await asyncio.sleep(5)
        (stats,) = shown(bridge, "print_stats")
        assert stats["state"] == "cancelled"
        assert stats["filament_used"] > 20

    on_printer(test, tmp_path)


def test_extruders_may_push_from_the_temperature_of_m302(tmp_path):
    async def test(bridge: LiveBridge):
        async def may(line):
            await bridge.run(line)
            await asyncio.sleep(0.5)
            return shown(bridge, "extruder")[0]["can_extrude"]

        assert await may("M302 S170") is False
        assert await may("M302 S20") is True
        assert await may("M302 S170") is False
        assert await may("M302 P1") is True

    on_printer(test, tmp_path)


def test_unsaved_settings_are_pending_until_they_are_stored(tmp_path):
    async def test(bridge: LiveBridge):
        async def pending(*lines):
            for line in lines:
                await bridge.run(line)
            await asyncio.sleep(0.5)
            (config,) = shown(bridge, "configfile")
            assert config["save_config_pending"] == bool(config["save_config_pending_items"])
            return config["save_config_pending_items"]

        items = await pending("M301 H0 P20")
        assert items == {"Heater PID": {"M301 H0 P": "20"}}
        assert await pending("SAVE_CONFIG") == {}
        assert await pending("M301 H0 P21") == {"Heater PID": {"M301 H0 P": "21"}}
        assert await pending("M501") == {}
        assert await pending("M502") != {}
        assert await pending("M500") == {}
        # what files and pages change for a while
        assert await pending("M204 P500", "SET_PRESSURE_ADVANCE ADVANCE=0.1", "M207 S1") == {}
        await bridge.run("M500")
        assert {"M204 P", "M207 S"} <= {
            f"{s.command} {s.word}" for s in await bridge.settings() if s.source == "stored"
        }

    on_printer(test, tmp_path)


def test_switched_filament_sensor_does_not_ask_to_save(tmp_path):
    async def test(bridge: LiveBridge):
        await bridge.run("SET_FILAMENT_SENSOR SENSOR=roll ENABLE=0")
        await asyncio.sleep(0.5)
        sensor, config = shown(bridge, "filament_switch_sensor roll", "configfile")
        assert (sensor["enabled"], config["save_config_pending"]) == (False, False)

    on_printer(test, tmp_path, "i3-all-parts")


def test_retraction_is_shown_and_set(tmp_path):
    async def test(bridge: LiveBridge):
        async def retraction(line):
            await bridge.run(line)
            await asyncio.sleep(0.5)
            return list(shown(bridge, "firmware_retraction")[0].values())

        assert await retraction("M400") == [3.0, 45.0, 0.0, 45.0]
        assert await retraction("SET_RETRACTION RETRACT_LENGTH=0.8") == [0.8, 45.0, 0.0, 45.0]
        line = "SET_RETRACTION RETRACT_SPEED=30 UNRETRACT_EXTRA_LENGTH=0.1 UNRETRACT_SPEED=20"
        assert await retraction(line) == [0.8, 30.0, 0.1, 20.0]
        assert await bridge.run("GET_RETRACTION") == (
            "RETRACT_LENGTH=0.80000 RETRACT_SPEED=30.00000"
            " UNRETRACT_EXTRA_LENGTH=0.10000 UNRETRACT_SPEED=20.00000",
        )

    on_printer(test, tmp_path)


def test_load_of_a_board_is_what_its_firmware_reports(tmp_path):
    async def test(bridge: LiveBridge):
        (mcu,) = shown(bridge, "mcu")
        assert (mcu["last_stats"]["mcu_awake"], mcu["last_stats"]["mcu_task_avg"]) == (0.0, 0.0)
        (connection,) = bridge._control.rig.connection.connections
        # 1000 passes of 400 ticks on average, at 16 MHz, with a deviation of 80.
        connection._responses.append(("stats", {"count": 1000, "sum": 400_000, "sumsq": 650_000}))
        await asyncio.sleep(0.5)
        await bridge.run("M105")
        stats = shown(bridge, "mcu")[0]["last_stats"]
        assert stats["mcu_awake"] == pytest.approx(0.025)
        assert stats["mcu_task_avg"] == pytest.approx(25e-6)
        assert stats["mcu_task_stddev"] == pytest.approx(5e-6)
        assert stats["bytes_write"] > 0

    on_printer(test, tmp_path)


LAYERS = """M83
SET_PRINT_STATS_INFO TOTAL_LAYER=12
G28
SET_PRINT_STATS_INFO CURRENT_LAYER=3
G1 X50 F1200
SET_PRINT_STATS_INFO CURRENT_LAYER=99
G1 X90 F60
"""


def test_layers_of_the_slicer_are_kept_until_the_next_print(tmp_path):
    async def test(bridge: LiveBridge):
        def layers():
            info = shown(bridge, "print_stats")[0]["info"]
            return info["current_layer"], info["total_layer"]

        (tmp_path / "card" / "layers.gcode").write_text(LAYERS)
        await bridge.start_print("/layers.gcode")
        await _until(lambda: layers() == (12, 12))  # at most the total
        await bridge.run("SET_PRINT_STATS_INFO CURRENT_LAYER=4")
        await asyncio.sleep(1)
        assert layers() == (4, 12)
        await bridge.cancel_print()
        await asyncio.sleep(1)
        assert layers() == (4, 12)
        with pytest.raises(CommandError, match="'CURRENT_LAYER=x' has no valid number"):
            await bridge.run("SET_PRINT_STATS_INFO CURRENT_LAYER=x")
        await bridge.start_print("/part.gcode")
        await asyncio.sleep(1)
        assert layers()[0] == 0

    on_printer(test, tmp_path)
