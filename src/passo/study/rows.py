"""The rows of a study while it runs: `results.jsonl`, one line for each computed case."""

from __future__ import annotations

import fcntl
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO, Self

from passo.errors import InputError

if TYPE_CHECKING:
    from passo.study.case import Case
    from passo.study.work import Result

NAME = "results.jsonl"


class Rows:
    """Appends rows to the file in a folder. A row that is in the file survives the end of this
    process. A line that was cut by the end of an earlier process is removed."""

    def __init__(self, folder: Path) -> None:
        """Raises InputError if the folder cannot be written, or holds another file of this name."""
        self.path = folder / NAME
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with ExitStack() as stack:
                self._file = stack.enter_context(self.path.open("a+b"))
                _lock(self._file, self.path)
                self.known = dict(self._read())
                self._close = stack.pop_all().close
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def _read(self) -> Iterator[tuple[str, Result]]:
        self._file.seek(0)
        whole = 0
        for number, line in enumerate(self._file, 1):
            if not line.endswith(b"\n"):
                break
            yield _row(line, str(self.path), number)
            whole += len(line)
        self._file.truncate(whole)

    def add(self, rows: Iterable[Mapping[str, Any]]) -> None:
        """Appends rows. A row of a file that has changed is not kept, because the file has another
        id now. Raises InputError."""
        kept = (row for row in rows if row["status"] != "changed")
        text = "".join(f"{json.dumps(row)}\n" for row in kept)
        try:
            self._file.write(text.encode())
            self._file.flush()
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the file."""
        self._close()


def _lock(file: BinaryIO, path: Path) -> None:
    """Keeps other studies away from the file until it is closed."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError.of("study.busy", str(path)) from None


def row_of(case: Case, result: Result) -> dict[str, Any]:
    """One row: the case, and its result."""
    return {
        "id": case.id,
        "file": case.file,
        "machine": case.machine,
        "setting": dict(case.setting),
        **result,
    }


def _row(line: bytes, file: str, number: int) -> tuple[str, Result]:
    try:
        row: dict[str, Any] = json.loads(line)
        result = {k: v for k, v in row.items() if k not in ("id", "file", "machine", "setting")}
        if isinstance(result["status"], str):
            return str(row["id"]), result
    except (ValueError, KeyError, AttributeError, TypeError):
        pass
    raise InputError.of("study.other-rows", file, value=number)


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError.of("study.results", str(path), value=error.strerror or str(error))
