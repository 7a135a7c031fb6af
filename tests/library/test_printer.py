"""`passo.Printer`: commands, prints, status, events and cancellation of live printers."""

from __future__ import annotations

import asyncio
import time
from itertools import pairwise

import pytest

import passo
from passo import config
from passo.events import Fault, JobEnded, LayerChanged, Message, StateChanged, TemperatureChanged
from passo.library.assembly import assembled
from passo.printer.status import PrinterState

PART = """G28
;LAYER_CHANGE
G1 Z0.2 F600
G1 X40 F3000
;LAYER_CHANGE
G1 Z0.4
G1 X10 F3000
"""


@pytest.fixture
def part(tmp_path):
    path = tmp_path / "part.gcode"
    path.write_text(PART)
    return path


def live(main, machine="i3", clock="virtual", **options):
    """Runs `main(printer)` with an open printer."""

    async def within():
        async with passo.Printer(machine, **options) as printer:
            return await main(printer)

    return passo.run(within(), clock=clock)


def test_replies_contain_the_answer_of_a_command():
    async def main(printer):
        return [await printer.send(line) for line in ("M105", "M114", "G28", "; nothing", "M117 µ")]

    m105, m114, g28, comment, m117 = live(main)
    assert m105.text.startswith("T:25.0")
    assert m114.lines == ("X:0.000 Y:0.000 Z:0.000 E:0.0000 Count X:0 Y:0 Z:0",)
    assert g28.lines == comment.lines == m117.lines == ()


def test_a_line_that_is_not_carried_out_raises_its_problem():
    async def main(printer):
        await printer.send("G28")
        for line, code in (
            ("G1 X999", "input.out-of-range"),
            ("M104 S900", "heat.unsafe-target"),
            ("M23 no.g", "card.absent"),
            ("G1 XNaN", "input.number"),
        ):
            with pytest.raises(passo.CommandError) as error:
                await printer.send(line)
            assert error.value.problems[0].code == code
        with pytest.raises(ValueError, match="one line"):
            await printer.send("G28\nG1 X1")
        await printer.send("G1 X5 F6000")
        await printer.send("M400")
        return printer.status

    status = live(main)
    assert (status.position_mm["x"], status.state) == (5.0, PrinterState.IDLE)


def test_commands_of_several_tasks_keep_their_order():
    async def main(printer):
        await printer.send("G28")
        lines = [f"G1 X{x} F6000" for x in (10, 30, 20)]
        await asyncio.gather(*(printer.send(line) for line in lines), printer.send("M400"))
        return printer.status.position_mm["x"]

    assert live(main) == 20.0


@pytest.mark.parametrize(
    ("clock", "fast"), [("virtual", False), (200, False), ("real", True), ("virtual", True)]
)
def test_a_print_in_each_clock(part, clock, fast):
    async def main(printer):
        layers = []
        printer.on_event(lambda e: layers.append(e.layer) if isinstance(e, LayerChanged) else None)
        summary = await printer.print(part)
        await asyncio.sleep(0)
        return summary, layers, printer.status.position_mm["x"]

    begun = time.monotonic()
    summary, layers, x_mm = live(main, clock=clock, fast=fast)
    assert time.monotonic() - begun < 10
    assert (summary.outcome, layers, x_mm) == ("done", [1, 2], 10.0)
    assert 5 < summary.print_s < 30


def test_a_short_move_in_real_time():
    async def main(printer):
        begun = time.monotonic()
        await printer.send("G92 X0 Y0 Z0")
        await printer.send("G1 X5 F3000")
        await printer.send("M400")
        return printer.status.position_mm["x"], time.monotonic() - begun

    x_mm, seconds = live(main, clock="real")
    assert x_mm == 5.0
    assert seconds > 0.1


def test_status_of_a_print(part):
    part.write_text("M190 S50\n" + PART)

    async def main(printer):
        seen = []
        end = printer.on_status(seen.append, every_s=5.0)
        await printer.print(part)
        end()
        count = len(seen)
        await asyncio.sleep(20)
        assert len(seen) == count
        return seen

    seen = live(main)
    assert {round(b.time_s - a.time_s, 1) for a, b in pairwise(seen[1:])} <= {
        5.0, 5.1, 5.2
    }  # fmt: skip
    printing = [status for status in seen if status.job is not None]
    assert len(printing) > 20
    assert {status.state for status in printing} == {PrinterState.PRINTING}
    beds = [status.heaters["bed"] for status in printing]
    assert (beds[1].target_c, beds[1].power) == (50.0, 1.0)
    assert beds[-1].celsius == pytest.approx(50, abs=1)
    jobs = [status.job for status in printing]
    assert (jobs[0].file, jobs[0].line, jobs[0].layer) == ("part.gcode", 0, 0)
    assert jobs[-1].layers == 2
    assert jobs[-1].printed_s > 100


