"""Every kind of wait for a temperature in scaled real time, with all processors busy."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.support.scenario import Scenario
from tests.support.waits import NEAR_C, WAITS, Waits, machine

from passo.clock import ScaledLoop
from passo.config.machine import MachineConfig
from passo.console.session import Session
from passo.library.assembly import assembled

SCALE = 40
MAX_S = 900.0  # of print time, for the slowest wait
SWAYS = tuple(f"G1 X{i % 2 * 9} F600" for i in range(20))
PAUSES = {
    "M600 S": Waits(("M302 P1", "M109 S50", "M600 S65", "G4 P10"), {"hotend": 65}),
    "a long pause": Waits(("M109 S60", "M601", "G4 P10"), {"hotend": 60}),
    "M303": Waits(("M104 S90", "M303 E0 S60 C3", "M109 S75"), {"hotend": 75}),
    "M1000": Waits(("M140 S35", "M190 S35", "M104 S60", *SWAYS, "M109"), {"hotend": 60, "bed": 35}),
}
KINDS = WAITS | PAUSES
PAUSED = ("echo:Change the filament", "echo:Heater hotend off in a long pause")


def config_of(waits: Waits) -> MachineConfig:
    found = machine(waits.machine)
    return found.model_copy(update={"idle": found.idle.model_copy(update={"heaters_off_s": 30.0})})


class Print:
    """One printer that prints a file from its card. At `M118 reached` it reads its heaters."""

    def __init__(self, kind: str, folder: Path) -> None:
        self.kind, self.waits = kind, KINDS[kind]
        self.card, self.state = folder / "card", folder / "state"
        self.card.mkdir(parents=True)
        (self.card / "a.g").write_text("\n".join((*self.waits.lines, "M118 reached")))
        self.command = "M32 a.g"
        self.heard: list[str] = []
        self.celsius: dict[str, float] = {}

    def interrupt(self) -> None:
        """It has been printed in part, up to a power cut."""
        with Scenario(card=str(self.card), state=str(self.state)) as s:
            s.host.ok("G92 X0 Y0 Z0")
            s.host.send("M32 a.g")
            start = s.positions()["x"]
            assert s.until(lambda: s.positions()["x"] > start + 5, MAX_S)
            s.passes(3)
        self.command = "M1000"

    def write(self, text: bytes, **_: bool) -> None:
        for line in text.decode().splitlines():
            self.heard.append(line)
            if line == "reached":
                heaters = self.printer.rig.connection.heaters
                self.celsius = {n: heaters[n].celsius for n in self.waits.warm}
                self.done.set()
            if line.startswith(PAUSED):
                asyncio.get_running_loop().call_later(9.0, self.session.receive, b"M24\n")

    def hold(self, held: bool) -> None:
        del held

    async def run(self) -> None:
        self.done = asyncio.Event()
        self.printer = assembled(
            config_of(self.waits), card=str(self.card), state=str(self.state)
        ).printer
        serving = asyncio.create_task(self.printer.run())
        try:
            self.session = Session(self.printer.control, self)
            self.session.receive(f"{self.command}\n".encode())
            async with asyncio.timeout(MAX_S):
                await self.done.wait()
        finally:
            serving.cancel()
            self.session.close()
            self.printer.close()


@pytest.fixture(scope="module")
def prints(tmp_path_factory) -> dict[str, Print]:
    """All kinds, printed at the same time, while other processes want the same processors."""
    made = {
        kind: Print(kind, tmp_path_factory.mktemp("prints") / str(i))
        for i, kind in enumerate(KINDS)
    }
    made["M1000"].interrupt()
    busy = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(2 * (os.cpu_count() or 1))
    ]

    async def all_at_once() -> None:
        await asyncio.gather(*(p.run() for p in made.values()), return_exceptions=True)

    try:
        with asyncio.Runner(loop_factory=lambda: ScaledLoop(SCALE)) as runner:
            runner.run(all_at_once())
    finally:
        for process in busy:
            process.kill()
            process.wait()
    return made


@pytest.mark.parametrize("kind", KINDS)
def test_a_wait_ends_warm_on_a_busy_computer(kind, prints):
    found = prints[kind]
    assert found.celsius == pytest.approx(found.waits.warm, abs=NEAR_C), found.heard
