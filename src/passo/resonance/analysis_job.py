"""Calculates spectra in a separate process: `python -m passo.resonance.analysis_job`.

It reads a line with an order in JSON from standard input, then the bytes of its runs. It prints the
answer in JSON. The order has

- `runs`: for each run its measurement (`chip`, `axes`, `bytes`, `rate_hz`, `start_s`), the
  acceleration `least_mm_s2` (root mean square) that it must have felt, and the path of its files
  without their ending, `raw` and `spectrum`, empty for no file;
- `fit`: whether shapers are fitted to all runs together, `max_smoothing_mm` (or null) and `max_hz`;
- `files`: the path of the files of the fit, without their ending, or empty; and `title`.

The answer has `peaks_hz`, the `noise` of the first run, `fits`, `best`, `reason` and `files`; or
`error` with the code of an error and its values.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO

_NICE = 10  # the printer has priority


def main() -> int:
    """Executes the order on standard input."""
    os.nice(_NICE)
    answer: dict[str, Any]
    try:
        answer = _answer(sys.stdin.buffer)
    except ModuleNotFoundError as error:
        if error.name != "numpy":
            raise
        answer = {"error": "resonance.no-numpy", "values": {}}
    except OSError as error:
        values = {"axis": str(error.filename), "value": error.strerror or str(error)}
        answer = {"error": "resonance.no-file", "values": values}
    print(json.dumps(answer))
    return 0


def _answer(source: BinaryIO) -> dict[str, Any]:
    import numpy as np

    from passo.resonance.choice import choose, mean
    from passo.resonance.files import raw_csv, spectrum_csv, spectrum_svg
    from passo.resonance.measurement import decoded
    from passo.resonance.spectrum import Spectrum, TooShortError, spectrum, window_samples

    order: dict[str, Any] = json.loads(source.readline())
    files: list[str] = []

    def write(stem: str, ending: str, text: str) -> None:
        path = Path(f"{stem}{ending}")
        path.write_text(text, encoding="utf-8")
        files.append(str(path))

    found: list[Spectrum] = []
    noise: list[float] = []
    for run in order["runs"]:
        rows = decoded(run["chip"], source.read(run["bytes"]), run["axes"])
        samples = np.array(rows, dtype=np.float64).reshape(-1, 3)
        if run["raw"]:
            write(run["raw"], ".csv", raw_csv(rows, run["start_s"], run["rate_hz"]))
        felt = float(np.sqrt(np.var(samples, axis=0).sum()))
        if felt < run["least_mm_s2"]:
            values = {"value": felt, "limit": run["least_mm_s2"]}
            return {"error": "resonance.still", "values": values}
        try:
            measured = spectrum(samples, run["rate_hz"])
        except TooShortError:
            values = {"value": len(rows), "limit": window_samples(run["rate_hz"])}
            return {"error": "resonance.short", "values": values}
        noise = noise or [float(np.mean(part)) for part in (measured.x, measured.y, measured.z)]
        found.append(measured.normalized())
        if run["spectrum"]:
            write(run["spectrum"], ".csv", spectrum_csv(found[-1], None))
            write(run["spectrum"], ".svg", spectrum_svg(order["title"], found[-1], None))
    answer: dict[str, Any] = {"peaks_hz": [one.peak_hz for one in found], "noise": noise}
    if order["fit"]:
        limits = {"max_smoothing_mm": order["max_smoothing_mm"], "max_hz": order["max_hz"]}
        choice = choose(found, **limits)
        if order["files"]:
            together = mean(found)
            write(order["files"], ".csv", spectrum_csv(together, choice))
            write(order["files"], ".svg", spectrum_svg(order["title"], together, choice))
        answer |= {"fits": [asdict(fit) | {"line": fit.line} for fit in choice.fits]}
        answer |= {"best": asdict(choice.best), "reason": choice.reason}
    return answer | {"files": files}


if __name__ == "__main__":
    sys.exit(main())
