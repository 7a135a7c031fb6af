"""What crosses between a printer and the web, in one loop in virtual time."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace

import pytest

import passo
from passo.errors import CardError, CommandError, PassoError
from passo.gcode.command import Command
from passo.library.bridge import LiveBridge
from passo.printer.status import PrinterState
from passo.web.answers import status_of
from passo.web.openapi import statuses
from passo.web.operations import OPERATIONS

MOVES = "G28\n" + "".join(f"G1 X{10 + i % 2 * 50} Y{20 + i} F3000\n" for i in range(60))


class Heard:
    def __init__(self):
        self.snapshots, self.events = [], []

    def on_snapshot(self, snapshot):
        self.snapshots.append(snapshot)

    def on_event(self, event):
        self.events.append(event)


def bridged(test, tmp_path):
    """Runs a test with the bridge of an open printer and a listener to it."""
    (tmp_path / "part.gcode").write_text(MOVES)

    async def main():
        async with passo.Printer("i3", card=str(tmp_path)) as printer:
            bridge, heard = printer._bridge, Heard()
            end = bridge.listen(heard)
            await test(bridge, heard)
            end()

    passo.run(main(), clock="virtual")


def test_snapshots_count_up_and_show_what_was_done(tmp_path):
    async def test(bridge: LiveBridge, heard):
        assert await bridge.run("G28\nG1 X50 F6000\nM400") == ()
        await asyncio.sleep(0.5)
        versions = [snapshot.version for snapshot in heard.snapshots]
        assert versions == sorted(set(versions))
        assert heard.snapshots[-1] is bridge.latest()
        assert bridge.latest().status.position_mm["x"] == 50.0
        assert bridge.latest().status.homed == frozenset("xyz")

    bridged(test, tmp_path)


def test_scripts_do_not_mix(tmp_path):
    async def test(bridge: LiveBridge, _):
        await bridge.run("G28\nG1 X100 F6000")
        jog = "G91\nG1 X10 F600\nM400\nG90"
        await asyncio.gather(bridge.run(jog), bridge.run("G1 X20"))
        await bridge.run("M400")
        await asyncio.sleep(0.5)
        assert bridge.latest().status.position_mm["x"] == 20.0  # not 130

    bridged(test, tmp_path)


def test_a_line_that_acts_at_once_overtakes_a_wait(tmp_path):
    async def test(bridge: LiveBridge, _):
        wait = asyncio.create_task(bridge.run("M109 S200"))
        await asyncio.sleep(1)
        (report,) = await bridge.run("M105")
        assert "/200.00" in report
        assert not wait.done()
        wait.cancel()
        with pytest.raises(asyncio.CancelledError):
            await wait
        await bridge.run("G28")  # nothing waits any more

    bridged(test, tmp_path)


def test_the_first_line_that_fails_ends_a_script(tmp_path):
    async def test(bridge: LiveBridge, _):
        with pytest.raises(CommandError, match=r"not homed|not know"):
            await bridge.run("G1 X10\nM117 never")
        assert bridge.latest().status.message == ""

    bridged(test, tmp_path)


def test_script_that_fails_restores_the_state_that_it_has_saved(tmp_path):
    async def test(bridge: LiveBridge, _):
        await bridge.run("G28\nG90\nG1 X50 F3000\nG20")
        jog = "SAVE_GCODE_STATE NAME=_ui_movement\nG91\nG1 X+999\nRESTORE_GCODE_STATE NAME="
        with pytest.raises(CommandError, match="beyond the limit"):
            await bridge.run(f"{jog}_ui_movement ; as before\nG1 X1")
        await bridge.run("G1 X2 F100")  # absolute, in inches
        assert bridge._control.rig.job.machine_position[0] == pytest.approx(50.8)

    bridged(test, tmp_path)


def test_called_commands_act_in_order_with_their_values(tmp_path):
    async def test(bridge: LiveBridge, _):
        home, move = Command.call("G28"), Command.call("G1", X=50, Y=20.5, F=6000)
        assert await bridge.call(home, move, Command.call("M400")) == ()
        await bridge.call(Command.call("M106", P=0, S=127.5, F=True))
        await bridge.call(Command.call("SET_FAN_SPEED", FAN="fan", SPEED=0.25))
        await bridge.call(Command.call("SET_HEATER_TEMPERATURE", HEATER="extruder", TARGET=60))
        await bridge.call(Command.call("M400"))
        await asyncio.sleep(0.5)
        status = bridge.latest().status
        assert (status.position_mm["x"], status.position_mm["y"]) == (50.0, 20.5)
        assert status.fans["part"] == pytest.approx(0.25)
        assert status.heaters["hotend"].target_c == 60
        with pytest.raises(CommandError, match="ADVANCE is 20: expected 0 to 10 s"):
            await bridge.call(Command.call("SET_PRESSURE_ADVANCE", ADVANCE=20))

    bridged(test, tmp_path)


def test_called_command_is_cancelled_and_overtaken_like_a_line(tmp_path):
    async def test(bridge: LiveBridge, _):
        wait = asyncio.create_task(bridge.call(Command.call("M109", S=200)))
        await asyncio.sleep(1)
        (report,) = await bridge.call(Command.call("M105"))
        assert "/200.00" in report
        await bridge.call(Command.call("M104", S=0, F=True))
        assert not wait.done()
        wait.cancel()
        with pytest.raises(asyncio.CancelledError):
            await wait
        await bridge.call(Command.call("G28"))

    bridged(test, tmp_path)


def test_jog_that_fails_restores_the_state_that_it_has_saved(tmp_path):
    async def test(bridge: LiveBridge, _):
        await bridge.run("G28\nG90\nG1 X50 F3000\nG20")
        saved, restored = (
            Command.call(code, NAME="_ui_jog")
            for code in ("SAVE_GCODE_STATE", "RESTORE_GCODE_STATE")
        )
        with pytest.raises(CommandError, match="beyond the limit"):
            await bridge.call(saved, Command.call("G1", X=999, R="X", F=600), restored)
        await bridge.call(saved, Command.call("G1", X=5, R="X", F=600), restored)
        assert bridge._control.rig.job.machine_position[0] == pytest.approx(55)
        await bridge.run("G1 X2 F100")  # absolute, in inches
        assert bridge._control.rig.job.machine_position[0] == pytest.approx(50.8)

    bridged(test, tmp_path)


def test_a_print_is_started_paused_resumed_and_cancelled(tmp_path):
    async def test(bridge: LiveBridge, heard):
        await bridge.start_print("/part.gcode")
        await asyncio.sleep(15)
        status = bridge.latest().status
        assert (status.state, status.job.file) == (PrinterState.PRINTING, "part.gcode")
        assert status.job.size == len(MOVES)
        with pytest.raises(CardError, match="is being printed"):
            await bridge.create_file("/part.gcode")
        await bridge.pause_print()
        await asyncio.sleep(10)
        assert bridge.latest().status.state is PrinterState.PAUSED
        await bridge.resume_print()
        await asyncio.sleep(5)
        assert bridge.latest().status.state is PrinterState.PRINTING
        await bridge.cancel_print()
        await asyncio.sleep(5)
        status = bridge.latest().status
        assert status.job is None and status.ended.outcome == "cancelled"

    bridged(test, tmp_path)


def test_status_has_the_temperature_below_which_filament_stays(tmp_path):
    async def test(bridge: LiveBridge, _):
        assert bridge.latest().status.min_extrude_c == 170
        await bridge.run("M302 S180")
        await asyncio.sleep(1)
        assert bridge.latest().status.min_extrude_c == 180
        await bridge.run("M302 P1")
        await asyncio.sleep(1)
        assert bridge.latest().status.min_extrude_c == 0

    bridged(test, tmp_path)


def test_an_emergency_stop_overtakes_all_and_restart_ends_it(tmp_path):
    async def test(bridge: LiveBridge, _):
        wait = asyncio.create_task(bridge.run("M109 S200"))
        await asyncio.sleep(1)
        bridge.emergency_stop()
        with pytest.raises(CommandError):
            await wait
        await asyncio.sleep(0.5)
        status = bridge.latest().status
        assert (status.state, status.faults[0].code) == (
            PrinterState.HALTED,
            "machine.emergency-stop",
        )
        await bridge.restart()
        assert bridge.latest().status.state is not PrinterState.HALTED

    bridged(test, tmp_path)


def test_a_file_that_is_printed_stays_as_it_is(tmp_path):
    (tmp_path / "toys").mkdir()

    async def test(bridge: LiveBridge, _):
        await bridge.rename("/part.gcode", "/toys/part.gcode")
        await bridge.start_print("/toys/part.gcode")
        for change in (
            bridge.rename("/toys/part.gcode", "/b.gcode"),
            bridge.rename("/toys", "/games"),
            bridge.remove_file("/TOYS/PART.GCODE"),
            bridge.create_file("/toys/part.gcode"),
        ):
            with pytest.raises(CardError, match=r"part\.gcode is being printed"):
                await change
        await bridge.cancel_print()
        await bridge.rename("/toys", "/games")
        await asyncio.sleep(0.5)
        assert bridge.latest().status.files.selected == ""
        assert (tmp_path / "games" / "part.gcode").read_text() == MOVES

    bridged(test, tmp_path)


class StuckLoop(asyncio.SelectorEventLoop):
    """The loop of a web whose thread does nothing any more; counts what waits for it."""

    waiting = 0

    def call_soon_threadsafe(self, callback, *args, context=None):
        self.waiting += 1


def printed_beside_a_stuck_web(tmp_path, listeners):
    """A print with a console that asks 20 times a second: when each `ok` came and where the machine
    was, and how many calls wait for the web, which has so many listeners and never runs."""
    (tmp_path / "part.gcode").write_text(MOVES)
    oks, stuck = [], StuckLoop()

    async def add():
        for _ in range(listeners):
            bridges[0].listen(Heard())

    bridges = []

    async def main():
        async with passo.Printer("i3", card=str(tmp_path)) as printer:
            bridges.append(printer._bridge)
            with ThreadPoolExecutor() as pool:
                pool.submit(stuck.run_until_complete, add()).result()
            await printer.send("M302 P1")
            await bridges[0].start_print("/part.gcode")
            loop = asyncio.get_running_loop()
            for _ in range(400):
                await printer.send("M105")
                status = printer.status
                oks.append((loop.time(), status.job.line, status.position_mm))
                await asyncio.sleep(0.05)

    passo.run(main(), clock="virtual")
    stuck.close()
    return oks, stuck.waiting


def test_a_web_that_is_stuck_delays_no_ok_and_no_step(tmp_path):
    oks, waiting = printed_beside_a_stuck_web(tmp_path, 0)
    assert oks[-1][1] > 10  # the machine has moved
    assert waiting == 0
    of_one = printed_beside_a_stuck_web(tmp_path, 1)
    assert of_one[0] == oks
    assert 80 <= of_one[1] <= 100 + 30  # a tick each 0.25 s, and events
    assert printed_beside_a_stuck_web(tmp_path, 50) == of_one


def test_many_scripts_make_no_more_snapshots_than_ticks(tmp_path):
    async def test(bridge: LiveBridge, heard):
        await bridge.start_print("/part.gcode")
        await asyncio.sleep(12)
        before = len(heard.snapshots)
        for _ in range(200):
            await bridge.run("M105")
            await asyncio.sleep(0.02)
        assert 15 <= len(heard.snapshots) - before <= 18  # in 4 s
        await bridge.run("M220 S90")
        assert bridge.latest().status.speed_factor == 0.9  # before listeners get it

    bridged(test, tmp_path)


def test_an_estimate_is_that_of_passo_estimate(tmp_path):
    async def test(bridge: LiveBridge, _):
        paths = []
        found = await bridge.verdict("/part.gcode", paths.append)
        wanted = passo.Machine.load("i3").estimate(tmp_path / "part.gcode")
        assert replace(found.estimate, file=wanted.file) == wanted
        assert [path[:8] for path in paths] == [b"PASSOTP1"]
        (tmp_path / "far.gcode").write_text("G28\nG1 X900\n")
        (problem,) = (await bridge.verdict("/far.gcode")).problems
        assert str(problem).startswith("far.gcode:2: X")

    bridged(test, tmp_path)


def test_a_file_may_go_while_it_is_planned(tmp_path):
    """An estimate keeps nobody from the file."""
    (tmp_path / "long.gcode").write_text("G28\n" + "G1 X10\nG1 X20 ; and back\n" * 200_000)

    async def test(bridge: LiveBridge, _):
        estimate = asyncio.ensure_future(bridge.verdict("/long.gcode"))
        while not estimate.done():
            await asyncio.sleep(0.001)
            if (tmp_path / "long.gcode").exists():
                with suppress(CardError):
                    await bridge.remove_file("/long.gcode")
        assert isinstance(estimate.exception(), CardError)

    bridged(test, tmp_path)


def test_each_refusal_of_a_print_command_has_a_described_status(tmp_path):
    described = {o.name: statuses(o) for o in OPERATIONS}

    async def test(bridge: LiveBridge, _):
        calls = {
            "job.resume": bridge.resume_print,
            "job.start": lambda: bridge.start_print("/part.gcode"),
            "job.pause": bridge.pause_print,
            "job.cancel": bridge.cancel_print,
        }
        refused = set()

        async def call(*names):
            for name in names:
                try:
                    await calls[name]()
                except PassoError as error:
                    code = error.problems[0].code
                    assert code in described[name][status_of(code)]
                    refused.add((name, code))

        await call("job.resume", "job.start", "job.resume", "job.start", *calls)
        await bridge.run("M112")
        await call(*calls)
        assert refused == {
            ("job.resume", "job.no-file"),
            ("job.resume", "job.printing"),
            ("job.start", "job.printing"),
        }

    bridged(test, tmp_path)
