"""A bridge without a printer: what it is asked is written down, what it tells is up to the test."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from passo import config
from passo.card import Card, Writer, open_card
from passo.config.machine import MachineConfig
from passo.errors import CardError, CommandError, PassoError
from passo.events import Event
from passo.gcode.command import Command
from passo.gcode.registry import Declaration, table
from passo.job.batch.estimate import Estimate
from passo.job.batch.verdict import Verdict
from passo.job.live.runs import Run
from passo.learn.explanation import Explanation
from passo.printer.console_lines import ConsoleLine
from passo.printer.status import (
    AdvanceStatus,
    AxisStatus,
    BoardStatus,
    HeaterStatus,
    MotionStatus,
    PrinterState,
    Queue,
    QueuedPrint,
    ShaperStatus,
    Status,
)
from passo.printer.unfit_commands import NOTHING
from passo.web.bridge import (
    BedState,
    Listener,
    OnLine,
    PastPrint,
    SettingValue,
    SimulatedPart,
    Snapshot,
)

STATUS = Status(
    state=PrinterState.IDLE,
    halted="",
    time_s=12.5,
    position_mm={"x": 10.0, "y": 20.0, "z": 0.3, "e": 1.5},
    homed=frozenset("xyz"),
    tool=0,
    heaters={
        "hotend": HeaterStatus(25.0, 0.0, 0.0),
        "bed": HeaterStatus(60.0, 60.0, 0.4),
    },
    fans={"part": 0.0},
    speed_factor=1.0,
    motion=MotionStatus(
        0.0,
        0.0,
        0.0,
        200.0,
        3000.0,
        True,
        True,
        50.0,
        True,
        (10.0, 20.0, 0.35, 1.5),
        (10.0, 20.0, 0.3, 1.5),
        0.0,
        0.02,
        5.0,
    ),
    axes={
        "x": AxisStatus(10.0, 10.0, True, 0.0, 250.0),
        "y": AxisStatus(20.0, 20.0, True, 0.0, 220.0),
        "z": AxisStatus(0.3, 0.3, True, 0.0, 250.0, 0.05),
    },
    boards={"main": BoardStatus("0.1.0", "atmega2560", 16e6, True, 665, 0)},
    flow_factors=[1.0],
    shapers={"x": ShaperStatus("mzv", 50.0, 0.1)},
    advances=(AdvanceStatus(0.05, 0.04),),
)


class FakeBridge:
    """`status` is what `latest` tells; `asked` lists the calls; `answers` maps a script to its
    answer, or to the error that it raises."""

    def __init__(self, card: str | None = None, machine: str = "i3") -> None:
        self._machine = config.load(machine)
        self.machine_source = machine
        self._card = None if card is None else open_card(card)
        self._snapshot = Snapshot(1, 100.0, STATUS)
        self.listeners: list[Listener] = []
        self.asked: list[str] = []
        self.answers: dict[str, tuple[str, ...] | PassoError] = {}
        self.estimated: list[str] = []
        self.verdicts: dict[str, Verdict] = {}
        self.skips = NOTHING
        self.history: list[ConsoleLine] = []
        self.line_listeners: list[Callable[[ConsoleLine], None]] = []
        self.senders: list[str] = []
        self.prints: list[PastPrint] = []
        self.runs: dict[str, Run] = {}
        self.values: list[SettingValue] = []
        self.bed_state = BedState(None, on=False)

    @property
    def machine(self) -> MachineConfig:
        return self._machine

    @property
    def places(self) -> Sequence[str]:
        return ("tcp 127.0.0.1:2000", "http://127.0.0.1:4000")

    @property
    def commands(self) -> Sequence[Declaration]:
        return tuple(table().values())

    def latest(self) -> Snapshot:
        return self._snapshot

    def show(self, status: Status) -> None:
        """The printer is so from now on."""
        self._snapshot = Snapshot(self._snapshot.version + 1, self._snapshot.host_s + 0.25, status)
        for listener in self.listeners:
            listener.on_snapshot(self._snapshot)

    def tell(self, event: Event) -> None:
        """Something happens."""
        for listener in self.listeners:
            listener.on_event(event)

    def listen(self, listener: Listener) -> Callable[[], None]:
        self.listeners.append(listener)
        return lambda: self.listeners.remove(listener)

    def console_history(self) -> list[ConsoleLine]:
        return self.history

    def on_console_line(self, call: Callable[[ConsoleLine], None]) -> Callable[[], None]:
        self.line_listeners.append(call)
        return lambda: self.line_listeners.remove(call)

    async def run(
        self, script: str, on_line: OnLine | None = None, *, sender: str = ""
    ) -> tuple[str, ...]:
        self.senders.append(sender)
        answer = self._answer(script)
        for line in answer if on_line else ():
            on_line(line)
        return answer

    async def call(self, *commands: Command, sender: str = "") -> tuple[str, ...]:
        script = "\n".join(f"{c.code} {c.text}".rstrip() for c in commands)
        return await self.run(script, sender=sender)

    async def endstops(self) -> dict[str, bool]:
        self._answer("endstops")
        return {"x": False, "y": False, "z": True}

    def emergency_stop(self) -> None:
        self.asked.append("emergency stop")

    async def restart(self) -> None:
        self._answer("restart")

    async def restart_program(self) -> None:
        self._answer("restart program")

    async def select_file(self, path: str) -> None:
        self._answer(f"select {path}")

    async def start_print(self, path: str, allow: Collection[str] = (), run: str = "") -> bool:
        self._answer(" ".join(("print", path, *allow)))
        known = run in self.runs
        if run:
            self.runs.setdefault(run, Run(run, path, "printing"))
        return known

    async def run_of(self, run: str) -> Run:
        if run not in self.runs:
            raise CommandError.of("run.unknown", value=run, limit=100)
        return self.runs[run]

    async def pause_print(self) -> None:
        self._answer("pause")

    async def resume_print(self) -> None:
        self._answer("resume")

    async def cancel_print(self) -> None:
        self._answer("cancel")

    async def cancel_object(self, number: int, *, cancelled: bool) -> None:
        self._answer(f"{'cancel' if cancelled else 'restore'} object {number}")

    async def queue(self) -> Queue:
        return Queue((), automatic=False)

    async def queue_print(self, path: str) -> QueuedPrint:
        self._answer(f"queue {path}")
        return QueuedPrint(1, path)

    async def unqueue_print(self, number: int) -> None:
        self._answer(f"unqueue {number}")

    async def move_queued_print(self, number: int, place: int) -> None:
        self._answer(f"move {number} to {place}")

    async def set_queue_mode(self, *, automatic: bool) -> None:
        self._answer(f"queue automatic {automatic}")

    async def start_queued_print(self) -> None:
        self._answer("start next")

    async def past_prints(self, most: int) -> list[PastPrint]:
        return self.prints[:most]

    async def settings(self) -> list[SettingValue]:
        return self.values

    async def bed(self) -> BedState:
        return self.bed_state

    async def simulated_parts(self) -> list[SimulatedPart]:
        return [SimulatedPart("cable", ("none", "cut"), "none")]

    async def card(self) -> Card:
        if self._card is None:
            raise CardError.of("card.absent", value="start with --sd")
        return self._card

    async def create_file(self, path: str) -> Writer:
        self._answer(f"create {path}")
        return (await self.card()).create(path)

    async def remove_file(self, path: str) -> None:
        self._answer(f"remove {path}")
        (await self.card()).remove(path)

    async def rename(self, path: str, to: str) -> None:
        self._answer(f"rename {path} {to}")
        (await self.card()).rename(path, to)

    async def verdict(self, path: str, take_path: Callable[[bytes], None] | None = None) -> Verdict:
        self.estimated.append(path)
        answer = self.answers.get(f"estimate {path}")
        if isinstance(answer, PassoError):
            raise answer
        if path in self.verdicts:
            return self.verdicts[path]
        if take_path:
            take_path(f"path of {path}".encode())
        return Verdict(Estimate(path, self._machine.name, 60.0, moves=1))

    async def fitting_machines(self, path: str, most: int) -> list[str]:
        self._answer(f"fits {path}")
        return ["ender3", "corexy"][:most]

    async def explain(self, path: str, line: int) -> Explanation:
        self._answer(f"explain {path} {line}")
        return Explanation(f"{path}:{line}", "G28", "", False, ())

    async def explain_line(self, line: str, *, before: str = "", after: str = "") -> Explanation:
        self._answer(f"explain {line}")
        return Explanation("line.gcode:1", line, "", False, ())

    def _answer(self, asked: str) -> tuple[str, ...]:
        self.asked.append(asked)
        answer = self.answers.get(asked, ())
        if isinstance(answer, PassoError):
            raise answer
        return answer
