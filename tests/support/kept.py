"""What tests compile, kept in `build/tests` until a source, a flag or a compiler changes."""

from __future__ import annotations

import fcntl
import pickle
import shutil
import subprocess
from collections.abc import Callable, Iterable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")

ROOT = Path(__file__).parents[2]
FIRMWARE = (ROOT / "firmware", ROOT / "src/passo/toolchain")


def kept(
    name: str, made_from: Iterable[object], compilers: Iterable[str], make: Callable[[Path], T]
) -> T:
    """What `make` has returned for a folder of this name, which it has filled; made anew if
    anything in `made_from` (a path: the content of all files below it) has changed, or a
    compiler. Two processes do not make the same at the same time."""
    folder = ROOT / "build/tests" / name
    folder.parent.mkdir(parents=True, exist_ok=True)
    wanted = sha256()
    for part in (*made_from, *map(_version, compilers)):
        wanted.update(_content(part) if isinstance(part, Path) else repr(part).encode())
        wanted.update(b"\0")
    record = folder / "made.pickle"
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if record.exists():
            found, value = pickle.loads(record.read_bytes())
            if found == wanted.digest():
                return value
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        value = make(folder)
        record.write_bytes(pickle.dumps((wanted.digest(), value)))
        return value


@cache
def _content(path: Path) -> bytes:
    """A hash of the names and the bytes of all files below a path."""
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    found = sha256()
    for file in files:
        if "__pycache__" not in file.parts:
            found.update(f"{file.relative_to(ROOT)}\0".encode() + file.read_bytes())
    return found.digest()


@cache
def _version(compiler: str) -> str:
    """Where a compiler is, and what it says of itself; raises if it is missing."""
    path = shutil.which(compiler)
    assert path, f"{compiler} is missing: make test installs it"
    done = subprocess.run([path, "--version"], capture_output=True, text=True, check=True)
    return path + done.stdout
