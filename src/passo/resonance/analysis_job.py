"""Calculates spectra in a separate process: `python -m passo.resonance.analysis_job`.

It reads a line with an order in JSON from standard input, then the bytes of the measurement. It
prints the answer in JSON. The order has the measurement (`chip`, `axes`, `rate_hz`, `start_s`), the
acceleration that the chip must have measured (`least_mm_s2`, root mean square), `max_smoothing_mm`
(or null), `title`, and the paths of files without their ending, empty for no file: `raw`,
`spectrum` and `shapers`. The answer has `peak_hz`, `noise`, `files`, and, if the order has
`shapers`, the `fits`, the kind of the `best` and the `reason`; or `error` with the code of an error
and its `values`."""

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
    except OSError as error:
        values = {"axis": str(error.filename), "value": error.strerror or str(error)}
        answer = {"error": "resonance.no-file", "values": values}
    print(json.dumps(answer))
    return 0


def _answer(source: BinaryIO) -> dict[str, Any]:
    import numpy as np

    from passo.resonance.choice import choose
    from passo.resonance.files import raw_csv, spectrum_csv, spectrum_svg
    from passo.resonance.measurement import decoded
    from passo.resonance.spectrum import TooShortError, spectrum, window_samples

    order: dict[str, Any] = json.loads(source.readline())
    files: list[str] = []

    def write(stem: str, ending: str, text: str) -> None:
        path = Path(f"{stem}{ending}")
        path.write_text(text, encoding="utf-8")
        files.append(str(path))

    rows = decoded(order["chip"], source.read(), order["axes"])
    samples = np.array(rows, dtype=np.float64).reshape(-1, 3)
    if order["raw"]:
        write(order["raw"], ".csv", raw_csv(rows, order["start_s"], order["rate_hz"]))
    felt = float(np.sqrt(np.var(samples, axis=0).sum()))
    if felt < order["least_mm_s2"]:
        values = {"value": felt, "limit": order["least_mm_s2"]}
        return {"error": "resonance.still", "values": values}
    try:
        measured = spectrum(samples, order["rate_hz"])
    except TooShortError:
        values = {"value": len(rows), "limit": window_samples(order["rate_hz"])}
        return {"error": "resonance.short", "values": values}
    noise = [float(np.mean(part)) for part in (measured.x, measured.y, measured.z)]
    normal = measured.normalized()
    choice = choose(normal, order["max_smoothing_mm"]) if order["shapers"] else None
    for stem, shown in ((order["spectrum"], None), (order["shapers"], choice)):
        if stem:
            write(stem, ".csv", spectrum_csv(normal, shown))
            write(stem, ".svg", spectrum_svg(order["title"], normal, shown))
    return {
        "peak_hz": normal.peak_hz,
        "noise": noise,
        "files": files,
        "fits": [asdict(fit) for fit in choice.fits] if choice else [],
        "best": choice.best.kind if choice else "",
        "reason": choice.reason if choice else "",
    }


if __name__ == "__main__":
    sys.exit(main())
