"""Running a program through a job: the one loop that all uses share."""

from __future__ import annotations

import os
from collections.abc import Iterator

from passo import _core
from passo.errors import InputError
from passo.job.source import chunks, open_source
from passo.printer.commands import Commands
from passo.printer.faults import problem_of
from passo.printer.words import Command

_MOST_MESSAGES = 1 << 15


def run_program(
    job: _core.Job, commands: Commands, path: str | os.PathLike[str]
) -> Iterator[float]:
    """Feeds the file to the job and its commands to the printer, to the end.

    Yields the share of the file read, whenever the job has made progress or has as many messages
    as it may; whoever takes them does so then. At the last yield the job is flushed. Raises
    InputError.
    """
    name = str(path)
    status = _core.JobStatus
    with open_source(path) as source:
        size = max(os.fstat(source.fileno()).st_size, 1)
        pieces = chunks(source, name)
        share = 0.0
        while not commands.ended:
            found = job.advance(most=_MOST_MESSAGES)
            if found == status.EVENT:
                wait = commands.run(Command(*job.event))
                if wait is not None:
                    commands.settle(wait)
            elif found == status.NEED_INPUT:
                data = next(pieces, b"")
                if data:
                    job.feed(data)
                    share = min(source.tell() / size, 1.0)
                else:
                    job.finish()
            elif found == status.ERROR:
                raise InputError([problem_of(job, name)])
            elif found == status.END:
                break
            if found != status.EVENT:
                yield share
    job.flush()
    yield 1.0
