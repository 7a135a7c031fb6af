"""Calculates spectra and shapers in another process with low priority, so that no step is late."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

from passo.config.shapers import ShaperType
from passo.errors import CommandError
from passo.resonance.measurement import Measurement

_MAX_HZ = 200.0


@dataclass(frozen=True, slots=True)
class Run:
    """A measurement to analyse. It is an error if the root mean square of its accelerations is
    below `least_mm_s2`. `raw` and `spectrum` are paths without their ending, empty for no file."""

    measurement: Measurement
    least_mm_s2: float = 0.0
    raw: str = ""
    spectrum: str = ""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A shaper for the measured spectra: see `passo.resonance.choice.Fit`; `line` is for users."""

    kind: ShaperType
    frequency_hz: float
    vibrations: float
    smoothing_mm: float
    max_accel_mm_s2: float
    line: str = ""


@dataclass(frozen=True, slots=True)
class Analysis:
    """The highest peak of each run in Hz, the mean density of X, Y, Z in the first run, the written
    files; if shapers were fitted, all of them, the best one and the reason."""

    peaks_hz: tuple[float, ...]
    noise: tuple[float, ...]
    files: tuple[str, ...]
    fits: tuple[Fitted, ...] = ()
    best: Fitted | None = None
    reason: str = ""


async def analyse(
    runs: Sequence[Run],
    *,
    title: str,
    fit: bool = False,
    files: str = "",
    max_smoothing_mm: float | None = None,
    max_hz: float = _MAX_HZ,
) -> Analysis:
    """The spectra of the runs, and with `fit` the shaper for all of them. `files` is the path of
    the files of the fit, without their ending. Raises CommandError."""
    order = {
        "runs": [
            {
                "chip": run.measurement.chip,
                "axes": list(run.measurement.axes),
                "bytes": len(run.measurement.data),
                "rate_hz": run.measurement.rate_hz,
                "start_s": run.measurement.start_s,
                "least_mm_s2": run.least_mm_s2,
                "raw": run.raw,
                "spectrum": run.spectrum,
            }
            for run in runs
        ],
        "title": title,
        "fit": fit,
        "files": files,
        "max_smoothing_mm": max_smoothing_mm,
        "max_hz": max_hz,
    }
    data = json.dumps(order).encode() + b"\n" + b"".join(run.measurement.data for run in runs)
    answer = await asyncio.to_thread(_calculated, data)
    fits = tuple(_fitted(row) for row in answer.get("fits", []))
    return Analysis(
        tuple(answer["peaks_hz"]),
        tuple(answer["noise"]),
        tuple(answer["files"]),
        fits,
        next((f for f in fits if f.kind == answer["best"]["kind"]), None) if fits else None,
        answer.get("reason", ""),
    )


def _calculated(data: bytes) -> dict[str, Any]:
    words = [sys.executable, "-m", "passo.resonance.analysis_job"]
    done = subprocess.run(words, input=data, capture_output=True, check=False)
    try:
        answer = cast("dict[str, Any]", json.loads(done.stdout))
    except ValueError:
        last = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
        raise CommandError.of("resonance.failed", value=(last or ["no answer"])[0]) from None
    if "error" in answer:
        raise CommandError.of(answer["error"], **answer["values"])
    return answer


def _fitted(row: dict[str, Any]) -> Fitted:
    names = ("kind", "frequency_hz", "vibrations", "smoothing_mm", "max_accel_mm_s2", "line")
    return Fitted(**{name: row[name] for name in names})
