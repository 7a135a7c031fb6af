"""The frequency of ringing from its waves on a print, and the shapers for it."""

from __future__ import annotations

from passo.config.shapers import DEFAULT_DAMPING, SHAPER_TYPES, Impulses, ShaperType, impulses
from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line, Table, edges

_MS = 1000.0
_DRAWN: tuple[ShaperType, ...] = ("zv", "mzv", "ei")


def _compute(waves: float, length_mm: float, speed_mm_s: float) -> Outcome:
    frequency = waves * speed_mm_s / length_mm
    damping = DEFAULT_DAMPING
    shapers = {kind: impulses(kind, frequency, damping) for kind in SHAPER_TYPES}

    def staircase(found: Impulses) -> tuple[list[float], list[float]]:
        total, steps = 0.0, [(0.0, 0.0)]
        for weight, seconds in found:
            total += weight
            steps.append((_MS * seconds, total))
        return edges([ms for ms, _ in steps], [up for _, up in steps])

    shown = [(kind, *staircase(shapers[kind])) for kind in _DRAWN]
    end_ms = max(x[-1] for _, x, _ in shown) * 1.1
    return Outcome(
        numbers=[
            Number("frequency_hz", Text("Frequency", "Frequenza"), frequency, "Hz", 1),
            Number("period_ms", Text("One wave", "Un'onda"), _MS / frequency, "ms", 1),
            Number(
                "wave_mm", Text("Length of a wave", "Lunghezza di un'onda"), length_mm / waves, "mm"
            ),
        ],
        graphs=[
            Graph(
                Text("A step of the speed, shaped", "Un gradino di velocità, filtrato"),
                Text("time, ms", "tempo, ms"),
                Text("part of the step", "parte del gradino"),
                [Line(kind, [*x, end_ms], [*y, 1.0], i) for i, (kind, x, y) in enumerate(shown)],
            )
        ],
        tables=[
            Table(
                Text("Shapers", "Shaper"),
                [Text("type", "tipo"), Text("longer by, ms", "più lungo di, ms")],
                [[kind, f"{_MS * found[-1][1]:.1f}"] for kind, found in shapers.items()],
            )
        ],
    )


CALCULATOR = Experiment(
    "ringing-shaper",
    Text("Shaper from a ringing test", "Shaper da una prova di ringing"),
    Text(
        "Count waves after a sharp corner and measure their length: the speed tells the frequency.",
        "Conta le onde dopo uno spigolo e misurane la lunghezza: la velocità dà la frequenza.",
    ),
    [
        Parameter("waves", Text("Waves", "Onde"), 4.0, 1.0, 20.0, 1.0),
        Parameter(
            "length_mm", Text("Their length", "La loro lunghezza"), 10.0, 1.0, 100.0, 0.5, "mm"
        ),
        Parameter(
            "speed_mm_s",
            Text("Speed of the print", "Velocità della stampa"),
            100.0,
            20.0,
            300.0,
            5.0,
            "mm/s",
        ),
    ],
    _compute,
)
