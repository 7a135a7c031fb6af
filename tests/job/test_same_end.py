"""Each way to print a file ends it at the same line, with the same words."""

from __future__ import annotations

import asyncio

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario
from tests.web.klippy.client import Client

import passo
from passo import Machine
from passo.errors import PassoError
from passo.web.klippy.engine import Engine

MACHINE = with_macros(
    macro("RAISES", "G1 X20\n{ action_raise_error('no filament') }")
    + macro("LIGHTS", "SET_LED LED=a RED=1\nM117 lit; bright")
    + macro("DEEP", "{% for i in range(3) %}\nG1 X{i * 200} F6000\n{% endfor %}")
    + macro("STARTS", "SDCARD_PRINT_FILE FILENAME=b.gcode")
    + macro("HALTS", "{ action_emergency_stop('smoke') }")
)
OBJECTS = "EXCLUDE_OBJECT_DEFINE NAME=a\nEXCLUDE_OBJECT_START NAME=a\n{}EXCLUDE_OBJECT_END NAME=a\n"
FILES = {  # a file, the line where it ends (0: its end), a part of the sentence
    "good": ("G28\nM109 S200\nG1 X10 E5 F600\nLIGHTS\n", 0, ""),
    "cold": ("G28\nG1 X10 E5 F600\n", 2, "cold extrusion"),
    "not homed": ("G92 E0\nG1 X5 F600\n", 2, "axis X is not homed"),
    "out of range": ("G28\nG1 X5 F600\nG1 X999\n", 3, "X 999.000 mm is beyond the limit"),
    "unknown command": ("G28\nM5000\nG1 X5 F600\n", 0, ""),
    "unknown start": ("G28\nG1 X5 F600\nPRINT_START BED=60\n", 3, "PRINT_START is unknown here"),
    "macro that raises": ("G28\nRAISES\nG1 X5\n", 2, "macro RAISES: no filament"),
    "line of a macro": ("G28\nDEEP\n", 2, "X 400.000 mm is beyond the limit"),
    "macro that halts": ("G28\nHALTS\nG1 X5\n", 2, "smoke"),
    "emergency stop": ("G28\nG1 X5 F600\nM112\nG1 X9\n", 3, "M112"),
    "quick stop": ("G28\nG1 X5 F600\nM410\nG1 X9\n", 3, "M410"),
    "excluded object": (
        "G28\nG1 X5 F600\n" + OBJECTS.format("EXCLUDE_OBJECT NAME=a\nG1 X9\n") + "G1 X9\n",
        0,
        "",
    ),
    "unknown object": ("G28\nEXCLUDE_OBJECT NAME=b\nG1 X5 F600\n", 0, ""),
    "missing part": ("G28\nSET_LED LED=a RED=1\nSET_PIN PIN=a VALUE=1\nG1 X5 F600\n", 0, ""),
    "missing tool": ("G28\nT7\nG1 X5\n", 2, "tool T7 does not exist"),
    "wrong word": ("G28\nM104 Sabc\nG1 X5\n", 2, "the word 'S' has no valid number"),
    "unsafe target": ("G28\nM104 S900\nG1 X5\n", 2, "is outside of its safe range"),
    "not there yet": ("G28\nSYNC_EXTRUDER_MOTION EXTRUDER=extruder\n", 2, "is not there yet"),
    "idle time": ("G28\nM84 S-5\nG1 X5\n", 2, "S is -5: expected at least 0 s"),
    "steps per mm": ("G28\nM92 X0\nG1 X5\n", 2, "X is 0: expected 0.001 to"),
    "microsteps": ("G28\nM350 X16\nG1 X5\n", 2, "steppers is fixed while the printer runs"),
    "another file": ("G28\nM23 b.gcode\nG1 X5\n", 2, "M23 controls prints from files"),
    "start in a macro": ("G28\nSTARTS\nG1 X5\n", 2, "SDCARD_PRINT_FILE controls prints"),
    "setting": ("G28\nM220 S0\nG1 X5\n", 2, "S is 0"),
}
End = tuple[int | None, str]


def end_of(error: BaseException) -> End:
    problem = error.problems[0] if isinstance(error, PassoError) else None
    assert problem is not None
    return problem.line, problem.sentence


def by_command(run, path) -> End:
    try:
        run(path)
    except PassoError as error:
        return end_of(error)
    return 0, ""


def from_card(folder) -> End:
    with Scenario(MACHINE, card=str(folder)) as s:
        s.host.ok("M23 a.gcode")
        s.host.ok("M24")
        runner = s.assembly.services.jobs.runner
        assert s.until(lambda: not runner.active, 900)
        problem = runner.problems[0] if runner.problems else None
        return (problem.line, problem.sentence) if problem else (0, runner.failed)


def by_socket(folder) -> str:
    """The message of print_stats at the end."""

    async def main() -> str:
        async with passo.Printer(MACHINE, card=str(folder)) as printer:
            client = Client(Engine(printer._bridge, lambda _: None, now_s=lambda: 0.0))

            async def ask(method: str, **params: object) -> dict:
                number = client.send(method, **params)
                while number not in client.answers:
                    await asyncio.sleep(0.05)
                return client.answers[number]["result"]

            await ask("gcode/script", script='SDCARD_PRINT_FILE FILENAME="a.gcode"')
            while True:
                await asyncio.sleep(0.5)
                found = (await ask("objects/query", objects={"print_stats": None}))["status"]
                if found["print_stats"]["state"] in ("complete", "error", "cancelled"):
                    return found["print_stats"]["message"]

    return passo.run(main(), clock="virtual")


@pytest.mark.parametrize(("text", "line", "says"), FILES.values(), ids=FILES)
def test_each_way_to_print_ends_at_the_same_line(tmp_path, text, line, says):
    path = tmp_path / "a.gcode"
    path.write_text(text)
    machine = Machine(MACHINE)
    ends = [
        by_command(machine.print, path),
        by_command(machine.estimate, path),
        from_card(tmp_path),
    ]
    told = by_socket(tmp_path)
    print(ends, told)
    assert [end[0] for end in ends] == [line, line, line]
    assert {end[1] for end in ends} == {ends[0][1]}
    assert says in ends[0][1]
    assert (ends[0][1] in told) if line else told == ""
