"""What a worker of a cluster does. Its functions run there."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from passo import config
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.study.case import Content, unchanged
from passo.study.work import Result, Shard, compute, split
from passo.version import __version__

_TEST = """G28
G92 E0
G1 X20 Y20 Z0.3 F6000
G1 X80 Y30 E2.4
G2 X90 Y40 I0 J10 E3
G1 Y80 E4.8 F3000
"""


class Identity(NamedTuple):
    """The version of Passo, and the hash of the messages of a short print."""

    version: str
    self_test: str


class Outcome(NamedTuple):
    """What a worker has done with a shard: the results so far, the hashes of the files that it
    lacks, and whether the next case took too long."""

    results: list[Result]
    lacking: tuple[str, ...] = ()
    late: bool = False


@cache
def identity() -> Identity:
    """The identity of this process. Workers with the same identity have the same results."""
    with TemporaryDirectory(prefix="passo-") as folder:
        path = Path(folder, "test.gcode")
        path.write_text(_TEST, encoding="utf-8")
        result = Print(config.load("i3"), Policy()).run(path)
    return Identity(__version__, result.stream_hash)


def run_shard(shard: Shard, contents: Mapping[str, bytes], timeout_s: float) -> Outcome:
    """Computes a shard whose files are on this computer, or in `contents` by their hash, or were
    sent before."""
    found = {work.file: _here(work.file, contents) for work in shard.works}
    if lacking := {file.sha256 for file, path in found.items() if path is None}:
        return Outcome([], tuple(sorted(lacking)))
    works = tuple(
        work._replace(file=work.file._replace(path=found[work.file])) for work in shard.works
    )
    results: list[Result] = []
    for single in split(shard._replace(works=works)):
        if (computed := _within(single, timeout_s)) is None:
            return Outcome(results, late=True)
        results += computed
    return Outcome(results)


def _within(shard: Shard, timeout_s: float) -> list[Result] | None:
    """The results of a shard, None after the timeout. The computation is a thread, because a worker
    may not start processes."""
    results: list[Result] = []

    def run() -> None:
        results.extend(compute(shard))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(timeout_s)
    return None if thread.is_alive() else results


def _here(file: Content, contents: Mapping[str, bytes]) -> str | None:
    """The path of a file on this computer."""
    sent = Path(_folder().name, f"{file.sha256}.gcode")
    if file.sha256 in contents and not sent.exists():
        part = sent.with_suffix(f".{threading.get_ident()}")
        part.write_bytes(contents[file.sha256])
        part.replace(sent)
    if sent.exists():
        return str(sent)
    return file.path if unchanged(file) else None


@cache
def _folder() -> TemporaryDirectory[str]:
    """The folder of the files that were sent; it ends with the process."""
    return TemporaryDirectory(prefix="passo-")
