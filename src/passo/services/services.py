"""The services of one printer, for the web, programs and other users of the whole of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts
    from passo.printer.status_reader import StatusReader
    from passo.services.jobs import Jobs


@dataclass(frozen=True, slots=True)
class Services:
    """The services of one printer: `control` carries out commands, `parts` are the machine by
    subject, `status` reads the status, `jobs` are the prints."""

    control: Control
    parts: MachineParts
    status: StatusReader
    jobs: Jobs
