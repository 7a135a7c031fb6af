"""Compares the rows of a study: the best row of each file, and the rows that no other row beats."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import inf, isinf
from pathlib import Path

from passo.errors import InputError
from passo.job.batch.comparison import Comparison, Trial
from passo.job.batch.quality_watch import Quality
from passo.job.durable_files import replaced
from passo.learn.labels import duration
from passo.learn.page import page
from passo.study.table import CSV, SET

PAGE = "report.html"
_MAX_PICTURES = 50  # files with pictures on the page
_TIMES = ("print_time_s", "total_s")  # the column of the time, by what was computed

Cells = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Row:
    """A row that was computed. `ringing_um` is the mean of that on tune and 10 % off tune; it and
    the width error are None unless the laboratory measured them. The least score is best; it is
    infinite if the motors did not follow the file. `front` marks rows that no row beats: none is
    better in one figure and at least as good in the others."""

    machine: str
    setting: Mapping[str, str]
    time_s: float
    ringing_um: float | None
    width_error: float | None
    score: float
    front: bool

    @property
    def name(self) -> str:
        """The machine and the setting."""
        values = ", ".join(f"{key} = {value}" for key, value in self.setting.items())
        return f"{self.machine}: {values}" if values else self.machine


@dataclass(frozen=True, slots=True)
class FileRows:
    """The rows of one file, and how many failed with each status."""

    file: str
    rows: list[Row]
    failed: Mapping[str, int]

    @property
    def best(self) -> Row | None:
        """The row with the least score, the first of equal ones; None if each row failed."""
        judged = [row for row in self.rows if not isinf(row.score)]
        return min(judged, key=lambda row: row.score, default=None)


def compare(folder: Path) -> list[FileRows]:
    """The rows of a folder by file, in their order. Raises InputError if it has no results."""
    path = folder / CSV
    try:
        with path.open(encoding="utf-8", newline="") as table:
            cells = list(csv.DictReader(table))
    except OSError:
        cells = []
    if not cells or not {"file", "machine", "status"} <= cells[0].keys():
        raise InputError.of("study.no-rows", str(path))
    files: dict[str, list[Cells]] = {}
    for row in cells:
        files.setdefault(row["file"], []).append(row)
    return [_compared(file, rows) for file, rows in files.items()]


def _compared(file: str, rows: list[Cells]) -> FileRows:
    good = [row for row in rows if row["status"] == "ok"]
    failed = Counter(row["status"] for row in rows if row["status"] != "ok")
    measured = bool(good) and "off_tune_rms_um" in good[0]
    trials = [_trial(row) for row in good] if measured else []
    times_s = [float(next(row[name] for name in _TIMES if name in row)) for row in good]
    if measured:
        scores = Comparison(file, "", "balance", trials).scores()
        figures = [(t.print_time_s, _ringing_um(t), t.quality.width_error) for t in trials]
    else:
        scores, figures = times_s, [(time_s,) for time_s in times_s]
    judged = [figure for figure, score in zip(figures, scores, strict=True) if score < inf]
    found = [
        Row(
            row["machine"],
            _setting(row),
            time_s,
            _ringing_um(trials[i]) if measured else None,
            trials[i].quality.width_error if measured else None,
            scores[i],
            scores[i] < inf and not any(_beats(other, figures[i]) for other in judged),
        )
        for i, (row, time_s) in enumerate(zip(good, times_s, strict=True))
    ]
    return FileRows(file, found, dict(sorted(failed.items())))


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(a <= b for a, b in zip(one, other, strict=True))


def _setting(row: Cells) -> dict[str, str]:
    return {
        name.removeprefix(SET): value
        for name, value in row.items()
        if name.startswith(SET) and value
    }


def _trial(row: Cells) -> Trial:
    figures = {field.name: float(row[field.name]) for field in fields(Quality)}
    quality = Quality(corners=int(figures.pop("corners")), **figures)
    return Trial(
        name="",
        print_time_s=float(row["print_time_s"]),
        quality=quality,
        off_tune_rms_um=float(row["off_tune_rms_um"]),
        lost=float(row["lost"]),
        steps=int(row["steps"]),
        commands=int(row["commands"]),
    )


def _ringing_um(trial: Trial) -> float:
    return (trial.quality.ringing_rms_um + trial.off_tune_rms_um) / 2


def write_report_page(found: list[FileRows], folder: Path) -> Path:
    """Writes the page with pictures, completely or not at all. Raises InputError."""
    path = folder / PAGE
    data: dict[str, object] = {"files": [_file_data(each) for each in found[:_MAX_PICTURES]]}
    data["left_out"] = len(found) - len(found[:_MAX_PICTURES])
    try:
        with replaced(path) as temporary:
            temporary.write_text(page(f"Study {folder.name}", "study", data), encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError.of("output.unwritable", str(path), value=reason) from None
    return path


def _file_data(found: FileRows) -> dict[str, object]:
    best = found.best
    return {
        "file": found.file,
        "failed": found.failed,
        "best": None if best is None else best.name,
        "rows": [
            {
                "name": row.name,
                "machine": row.machine,
                "setting": row.setting,
                "time_s": row.time_s,
                "time": duration(row.time_s),
                "ringing_um": row.ringing_um,
                "width_error": row.width_error,
                "front": row.front,
                "best": row is best,
            }
            for row in found.rows
        ],
    }
