"""The results of a study as a table: sorted, without times of the computer or host names, so that
the same study gives the same bytes on every engine."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from io import StringIO
from pathlib import Path
from typing import Any, cast

from passo.errors import InputError
from passo.job.durable_files import replaced

CSV, PARQUET = "results.csv", "results.parquet"
_FIRST = ("id", "file", "machine")
_LAST = ("code", "line", "message", "warnings")


def flat(row: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The row with tables as columns (`filament_mm.e`); lists are text."""
    columns: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, dict) and f"{prefix}{name}" != "setting":
            columns |= flat(cast("dict[str, Any]", value), f"{prefix}{name}.")
        elif isinstance(value, dict):
            columns |= {f"set {key}": v for key, v in cast("dict[str, Any]", value).items()}
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
    settings = [name for name in names if name.startswith("set ")]
    ends = [name for name in _LAST if name in names]
    first = [*_FIRST, *settings, "status"]
    return [*first, *(n for n in names if n not in (*first, *ends)), *ends], lines


def write_csv(folder: Path, rows: Iterable[Mapping[str, Any]]) -> Path:
    """Writes the table as CSV, completely or not at all. Raises InputError."""
    columns, lines = table_of(rows)
    text = StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    path = folder / CSV
    try:
        with replaced(path) as temporary:
            temporary.write_text(text.getvalue(), encoding="utf-8", newline="")
    except OSError as error:
        raise InputError.of("study.results", str(path), value=error.strerror) from None
    return path
