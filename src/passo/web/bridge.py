"""The interface between the web and a printer, which runs in another thread with a time of its
own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

from passo.job.live.print_queue import QueuedPrint

if TYPE_CHECKING:
    from passo.card import Card, Writer
    from passo.config.machine import MachineConfig
    from passo.events import Event
    from passo.gcode.registry import Declaration
    from passo.job.batch.estimate import Estimate
    from passo.learn.explanation import Explanation
    from passo.levelling.correction import Correction
    from passo.printer.console_lines import ConsoleLine
    from passo.printer.status import Status


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A printer at one moment, immutable. `version` counts up with each snapshot; `host_s` is real
    monotonic time, in seconds."""

    version: int
    host_s: float
    status: Status


@dataclass(frozen=True, slots=True)
class PastPrint:
    """A print that is over. `started_s` is the wall clock in seconds since 1970, None if that is
    not known; `ended` is done, cancelled, failed or interrupted; `print_s` is print time without
    pauses; `note` is a remark about a problem, or empty."""

    file: str
    size: int
    started_s: float | None
    ended: str
    print_s: float
    filament_mm: float
    note: str


@dataclass(frozen=True, slots=True)
class SettingValue:
    """A value that commands set: `command` with `word` and a value sets it. `value` is in force,
    `file` is that of the machine file (None: it has none), `stored` the one that M500 has stored
    (None: none is). `source` says which of them is in force: `file`, `stored` or `command`."""

    group: str
    command: str
    word: str
    value: str
    file: str | None
    stored: str | None
    source: str


@dataclass(frozen=True, slots=True)
class Queue:
    """The prints that wait, the next one first. With `automatic` the next one starts without
    confirmation after one that has succeeded; otherwise it waits until a user confirms that the bed
    is clear."""

    prints: tuple[QueuedPrint, ...]
    automatic: bool


@dataclass(frozen=True, slots=True)
class BedState:
    """What is added to Z: `correction`, None before the first measurement, and whether it is
    `on`."""

    correction: Correction | None
    on: bool


@dataclass(frozen=True, slots=True)
class SimulatedPart:
    """A part of the simulated printer: the faults that it can have, `none` first, and the one that
    it has now."""

    part: str
    faults: tuple[str, ...]
    active: str


Hearer: TypeAlias = Callable[[str], None]  # of a line; returns at once


class Listener(Protocol):
    """Receives snapshots and events. Its methods are called in the web's event loop, and return at
    once."""

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """The printer has changed. At most one call each tick; a slow listener misses some."""

    def on_event(self, event: Event) -> None:
        """An event, in the order of occurrence."""