def test_events_of_heating_and_states():
    async def main(printer):
        events = []
        printer.on_event(events.append)
        await printer.send("M109 S60")
        await asyncio.sleep(1)
        return events

    events = live(main)
    warm = [e for e in events if isinstance(e, TemperatureChanged) and e.heater == "hotend"]
    assert [e.target_c for e in warm[:2]] == [60.0, 60.0]
    assert all(1 <= b.celsius - a.celsius < 2.5 for a, b in pairwise(warm[1:20]))
    states = [(e.before.name, e.state.name) for e in events if isinstance(e, StateChanged)]
    assert states == [("IDLE", "BUSY"), ("BUSY", "IDLE")]


def test_a_heater_fault_is_an_event_and_halts_the_print(part):
    part.write_text("M109 S200\n" + PART)

    async def main(printer):
        events = []
        printer.on_event(events.append)
        printing = asyncio.create_task(printer.print(part))
        await asyncio.sleep(30)
        printer._printer.board.force_sensor("hotend", 1.0)
        with pytest.raises(passo.MachineError) as error:
            await printing
        assert [problem.code for problem in error.value.problems] == ["heat.sensor-open"]
        await asyncio.sleep(1)
        assert printer.status.state is PrinterState.HALTED
        with pytest.raises(passo.CommandError, match="Printer stopped"):
            await printer.send("G1 X5")
        printer._printer.board.force_sensor("hotend", None)
        await printer.send("M999")
        await asyncio.sleep(1)
        assert printer.status.state is PrinterState.IDLE
        return events

    events = live(main)
    assert [(e.heater, e.kind) for e in events if isinstance(e, Fault)] == [
        ("hotend", "sensor-open")
    ]
    ended = [e for e in events if isinstance(e, JobEnded)]
    assert [(e.file, e.outcome) for e in ended] == [("part.gcode", "failed")]
    assert "means a broken cable" in ended[0].reason
    states = [e.state.name for e in events if isinstance(e, StateChanged)]
    assert states == ["PRINTING", "HALTED", "IDLE"]
    assert any(isinstance(e, Message) and "Printer halted" in e.text for e in events)


def test_a_cancelled_print_brakes_and_cools(part):
    part.write_text("M104 S200\nG28\nG1 X200 F600\n")

    async def main(printer):
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(15):
                await printer.print(part)
        await printer.send("M400")
        status = printer.status
        assert status.heaters["hotend"].target_c == 0
        assert 0 < status.position_mm["x"] < 150
        return await printer.print(part)

    assert live(main).outcome == "done"


def test_a_cancelled_wait_ends_and_later_lines_follow():
    async def main(printer):
        loop = asyncio.get_running_loop()
        heating = asyncio.create_task(printer.send("M109 S250"))
        await asyncio.sleep(1)
        unwanted = asyncio.create_task(printer.send("G92 X77"))
        wanted = asyncio.create_task(printer.send("G92 Y66"))
        await asyncio.sleep(1)
        unwanted.cancel()
        heating.cancel()
        await wanted
        assert loop.time() < 3
        return printer.status

    status = live(main)
    assert (status.position_mm["x"], status.position_mm["y"]) == (0.0, 66.0)
    assert status.heaters["hotend"].target_c == 250.0


def test_an_emergency_stop_acts_while_another_task_waits():
    async def main(printer):
        heating = asyncio.create_task(printer.send("M109 S250"))
        await asyncio.sleep(1)
        await printer.send("M112")
        with pytest.raises(passo.CommandError):
            await heating
        return printer.status

    status = live(main)
    assert status.state is PrinterState.HALTED
    assert status.halted == "emergency stop by M112"


def test_pause_resume_and_cancel_from_another_task(part):
    part.write_text("G28\nG1 X200 F3000\n")

    async def main(printer):
        printing = asyncio.create_task(printer.print(part))
        await asyncio.sleep(9)
        await printer.pause()
        await asyncio.sleep(5)
        paused = printer.status
        await asyncio.sleep(100)
        assert printer.status.position_mm == paused.position_mm
        await printer.resume()
        await asyncio.sleep(1)
        resumed = printer.status.state
        await printer.cancel()
        return paused.state, resumed, await printing

    paused, resumed, summary = live(main)
    assert (paused, resumed) == (PrinterState.PAUSED, PrinterState.PRINTING)
    assert summary.outcome == "cancelled"
    assert summary.print_s < 20


def test_files_that_cannot_be_printed_are_refused(part, tmp_path):
    (tmp_path / "empty.gcode").touch()

    async def main(printer):
        for name, code in (
            ("missing.gcode", "input.unreadable"),
            ("empty.gcode", "input.empty"),
            (".", "input.unreadable"),
        ):
            with pytest.raises(passo.InputError) as error:
                await printer.print(tmp_path / name)
            assert error.value.problems[0].code == code
        printing = asyncio.create_task(printer.print(part))
        await asyncio.sleep(1)
        with pytest.raises(passo.CommandError, match="is being printed"):
            await printer.print(part)
        part.with_name("bad.gcode").write_text("G28\nG1 X999\n")
        await printing
        with pytest.raises(passo.CommandError) as error:
            await printer.print(part.with_name("bad.gcode"))
        problem = error.value.problems[0]
        return problem.code, problem.file, problem.line

    assert live(main) == ("input.out-of-range", "bad.gcode", 2)


