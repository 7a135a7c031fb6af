"""The page of `passo lab`: the trials of a file in a table, and pictures of one corner."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from passo.job.durable_files import replaced
from passo.learn.labels import duration
from passo.learn.page import page

if TYPE_CHECKING:
    from passo.job.batch.comparison import Comparison, Trial
    from passo.job.batch.quality_watch import CornerSample, ShownCorner

_BEFORE_S, _AFTER_S = -0.02, 0.12  # of the small charts
_COLOURS = (0, 1, 3)  # of the ways around the corner: the plain one first

_COLUMNS: tuple[tuple[str, Callable[[Trial], float], Callable[[Trial], str]], ...] = (
    ("Print time", lambda t: t.print_time_s, lambda t: duration(t.print_time_s)),
    (
        "Ringing, rms",
        lambda t: t.quality.ringing_rms_um,
        lambda t: f"{t.quality.ringing_rms_um:.1f} µm",
    ),
    ("… 10 % off tune", lambda t: t.off_tune_rms_um, lambda t: f"{t.off_tune_rms_um:.1f} µm"),
    (
        "Ringing, peak",
        lambda t: t.quality.ringing_peak_um,
        lambda t: f"{t.quality.ringing_peak_um:.0f} µm",
    ),
    (
        "Corners rounded",
        lambda t: t.quality.rounding_um,
        lambda t: f"{t.quality.rounding_um:.0f} µm",
    ),
    ("Off the path", lambda t: t.quality.off_path_um, lambda t: f"{t.quality.off_path_um:.1f} µm"),
    ("Width error", lambda t: t.quality.width_error, lambda t: f"{t.quality.width_error:.1%}"),
    ("Motor steps", lambda t: t.steps, lambda t: f"{t.steps:,}"),
    ("Board commands", lambda t: t.commands, lambda t: f"{t.commands:,}"),
)


def write_lab_page(found: Comparison, output: Path) -> None:
    """Writes the page, completely or not at all. Raises OSError."""
    name = os.fsencode(Path(found.file).name).decode("utf-8", "backslashreplace")
    title = f"{name} on {found.machine}: settings of the motion, compared"
    text = page(title, "lab", _data(found))
    with replaced(output) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _data(found: Comparison) -> dict[str, object]:
    """What `draw/lab.js` draws."""
    data: dict[str, object] = {
        "best": found.best,
        "name": found.trials[found.best].name,
        "reason": found.reason(),
        "trials": _table(found),
        "corner": None,
    }
    plain = found.trials[0].corner
    if plain is not None:
        data |= {
            "corner": _corner(found, plain),
            "trade": list(_trade(found)),
            "cards": list(_cards(found, plain)),
        }
    return data


def _table(found: Comparison) -> dict[str, object]:
    most = [max(value(trial) for trial in found.trials) or 1.0 for _, value, _ in _COLUMNS]
    rows = [
        {
            "name": trial.name,
            "cells": [
                (value(trial) / top, text(trial))
                for (_, value, text), top in zip(_COLUMNS, most, strict=True)
            ],
            "score": f"{score:.3f}" if trial.followed else "-",
        }
        for trial, score in zip(found.trials, found.scores(), strict=True)
    ]
    note = (
        "Ringing: deviation of the head across its line for 0.1 s after each sharp corner. Corners:"
        " distance of the head's way from them, on average. Off the path: of all printed lines,"
        " rms. Width error: mean over all printed lines. The least score is best."
    )
    if not all(trial.followed for trial in found.trials):
        note += " Without a score: the motors did not follow the file."
    quality = found.trials[0].quality
    note += f" {quality.corners:,} corners, {quality.printed_mm / 1000:,.2f} m of lines."
    return {"columns": [name for name, _, _ in _COLUMNS], "rows": rows, "text": note}


def _corner(found: Comparison, plain: ShownCorner) -> dict[str, object]:
    """The way around the corner of the plain trial, the best one and the roundest one, in mm from
    the corner."""
    trials, (x0, y0) = found.trials, plain.at_mm
    roundest = max(range(len(trials)), key=lambda i: trials[i].quality.rounding_um)
    drawn = [trials[i] for i in dict.fromkeys((0, found.best, roundest))]
    ways = [
        {
            "name": trial.name,
            "colour": colour,
            "points": [
                (round(x - x0, 4), round(y - y0, 4)) for x, y in (s.head_mm for s in shown.samples)
            ],
        }
        for colour, trial in zip(_COLOURS, drawn, strict=False)
        if (shown := trial.corner) is not None
    ]
    widest_mm = max(trial.quality.rounding_um for trial in drawn) / 1000
    return {
        "line": plain.line,
        "at_mm": plain.at_mm,
        "before": plain.before,
        "after": plain.after,
        "reach_mm": max(0.5, 2.5 * widest_mm),
        "ways": ways,
    }


def _trade(found: Comparison) -> Iterator[dict[str, object]]:
    """Each shaper: corners rounded, and the mean of ringing on tune and off tune."""
    for trial in found.trials:
        if "advance" not in trial.name and "junction" not in trial.name:
            ringing_um = (trial.quality.ringing_rms_um + trial.off_tune_rms_um) / 2
            rounding_um = trial.quality.rounding_um
            yield {"name": trial.name, "rounding_um": rounding_um, "ringing_um": ringing_um}


def _cards(found: Comparison, plain: ShownCorner) -> Iterator[dict[str, object]]:
    """Small charts, one for each trial, all in one scale."""

    def series(trial: Trial, value: Callable[[CornerSample], float]) -> dict[str, list[float]]:
        samples = trial.corner.samples if trial.corner else []
        shown = [sample for sample in samples if _BEFORE_S <= sample.s <= _AFTER_S]
        times_s, values = [round(s.s, 6) for s in shown], [round(value(s), 3) for s in shown]
        return {"t": times_s, "v": values}

    span: dict[str, object] = {"from_s": _BEFORE_S, "to_s": _AFTER_S}
    yield span | {
        "title": "Across the line after that corner: waves are ringing",
        "text": "Deviation of the head to the left of its line over the time since the motors"
        f" passed the corner of line {plain.line}. Grey: {found.trials[0].name}.",
        "unit": "µm",
        "zero": 0,
        "trials": [
            {
                "name": trial.name,
                "figure": f"{trial.quality.ringing_rms_um:.1f} µm",
                "series": series(trial, lambda sample: sample.across_um),
            }
            for trial in found.trials
        ],
    }
    if any(sample.width > 0 for sample in plain.samples):
        yield span | {
            "title": "Width of the line around that corner: peaks are blobs",
            "text": "Percent of the width that the file asks for.",
            "unit": "%",
            "zero": 100,
            "trials": [
                {
                    "name": trial.name,
                    "figure": f"{trial.quality.width_error:.1%}",
                    "series": series(trial, lambda s: 100 * s.width if s.width > 0 else 100.0),
                }
                for trial in found.trials
            ],
        }
