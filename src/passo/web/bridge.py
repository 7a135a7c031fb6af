"""The interface between the web and a printer, which runs in another thread with another clock."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

if TYPE_CHECKING:
    from passo.card import Card, Writer
    from passo.config.machine import MachineConfig
    from passo.events import Event
    from passo.gcode.command import Command
    from passo.gcode.registry import Declaration
    from passo.job.batch.verdict import Verdict
    from passo.job.live.runs import Run
    from passo.learn.explanation import Explanation
    from passo.levelling.correction import Correction
    from passo.printer.console_lines import ConsoleLine
    from passo.printer.status import Queue, QueuedPrint, Status
    from passo.printer.unfit_commands import Skips


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A printer at one moment, immutable. `version` increases with each snapshot; `host_s` is real
    monotonic time, in seconds."""

    version: int
    host_s: float
    status: Status


@dataclass(frozen=True, slots=True)
class PastPrint:
    """A finished print. `number` identifies it; `run` is the run id of its start, or empty;
    `started_s` is the wall clock in seconds since 1970, None if unknown;
    `ended` is done, cancelled, failed or interrupted; `print_s` is print time without pauses;
    `note` is a remark about a problem, or empty."""

    file: str
    size: int
    started_s: float | None
    ended: str
    print_s: float
    filament_mm: float
    note: str
    run: str = ""
    number: int = 0


@dataclass(frozen=True, slots=True)
class SettingValue:
    """A value that a command can set: `command` with `word` and the value. `value` is the active
    value, `file` that of the machine file, and `stored` the value that M500 has stored; each of the
    last two may be None. `source` is the source of the active value: `file`, `stored` or
    `command`."""

    group: str
    command: str
    word: str
    value: str
    file: str | None
    stored: str | None
    source: str


@dataclass(frozen=True, slots=True)
class BedState:
    """The bed correction, None before the first measurement, and whether it is `on`."""

    correction: Correction | None
    on: bool


@dataclass(frozen=True, slots=True)
class SimulatedPart:
    """A part of the simulated printer: its possible faults, `none` first, and its current fault."""

    part: str
    faults: tuple[str, ...]
    active: str


OnLine: TypeAlias = Callable[[str], None]  # receives a line, and returns at once


class Listener(Protocol):
    """Receives snapshots and events. Its methods are called in the web's event loop, and return at
    once."""

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """Called when the printer has changed, at most once a tick; a slow listener misses
        snapshots."""

    def on_event(self, event: Event) -> None:
        """Called for each event, in the order of occurrence."""