def test_a_print_of_a_file_resumes_after_a_power_cut(part, tmp_path):
    part.write_text("G28\n" + "".join(f"G1 X{10 + i % 50} F600\n" for i in range(100)))

    state = str(tmp_path / "state")

    async def cut():
        printer = assembled(config.load("i3"), state=state)
        serving = asyncio.create_task(printer.printer.run())
        printer.services.jobs.files.open(part.as_uri())
        printer.services.jobs.runner.start()
        await asyncio.sleep(15)
        serving.cancel()
        printer.printer.close()

    passo.run(cut(), clock="virtual")

    async def resumed(printer):
        ended = asyncio.Event()
        printer.on_event(lambda e: ended.set() if isinstance(e, JobEnded) else None)
        reply = await printer.send("M1000")
        await ended.wait()
        return reply.text, printer.status.position_mm["x"]

    text, x_mm = live(resumed, state=state)
    assert text.startswith("Printing part.gcode from line ")
    assert x_mm == 59.0


def test_printers_of_one_process_do_not_disturb_each_other(part):
    async def work(name):
        async with passo.Printer(name) as printer:
            await printer.print(part)
            return abs(printer._printer.board.net_steps("x"))

    async def main():
        alone = await work("i3")
        return alone, await asyncio.gather(work("i3"), work("mk3s"), work("i3"))

    alone, together = passo.run(main(), clock="virtual")
    assert together[0] == together[2] == alone > 0
    assert together[1] == passo.Machine.load("mk3s").print(part).final_steps["x"]


def test_no_thread_or_file_is_left_after_the_block(part):
    part.write_text("M109 S200\n" + PART)

    async def main():
        async with passo.Printer("i3") as printer:
            printing = asyncio.create_task(printer.print(part))
            events = asyncio.create_task(anext(printer.events()))
            await asyncio.sleep(1)
            waiting = asyncio.create_task(printer.send("M190 S60"))
            await asyncio.sleep(5)
        with pytest.raises(passo.MachineError, match="the printer has ended"):
            await printing
        with pytest.raises(passo.MachineError, match="the printer has ended"):
            await waiting
        await events
        with pytest.raises(RuntimeError, match="not open"):
            await printer.send("M105")
        await asyncio.sleep(1)
        return asyncio.all_tasks() - {asyncio.current_task()}

    assert passo.run(main(), clock="virtual") == set()


def test_callbacks_that_raise_harm_nothing(part):
    async def main(printer):
        contexts = []
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(lambda _, context: contexts.append(context["exception"]))

        def bad(_):
            raise KeyError("mine")

        printer.on_status(bad, every_s=1.0)
        printer.on_event(bad)
        summary = await printer.print(part)
        return summary.outcome, {type(error) for error in contexts}

    assert live(main) == ("done", {KeyError})


def restarted(tmp_path, line, *, text=None, printing=False, **options):
    """What RESTART or another line does to a served printer: its answer or error, and whether the
    program starts again. `text` is what the machine file holds by then."""
    file = tmp_path / "my.toml"
    file.write_text(config.shipped_text("i3"))
    part = tmp_path / "part.gcode"
    part.write_text(PART)

    async def main():
        async with passo.Printer(str(file), card=str(tmp_path), **options) as printer:
            await printer.send("G28")
            if printing:
                await printer.send("M32 part.gcode")
            if text is not None:
                file.write_text(text)
            serving = asyncio.ensure_future(printer.serve())
            try:
                answer = await printer.send(line)
            except passo.PassoError as error:
                answer = error
            await asyncio.sleep(1)
            homed = printer.status.homed
            if not serving.done():
                printer.end()
            return answer, await serving, homed

    return passo.run(main(), clock="virtual")


def test_restart_reads_the_machine_file_again(tmp_path):
    assert restarted(tmp_path, "RESTART", restarts=True)[1] is True
    assert restarted(tmp_path, "FIRMWARE_RESTART", restarts=True)[1:] == (False, frozenset())
    # A program that opened the printer does not start it again.
    assert restarted(tmp_path, "RESTART")[1:] == (False, frozenset())


def test_restart_is_refused_for_a_file_with_errors_and_during_a_print(tmp_path):
    wrong = config.shipped_text("i3").replace("max_c = 285.0", 'max_c = "hot"', 1)
    error, again, homed = restarted(tmp_path, "RESTART", text=wrong, restarts=True)
    assert "max_c" in str(error) and "my.toml:" in str(error)
    assert (again, homed) == (False, frozenset("xyz"))
    error, again, homed = restarted(tmp_path, "RESTART", printing=True, restarts=True)
    assert "part.gcode is being printed" in str(error)
    assert (again, homed) == (False, frozenset("xyz"))
