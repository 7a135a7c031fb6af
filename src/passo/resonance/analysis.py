"""Calculates spectra and shapers in another process with low priority, so that no step is late."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from dataclasses import dataclass
from typing import Any, cast

from passo.errors import CommandError
from passo.resonance.fit import Fit
from passo.resonance.measurement import Measurement


@dataclass(frozen=True, slots=True)
class Analysis:
    """The highest peak in Hz, the mean density of X, Y and Z, and the written files. If shapers
    were fitted, also the fits, the best one and the reason."""

    peak_hz: float
    noise: tuple[float, float, float]
    files: tuple[str, ...]
    fits: tuple[Fit, ...] = ()
    best: Fit | None = None
    reason: str = ""


async def analyse(
    found: Measurement,
    *,
    title: str = "",
    least_mm_s2: float = 0.0,
    raw: str = "",
    spectrum: str = "",
    shapers: str = "",
    max_smoothing_mm: float | None = None,
) -> Analysis:
    """The spectrum of a measurement. `raw`, `spectrum` and `shapers` are paths, without the ending,
    of the files to write: the samples, the spectrum and the fitted shapers. An empty path writes no
    file; without a path for `shapers`, no shaper is fitted. Raises CommandError, also if the root
    mean square of the accelerations is below `least_mm_s2`."""
    order = {
        "chip": found.chip,
        "axes": list(found.axes),
        "rate_hz": found.rate_hz,
        "start_s": found.start_s,
        "title": title,
        "least_mm_s2": least_mm_s2,
        "raw": raw,
        "spectrum": spectrum,
        "shapers": shapers,
        "max_smoothing_mm": max_smoothing_mm,
    }
    data = json.dumps(order).encode() + b"\n" + found.data
    answer = await asyncio.to_thread(_calculated, data)
    x, y, z = answer["noise"]
    fits = tuple(Fit(**row) for row in answer["fits"])
    best = next((fit for fit in fits if fit.kind == answer["best"]), None)
    files = tuple(answer["files"])
    return Analysis(answer["peak_hz"], (x, y, z), files, fits, best, answer["reason"])


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
