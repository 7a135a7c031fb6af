"""The results of a study as a table: sorted, without times of the computer or host names, so that
the same study gives the same bytes on every engine."""

from __future__ import annotations

import csv
import json
from collections.abc import Generator, Iterable, Mapping
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any, cast

from passo.errors import InputError
from passo.job.durable_files import replaced

CSV, PARQUET = "results.csv", "results.parquet"
SET = "set "  # the beginning of the columns of a setting
_FIRST = ("id", "file", "machine")
_LAST = ("code", "line", "message", "warnings")


def flat(row: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The row with tables as columns (`filament_mm.e`); lists are text."""
    columns: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, dict) and f"{prefix}{name}" != "setting":
            columns |= flat(cast("dict[str, Any]", value), f"{prefix}{name}.")
        elif isinstance(value, dict):
            columns |= {f"{SET}{key}": v for key, v in cast("dict[str, Any]", value).items()}
        elif name == "warnings":
            columns[name] = " ".join(cast("list[str]", value))
        else:
            columns[f"{prefix}{name}"] = value
    return {k: json.dumps(v) if isinstance(v, list | dict) else v for k, v in columns.items()}


def table_of(rows: Iterable[Mapping[str, Any]]) -> tuple[list[str], list[dict[str, Any]]]:
    """The columns and the rows of the table. Columns are in the order of their first row, after
    those of the case."""
    lines = [flat(row) for row in rows]
    names = list(dict.fromkeys(name for line in lines for name in line))
    settings = [name for name in names if name.startswith(SET)]
    ends = [name for name in _LAST if name in names]
    first = [*_FIRST, *settings, "status"]
    return [*first, *(n for n in names if n not in (*first, *ends)), *ends], lines


def write_table(folder: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Writes the table, completely or not at all: as CSV, and as Parquet if pyarrow is installed.
    Raises InputError."""
    columns, lines = table_of(rows)
    _write_csv(folder / CSV, columns, lines)
    if find_spec("pyarrow") is not None:
        _write_parquet(folder / PARQUET, columns, lines)


def _write_csv(path: Path, columns: list[str], lines: list[dict[str, Any]]) -> None:
    text = StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    with _written(path) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8", newline="")


def _write_parquet(path: Path, columns: list[str], lines: list[dict[str, Any]]) -> None:
    pyarrow, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
    table = pyarrow.table({name: _column([line.get(name) for line in lines]) for name in columns})
    with _written(path) as temporary:
        parquet.write_table(table, temporary)


def _column(values: list[Any]) -> list[Any]:
    """A column with values of one kind: numbers, else texts."""
    kinds: set[object] = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [value if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [value if value is None else str(value) for value in values]
    return values


@contextmanager
def _written(path: Path) -> Generator[Path]:
    try:
        with replaced(path) as temporary:
            yield temporary
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError.of("study.results", str(path), value=reason) from None
