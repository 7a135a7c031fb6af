"""The cases of a study: one file on one machine under one setting, each with an id by content."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from passo import _core
from passo.errors import InputError
from passo.job.batch.source import chunks, open_source
from passo.version import __version__

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.study.study_file import Options, What


class Order(NamedTuple):
    """What is computed of a file, and what a file may do in place of a failure. Picklable."""

    what: What
    options: Options


class Content(NamedTuple):
    """A file: its path on this computer, its size in bytes, and the hash of its content."""

    path: str
    size: int
    sha256: str


class Work(NamedTuple):
    """One case for a worker: its id, its file, and the digest of its machine. Picklable."""

    id: str
    file: Content
    machine: str


@dataclass(frozen=True, slots=True)
class Case:
    """One row of a study. `file` and `machine` are the names of the study. A file that cannot be
    read, and a setting that the machine file refuses, have no `work`, but a `result`."""

    file: str
    machine: str
    setting: Mapping[str, Any]
    id: str
    work: Work | None
    result: Mapping[str, Any] = field(default_factory=dict[str, Any])


class Machines:
    """The pickled machines of a study by their digest. The digest is that of all values, so that
    two settings that make the same machine are one."""

    def __init__(self) -> None:
        self.pickled: dict[str, bytes] = {}

    def add(self, machine: MachineConfig) -> str:
        """Keeps the machine, and returns its digest."""
        digest = _hash(machine.model_dump_json())
        if digest not in self.pickled:
            self.pickled[digest] = pickle.dumps(machine)
        return digest


def case_id(sha256: str, machine: str, order: Order) -> str:
    """The id of a case: equal ids have equal results. It covers the content of the file, the values
    of the machine, the options, and the program with its core."""
    options = order.options.model_dump(mode="json")
    return _hash(json.dumps([sha256, machine, program_digest(), order.what, options]))


def content_of(path: Path) -> Content:
    """The size and hash of a file. Raises InputError if it cannot be read or is empty."""
    digest = hashlib.sha256()
    with open_source(path) as file:
        for piece in chunks(file, str(path)):
            digest.update(piece)
        return Content(os.path.abspath(path), file.tell(), digest.hexdigest())  # noqa: PTH100


def unchanged(file: Content) -> bool:
    """Whether the file still has the content of its hash."""
    try:
        about = Path(file.path).stat()
    except OSError:
        return False
    return _hash_at(file.path, about.st_mtime_ns, about.st_size) == file.sha256


@lru_cache(1024)
def _hash_at(path: str, mtime_ns: int, size: int) -> str:
    """The hash of a file; the times of its changes make one call for each content."""
    try:
        return content_of(Path(path)).sha256
    except InputError:
        return ""


@cache
def program_digest() -> str:
    """The version of Passo, with the hash of its Python files and of its core."""
    root = Path(__file__).parents[1]
    digest = hashlib.sha256(Path(_core.__file__).read_bytes())
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return f"{__version__}+{digest.hexdigest()[:32]}"


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]
