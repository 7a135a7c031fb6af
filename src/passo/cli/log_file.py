"""The log of `passo serve`: writes records of standard `logging` to a file, as text or JSON
lines."""

from __future__ import annotations

import json
import logging
import math
import queue
import re
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from datetime import datetime
from logging.handlers import QueueHandler, QueueListener, RotatingFileHandler
from typing import Any, Literal, Self

# maximum size; then the file is renamed to FILE.1, FILE.1 to FILE.2, and so on
MAX_BYTES = 5_000_000
KEPT_FILES = 5  # FILE.1 to FILE.5
_MAX_WAITING = 10_000  # maximum records that wait for a slow disk
LEVELS = {
    "error": logging.ERROR,
    "warning": logging.WARNING,
    "info": logging.INFO,
    "debug": logging.DEBUG,
}
Format = Literal["text", "json"]
# The loggers whose records are written. asyncio logs exceptions in callbacks.
_LOGGERS = ("passo", "asyncio")
_STANDARD = logging.makeLogRecord({}).__dict__.keys() | {"message", "asctime", "taskName"}
_CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]")  # terminal control characters, C0 and C1


class LogFile:
    """A log file, open until the end of the `with` block. A separate thread writes, so that a slow
    disk does not delay the program. Records that cannot be written are lost; the reason appears
    once on standard error.
    """

    def __init__(self, path: str, form: Format, level: str) -> None:
        """Opens the file. Raises OSError."""
        self._path, self._level = path, LEVELS[level]
        self._writer = _Writer(path, self._failed)
        self._writer.setFormatter(JsonFormatter() if form == "json" else TextFormatter())
        waiting: queue.Queue[Any] = queue.Queue(_MAX_WAITING)
        self._handler = _Handler(waiting, self._failed)
        self._handler.addFilter(self._stamp)
        self._listener = QueueListener(waiting, self._writer)
        self._before: dict[str, int] = {}  # levels
        self._has_failed = False
        self._print_time_s: Callable[[], float] | None = None
        self._on_failure: Callable[[str], object] | None = None

    def __enter__(self) -> Self:
        """Starts to write records."""
        for name in _LOGGERS:
            logger = logging.getLogger(name)
            self._before[name] = logger.level
            logger.setLevel(self._level)
            logger.addHandler(self._handler)
        self._listener.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Writes the waiting records, and closes the file."""
        for name in _LOGGERS:
            logger = logging.getLogger(name)
            logger.removeHandler(self._handler)
            logger.setLevel(self._before[name])
        self._listener.stop()
        self._handler.close()
        self._writer.close()

    @contextmanager
    def following(
        self, print_time_s: Callable[[], float], on_failure: Callable[[str], object]
    ) -> Generator[None]:
        """Within the block, records have the print time, seconds, which is read in the thread that
        logs. `on_failure` is called, in any thread, with the reason why records are lost."""
        self._print_time_s, self._on_failure = print_time_s, on_failure
        try:
            yield
        finally:
            self._print_time_s = self._on_failure = None

    def _stamp(self, record: logging.LogRecord) -> bool:
        if self._print_time_s is not None:
            record.print_s = round(self._print_time_s(), 3)
        return True

    def _failed(self, reason: str) -> None:
        if not self._has_failed:
            self._has_failed = True
            text = f"The log {self._path} is not complete: {reason}"
            print(text, file=sys.stderr)
            if self._on_failure is not None:
                self._on_failure(text)


class _Handler(QueueHandler):
    """Passes records to the writing thread; drops them if it is too slow."""

    def __init__(self, waiting: queue.Queue[Any], failed: Callable[[str], None]) -> None:
        super().__init__(waiting)
        self._failed = failed

    def prepare(self, record: logging.LogRecord) -> logging.LogRecord:
        """Returns the record unchanged, because it stays in this process."""
        return record

    def enqueue(self, record: logging.LogRecord) -> None:
        """Puts the record into the queue."""
        try:
            self.queue.put_nowait(record)
        except queue.Full:
            self._failed(f"{_MAX_WAITING} records wait for the disk")


class _Writer(RotatingFileHandler):
    """Writes records to the file. If the disk is full, it tries again with the next record."""

    def __init__(self, path: str, failed: Callable[[str], None]) -> None:
        super().__init__(
            path,
            maxBytes=MAX_BYTES,
            backupCount=KEPT_FILES,
            encoding="utf-8",
            errors="backslashreplace",  # for bytes of a host that are not text
        )
        self._failed = failed

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802
        """Reports the exception that `emit` has caught."""
        error = sys.exc_info()[1]
        reason = error.strerror if isinstance(error, OSError) else None
        self._failed(reason or f"{type(error).__name__}: {error}")

    def close(self) -> None:
        """Closes the file, even if a full disk refuses the rest."""
        try:
            super().close()
        except OSError as error:
            self._failed(error.strerror or str(error))


def _time(record: logging.LogRecord) -> str:
    """Wall-clock time with its offset from UTC, ISO 8601."""
    return datetime.fromtimestamp(record.created).astimezone().isoformat(timespec="milliseconds")


class TextFormatter(logging.Formatter):
    """`TIME PRINT_TIME LEVEL LOGGER: MESSAGE [CODE]`, one line for each record; a traceback is
    indented below it."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as lines."""
        print_s: float | None = getattr(record, "print_s", None)
        passed = "-" if print_s is None else f"{print_s:.3f} s"
        code: str = getattr(record, "code", "")
        text = f"{record.getMessage()} [{code}]" if code else record.getMessage()
        if record.exc_info and record.exc_info[0]:
            text += "\n" + self.formatException(record.exc_info)
        text = _CONTROL.sub(lambda c: f"\\x{ord(c[0]):02x}", text).replace("\n", "\n    ")
        return f"{_time(record)} {passed} {record.levelname} {record.name}: {text}"


class JsonFormatter(logging.Formatter):
    """One JSON object per record: time, print_s, level, logger, message, and further fields of the
    record, for example code, part, axis, value, limit, file, console, exception."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as one line."""
        about: dict[str, Any] = {"time": _time(record)}
        if (print_s := getattr(record, "print_s", None)) is not None:
            about["print_s"] = print_s
        about |= {"level": record.levelname, "logger": record.name, "message": record.getMessage()}
        for name, value in record.__dict__.items():
            if name not in _STANDARD and name not in about:
                about[name] = _plain(value)
        if record.exc_info and record.exc_info[0]:
            about["exception"] = self.formatException(record.exc_info)
        return json.dumps(about, ensure_ascii=False)


def _plain(value: object) -> object:
    """The value in a form that JSON supports; infinity and NaN become text."""
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value if isinstance(value, bool | int | str) or value is None else str(value)
