"""Starts of prints with a run id: each run id starts at most one print, also after a lost answer, a
kill of the program or a power cut."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias, cast, get_args
from uuid import UUID

from passo.errors import CommandError, PassoError
from passo.job.durable_files import load_json, store_json
from passo.job.live.job_state import JobState

if TYPE_CHECKING:
    from passo.job.live.runner import Runner
    from passo.printer.state import State

_log = logging.getLogger(__name__)

MAX_RUNS = 100

RunState: TypeAlias = Literal["printing", "paused", "done", "cancelled", "failed"]
_NOT_BEGUN = "Passo ended before the print began"
_CUT = "Passo ended during the print"


@dataclass(frozen=True, slots=True)
class Run:
    """A print that was started with a run id. `file` is its path on the card; `reason` says why it
    has failed. A print that has never begun has failed."""

    run: str
    file: str
    state: RunState
    reason: str = ""


class Runs:
    """The last `MAX_RUNS` runs of one printer. They are stored in `folder`; None keeps them only in
    memory. What is stored is what holds if the program is killed now: a run that waits or prints is
    stored as failed."""

    def __init__(self, state: State, runner: Runner, folder: Path | None) -> None:
        self._state, self._runner = state, runner
        self._path = None if folder is None else folder / "runs.json"
        self._damaged: CommandError | None = None
        self._runs: dict[str, Run] = {}  # the oldest first
        self._load()
        runner.watchers.append(self._job_changed)

    def start_once(self, run: str, file: str, start: Callable[[str], None]) -> bool:
        """Calls `start` with the run id, to start its print, unless the run id is known. Returns
        whether it is known. The run is durable before `start` is called. Raises CommandError if it
        cannot be stored; then nothing has started, and the run id is unknown. Raises the errors of
        `start`; then the run has failed."""
        run = _canonical(run)
        self._require_readable()
        if run in self._runs:
            return True
        try:
            self._keep(Run(run, file, "failed", _NOT_BEGUN))
        except OSError as error:
            why = error.strerror or str(error)
            raise CommandError.of("run.unwritable", str(self._path), value=why) from None
        try:
            start(run)
        except PassoError as error:
            self._change(run, "failed", str(error))
            raise
        return False

    def find(self, run: str) -> Run:
        """A run in its present state. Raises CommandError for an unknown one."""
        run = _canonical(run)
        self._require_readable()
        found = self._runs.get(run)
        if found is None:
            raise CommandError.of("run.unknown", value=run, limit=MAX_RUNS)
        runner = self._runner
        if runner.run != run or not (runner.engaged or runner.state is JobState.STARTING):
            return found
        paused = runner.state is JobState.PAUSED
        return replace(found, state="paused" if paused else "printing", reason="")

    def _job_changed(self, was: JobState, state: JobState) -> None:
        run = self._runner.run
        if run not in self._runs:
            return
        if state.active and not was.active:
            self._change(run, "failed", _CUT)
        elif was.active and not state.active:
            self._change(run, cast("RunState", self._runner.ended), self._runner.failed)
        elif was is JobState.STARTING:
            self._change(run, "cancelled", "")

    def _change(self, run: str, state: RunState, reason: str) -> None:
        """Changes the stored state of a run. If that fails, it is right until the program ends."""
        found = replace(self._runs[run], state=state, reason=reason)
        try:
            self._keep(found)
        except OSError as error:
            self._runs[run] = found
            text = f"The state of a print is not stored in {self._path}: {error.strerror or error}"
            self._state.announce(_log, logging.WARNING, text)

    def _keep(self, run: Run) -> None:
        runs = {**self._runs, run.run: run}
        last = dict(list(runs.items())[-MAX_RUNS:])
        if self._path is not None:
            store_json(self._path, {"runs": [asdict(run) for run in last.values()]})
        self._runs = last

    def _load(self) -> None:
        if self._path is None:
            return
        try:
            kept = load_json(self._path)
            if kept is None:
                return
            for row in kept["runs"]:
                run = Run(
                    _canonical(row["run"]), str(row["file"]), row["state"], str(row["reason"])
                )
                if run.state not in get_args(RunState):
                    raise ValueError(f"{run.state!r} is not a state")
                self._runs[run.run] = run
        except (OSError, ValueError, KeyError, TypeError, AttributeError, CommandError) as error:
            self._damaged = CommandError.of("run.damaged", str(self._path), value=error)
            self._state.announce(_log, logging.WARNING, str(self._damaged))

    def _require_readable(self) -> None:
        if self._damaged is not None:
            raise self._damaged


def _canonical(run: str) -> str:
    """A run id in lower case with hyphens. Raises CommandError if it is not a UUID."""
    try:
        return str(UUID(run))
    except ValueError:
        raise CommandError.of("run.invalid", value=run) from None