class Bridge(Protocol):
    """A printer, for calls from the web's event loop. A waiting method waits for the printer's loop
    without blocking the web's loop; its cancellation ends the wait of its command like M108. All
    methods raise PassoError if the printer refuses."""

    @property
    def machine(self) -> MachineConfig:
        """The machine; it does not change during a run of the program."""
        ...

    @property
    def machine_source(self) -> str:
        """The source of the machine, as `passo.config.load` takes it: the path of a file or the
        name of a shipped machine; empty for one that a program made."""
        ...

    @property
    def skips(self) -> Skips:
        """What prints of this printer may do in place of a failure."""
        ...

    @property
    def places(self) -> Sequence[str]:
        """The addresses for hosts, browsers and Moonraker, each with its kind: `tcp HOST:PORT`,
        `pty PATH`, `serial DEVICE`, `http://HOST:PORT`, `klippy PATH`."""
        ...

    @property
    def commands(self) -> Sequence[Declaration]:
        """The declarations of the commands that the printer has the parts for."""
        ...

    def latest(self) -> Snapshot:
        """The last snapshot. It contains the results of all calls that have ended, and is at most
        0.25 s old while a listener receives snapshots, else 1 s. Never waits."""
        ...

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Sends a listener all snapshots and events from now on. Returns a function that ends
        this."""
        ...

    def console_history(self) -> list[ConsoleLine]:
        """The last lines of all consoles, oldest first, without secrets. Never waits."""
        ...

    # -- commands ---------------------------------------------------------------------------------

    def on_console_line(self, call: Callable[[ConsoleLine], None]) -> Callable[[], None]:
        """Calls `call` in the web's event loop with each line that a console sends or receives from
        now on, without secrets; `call` must return at once. Returns a function that ends the
        calls."""
        ...

    async def run(
        self, script: str, on_line: OnLine | None = None, *, sender: str = ""
    ) -> tuple[str, ...]:
        """Executes lines of G-code, one after the other, and returns the lines of their answers.
        The answer to a move comes when the move is planned. The first line that fails ends the
        script; the states that it has saved (SAVE_GCODE_STATE) are restored then. `on_line` is
        called at once with each answer and its console prefix. `sender` is shown with the lines. A
        script waits for earlier ones; only a single line that acts at once (a report, a temperature
        with F, M108, M112) overtakes them.
        """
        ...

    async def call(self, *commands: Command, sender: str = "") -> tuple[str, ...]:
        """As `run`, for commands with values."""
        ...

    def emergency_stop(self) -> None:
        """Switches all outputs off at once (M112). Never waits."""
        ...

    async def restart(self) -> None:
        """Restarts a halted printer (M999); returns when it runs."""
        ...

    async def restart_program(self) -> None:
        """Ends the printer, and restarts it with the current machine file. Consoles are closed and
        opened again. Raises `job.printing`, `machine.no-restart`, and ConfigError for a file with
        errors; after an error the printer continues."""
        ...

    async def endstops(self) -> dict[str, bool]:
        """Whether each endstop is triggered, by its name."""
        ...

    # -- prints -----------------------------------------------------------------------------------

    async def select_file(self, path: str) -> None:
        """Selects a file of the card, to be printed later."""
        ...

    async def start_print(self, path: str, allow: Collection[str] = (), run: str = "") -> bool:
        """Selects a file of the card and prints it. The print may also do what the fields `allow`
        of Skips name. A `run` starts at most one print, also over restarts of the program: returns
        True if this run id is known, and then nothing has started."""
        ...

    async def run_of(self, run: str) -> Run:
        """The print that was started with a run id."""
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
        """Cancels an object of the print, or prints it again."""
        ...

    async def past_prints(self, most: int) -> list[PastPrint]:
        """The last finished prints, newest first; at most `most`."""
        ...

    async def queue(self) -> Queue:
        """The queued prints."""
        ...

    async def queue_print(self, path: str) -> QueuedPrint:
        """Adds a file of the card at the end of the queue."""
        ...

    async def unqueue_print(self, number: int) -> None:
        """Removes a print from the queue."""
        ...

    async def move_queued_print(self, number: int, place: int) -> None:
        """Moves a print in the queue; position 0 is the next print."""
        ...

    async def set_queue_mode(self, *, automatic: bool) -> None:
        """Sets whether the next print starts without confirmation after a successful print."""
        ...

    async def start_queued_print(self) -> None:
        """Starts the next print of the queue. The caller confirms that the bed is clear."""
        ...

    async def settings(self) -> list[SettingValue]:
        """The settings that commands can change, each value with its source."""
        ...

    async def bed(self) -> BedState:
        """The correction of the bed."""
        ...

    async def simulated_parts(self) -> list[SimulatedPart]:
        """The parts into which faults can be injected; empty if the boards are real."""
        ...

    # -- files ------------------------------------------------------------------------------------

    async def card(self) -> Card:
        """The card, for reading. Its methods block for as long as the medium takes, so call them in
        a worker thread. Raises CardError if there is none."""
        ...

    async def create_file(self, path: str) -> Writer:
        """Starts to write a file of the card, unless it is being printed. Write to it in a worker
        thread; it is on the card after `close` has returned."""
        ...

    async def remove_file(self, path: str) -> None:
        """Deletes a file of the card, unless it is being printed."""
        ...

    async def rename(self, path: str, to: str) -> None:
        """Renames a file or folder of the card, unless it is, or contains, the file that is being
        printed."""
        ...

    async def verdict(self, path: str, take_path: Callable[[bytes], None] | None = None) -> Verdict:
        """Plans a file of the card by the rules of the print; `take_path` is called in the planning
        thread with the planned path, see job/batch/toolpath.py. This takes seconds for a long file,
        in a process of low priority. Plans run one after the other; a cancelled one ends. Raises
        CardError for a file that cannot be read."""
        ...

    async def fitting_machines(self, path: str, most: int) -> list[str]:
        """The names of shipped machines that print a file of the card, at most `most`. Time and
        priority are those of `verdict`, for each machine. Raises CardError."""
        ...

    async def explain(self, path: str, line: int) -> Explanation:
        """Explains a line of a file of the card like `passo explain`. Time, priority and errors are
        those of `verdict`. Raises InputError if the file does not have the line."""
        ...

    async def explain_line(self, line: str, *, before: str = "", after: str = "") -> Explanation:
        """Like `explain`, for a line between the lines `before` and `after`. All axes start at
        0."""
        ...