class Bridge(Protocol):
    """A printer, for calls from the web's event loop. Methods that wait do so for the printer's
    loop, never for the web's; a cancelled one ends its command's wait as M108 does. All raise
    PassoError if the printer refuses."""

    @property
    def machine(self) -> MachineConfig:
        """The machine, which stays the same."""
        ...

    @property
    def machine_source(self) -> str:
        """The source of the machine, as `passo.config.load` takes it: the path of a file or the
        name of a shipped machine; empty for one that a program made."""
        ...

    @property
    def places(self) -> Sequence[str]:
        """Where hosts, browsers and Moonraker connect, each with its kind: `tcp HOST:PORT`, `pty
        PATH`, `serial DEVICE`, `http://HOST:PORT`, `klippy PATH`."""
        ...

    @property
    def commands(self) -> Sequence[Declaration]:
        """Each command that the printer knows, as the table declares it."""
        ...

    def latest(self) -> Snapshot:
        """The last snapshot. Never waits."""
        ...

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Sends a listener all snapshots and events from now on; returns a function that ends
        it."""
        ...

    def console_history(self) -> list[ConsoleLine]:
        """The last lines of all consoles, oldest first, without secrets. Never waits."""
        ...

    # -- commands ---------------------------------------------------------------------------------

    def on_console_line(self, call: Callable[[ConsoleLine], None]) -> Callable[[], None]:
        """Calls `call` in the web's event loop with each line that a console sends or receives from
        now on, without secrets; it returns at once. Returns a function that ends it."""
        ...

    async def run(
        self, script: str, heard: Hearer | None = None, *, sender: str = ""
    ) -> tuple[str, ...]:
        """Carries out lines of G-code, one after the other, and returns their answers, a string a
        line. A move is answered when it is planned. The first line that fails ends the script; of
        the lines after it only RESTORE_GCODE_STATE without MOVE is carried out. `heard` is called
        with each answer at once, with its console prefix; `sender` is shown with its lines.

        Scripts do not mix: each waits for the earlier ones. Only a single line that acts at once (a
        report, a temperature with F, M108, M112) overtakes them.
        """
        ...

    def emergency_stop(self) -> None:
        """Switches everything off at once (M112). Never waits."""
        ...

    async def restart(self) -> None:
        """Restarts a halted printer (M999); returns when it runs."""
        ...

    async def restart_program(self) -> None:
        """Ends the printer, and restarts it with its current machine file. Consoles are closed and
        opened again. Raises `job.printing`, `machine.no-restart`, and ConfigError for a file with
        errors: then the printer continues."""
        ...

    async def endstops(self) -> dict[str, bool]:
        """Whether each endstop is triggered, by its name."""
        ...

    # -- prints -----------------------------------------------------------------------------------

    async def select_file(self, path: str) -> None:
        """Selects a file of the card, to be printed later."""
        ...

    async def start_print(self, path: str) -> None:
        """Selects a file of the card and prints it."""
        ...

    async def pause_print(self) -> None:
        """Pauses the print; the machine brakes and parks."""
        ...

    async def resume_print(self) -> None:
        """Resumes a paused print, or continues after the line that failed."""
        ...

    async def cancel_print(self) -> None:
        """Ends the print; heaters and fans go off."""
        ...

    async def cancel_object(self, number: int, *, cancelled: bool) -> None:
        """Leaves an object out of the print, or prints it again."""
        ...

    async def past_prints(self, most: int) -> list[PastPrint]:
        """The newest prints that are over, newest first."""
        ...

    async def queue(self) -> Queue:
        """The prints that wait."""
        ...

    async def queue_print(self, path: str) -> QueuedPrint:
        """Puts a file of the card at the end of the queue."""
        ...

    async def unqueue_print(self, number: int) -> None:
        """Takes a print out of the queue."""
        ...

    async def move_queued_print(self, number: int, place: int) -> None:
        """Moves a print in the queue; position 0 is the next print."""
        ...

    async def set_queue_mode(self, *, automatic: bool) -> None:
        """Sets whether the next print starts without confirmation after one that has succeeded."""
        ...

    async def start_queued_print(self) -> None:
        """Starts the next print of the queue: the bed is clear."""
        ...

    async def settings(self) -> list[SettingValue]:
        """The settings that commands can change, each value with its source."""
        ...

    async def bed(self) -> BedState:
        """The correction of the bed."""
        ...

    async def simulated_parts(self) -> list[SimulatedPart]:
        """The parts that can be given faults; empty where the boards are real."""
        ...

    # -- files ------------------------------------------------------------------------------------

    async def card(self) -> Card:
        """The card, to read it: its methods block for as long as the medium takes, so call them in
        a worker thread. Raises CardError if there is none."""
        ...

    async def create_file(self, path: str) -> Writer:
        """Begins a file of the card, unless it is printed now. Write to it in a worker thread: it
        is on the card once `close` has returned."""
        ...

    async def remove_file(self, path: str) -> None:
        """Deletes a file of the card, unless it is printed now."""
        ...

    async def rename(self, path: str, to: str) -> None:
        """Renames a file or folder of the card, unless it is, or holds, what is printed now."""
        ...

    async def estimate(
        self, path: str, take_path: Callable[[bytes], None] | None = None
    ) -> Estimate:
        """Plans a file of the card; `take_path` is called in the planning thread with the planned
        path, see job/batch/toolpath.py. That takes seconds for a long file, in a thread of low
        priority; one estimate waits for another, and a cancelled one ends. Raises PassoError for a
        file that cannot be printed as it is."""
        ...

    async def explain(self, path: str, line: int) -> Explanation:
        """Explains a line of a file of the card as `passo explain` does; otherwise as `estimate`.
        Raises InputError for a line that the file does not have."""
        ...

    async def explain_line(self, line: str, *, before: str = "", after: str = "") -> Explanation:
        """As `explain`, of a line between the lines `before` and `after` it; the first of all
        starts with all axes at 0."""
        ...
