"""The interface between the hub and one printer, of any firmware."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from passo.hub.views import Kind
from passo.web.summary import Summary

# Seconds after the last word of a printer until its link gives it up. Each link sends heartbeats.
SILENT_S = 30.0


class Unreachable(Exception):
    """No answer: the request may or may not have reached the printer."""


class Refused(Exception):
    """The printer has answered that it does not do it: a code, a sentence, and the next action."""

    def __init__(self, code: str, text: str, action: str) -> None:
        super().__init__(text)
        self.code, self.text, self.action = code, text, action

    def __reduce__(self) -> tuple[object, ...]:
        """Pickles the error with its code and action."""
        return type(self), (self.code, self.text, self.action), self.__dict__


class StartUnknown(Exception):
    """The printer is there, but it cannot tell whether it has received a start, or what became of
    it: its firmware keeps no ids of runs. A person must look."""


@dataclass(frozen=True, slots=True)
class RunReport:
    """What a printer says of a run that it has started once. `state` is printing, paused, done,
    cancelled or failed; `reason` says why it failed."""

    state: str
    reason: str = ""


@dataclass(frozen=True, slots=True)
class PrinterRecord:
    """What the hub needs to reach a printer. `id` is the printer's own UUID; for a printer that has
    none, one that the hub has made. `key` is its API key, or empty."""

    id: str
    name: str
    url: str
    kind: Kind
    key: str


class Link(Protocol):
    """One printer. All calls raise Unreachable, and Refused where the printer refuses. `user` is
    who asks, for the log of the printer."""

    async def follow(self, seen: Callable[[Summary], None]) -> None:
        """Calls `seen` with the printer's summary at once and at each change, until the connection
        ends: then it raises Unreachable, at most `SILENT_S` after the printer's last word."""
        ...

    async def upload(self, content: Path, name: str, sha256: str) -> str:
        """Stores a file on the printer and returns its path there. The same file again is no
        error."""
        ...

    async def start(self, run: str, path: str, user: str) -> None:
        """Starts a print, unless this run was started before: then nothing happens."""
        ...

    async def report(self, run: str) -> RunReport | None:
        """What has become of a run; None if the printer knows for certain that it has never
        received this start. Raises StartUnknown if the printer cannot know."""
        ...

    async def pause(self, user: str) -> None:
        """Pauses the print."""
        ...

    async def resume(self, user: str) -> None:
        """Resumes the print."""
        ...

    async def cancel(self, user: str) -> None:
        """Cancels the print."""
        ...

    async def stop(self, user: str) -> None:
        """Emergency stop."""
        ...

    async def machine(self) -> str:
        """The machine file in TOML, or an empty text if the printer has none."""
        ...

    async def picture(self, path: str) -> bytes:
        """The thumbnail of a file, PNG; empty if it has none."""
        ...

    async def close(self) -> None:
        """Ends all connections."""
        ...
