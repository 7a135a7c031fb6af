"""An arc becomes chords: how many, and how far they are from the circle."""

from __future__ import annotations

from math import asin, ceil, cos, degrees, pi, sin, sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Plane
from passo.learn.planned import planned, shipped


def _passo_chords(radius_mm: float) -> int:
    """The moves into which Passo divides a circle of this radius."""
    start = f"X{100 + radius_mm:.3f} Y100"
    lines = f"G1 {start} F3000\nG2 {start} I-{radius_mm:.3f}\n"
    return len(planned(lines, shipped("i3"))[0]) - 1


def _compute(radius_mm: float, chord_mm: float) -> Outcome:
    r = radius_mm
    chord = min(chord_mm, 1.9 * r)
    error = r - sqrt(r * r - chord * chord / 4)
    count = ceil(2 * pi * r / chord - 1e-9)
    passo = _passo_chords(r)
    passo_error = r * (1 - cos(pi / passo))
    turn = 2 * asin(chord / (2 * r))
    corners = [min(i * turn, pi / 2) for i in range(ceil(pi / 2 / turn) + 1)]
    smooth = [pi / 2 * i / 60 for i in range(61)]
    lengths = [r * i / 40 for i in range(1, 41)]
    return Outcome(
        numbers=[
            Number(
                "error_mm", Text("Distance from the circle", "Distanza dal cerchio"), error, "mm", 4
            ),
            Number("count", Text("Chords of the circle", "Corde del cerchio"), float(count), "", 0),
            Number(
                "turn_deg", Text("Turn at each corner", "Svolta a ogni angolo"), degrees(turn), "°"
            ),
            Number(
                "passo_count",
                Text("Chords that Passo makes", "Corde che fa Passo"),
                float(passo),
                "",
                0,
            ),
            Number(
                "passo_error_mm",
                Text("Their distance from the circle", "La loro distanza dal cerchio"),
                passo_error,
                "mm",
                4,
            ),
        ],
        planes=[
            Plane(
                Text("A quarter of the circle", "Un quarto di cerchio"),
                [
                    Line(Text("circle", "cerchio"), _xs(smooth, r), _ys(smooth, r), 1, True),
                    Line(Text("chords", "corde"), _xs(corners, r), _ys(corners, r)),
                ],
                unit="mm",
            )
        ],
        graphs=[
            Graph(
                Text("Distance from the circle", "Distanza dal cerchio"),
                Text("length of a chord, mm", "lunghezza di una corda, mm"),
                "mm",
                [
                    Line(
                        Text("this radius", "questo raggio"),
                        lengths,
                        [r - sqrt(r * r - length * length / 4) for length in lengths],
                    )
                ],
            )
        ],
    )


def _xs(angles: list[float], r: float) -> list[float]:
    return [r * cos(angle) for angle in angles]


def _ys(angles: list[float], r: float) -> list[float]:
    return [r * sin(angle) for angle in angles]


EXPERIMENT = Experiment(
    "arcs-and-chords",
    Text("A circle in straight lines", "Un cerchio in linee rette"),
    Text(
        "A circle of G2 is divided into equal chords. Compare them with the chords that Passo"
        " makes.",
        "Un cerchio di G2 è diviso in corde uguali. Confrontale con le corde di Passo.",
    ),
    [
        Parameter("radius_mm", Text("Radius", "Raggio"), 20.0, 1.0, 80.0, 0.5, unit="mm"),
        Parameter(
            "chord_mm",
            Text("Length of a chord", "Lunghezza di una corda"),
            4.0,
            0.1,
            10.0,
            0.1,
            unit="mm",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="arcs-and-chords",
    chapter=Chapter.MOTION,
    place=80,
    rows=(29,),
    minutes=20,
    title=Text("Arcs and chords", "Archi e corde"),
    goal=Text(
        "You know how long a chord may be until you can see or feel it in a print.",
        "Sai quanto può essere lunga una corda prima che si veda o si senta in una stampa.",
    ),
    text=[
        Text(
            "`G2` and `G3` ask for an arc, but motors and planner know straight lines. So an arc"
            " becomes chords. Their ends lie on the circle, their middles inside it.",
            "`G2` e `G3` chiedono un arco, ma motori e pianificatore conoscono linee rette. Così un"
            " arco diventa corde. Le loro estremità stanno sul cerchio, i punti medi dentro.",
        ),
        Text(
            "Chords of {chord_mm} on a radius of {radius_mm} leave the circle by {error_mm}. By"
            " Pythagoras it is `r − √(r² − (L/2)²)`, which is almost `L² / (8·r)`: half the length"
            " gives a quarter of the error.",
            "Corde di {chord_mm} su un raggio di {radius_mm} si allontanano dal cerchio di"
            " {error_mm}. Per Pitagora è `r − √(r² − (L/2)²)`, quasi `L² / (8·r)`: metà lunghezza,"
            " un quarto dell'errore.",
        ),
        Text(
            "A firmware with a fixed length of chord is fine on large arcs and coarse on small"
            " holes: at a radius of {hole.radius_mm} the same chord errs by {hole.error_mm}.",
            "Un firmware con corde di lunghezza fissa va bene sugli archi grandi ed è grossolano"
            " sui fori piccoli: con raggio {hole.radius_mm} la stessa corda sbaglia di"
            " {hole.error_mm}.",
        ),
        Text(
            "Passo bounds the error, not the length: it takes {passo_count:n} chords here, and"
            " {hole.passo_count:n} for the hole. Both are within {passo_error_mm} of the circle,"
            " less than a step of the motor.",
            "Passo limita l'errore, non la lunghezza: qui usa {passo_count:n} corde, e"
            " {hole.passo_count:n} per il foro. Entrambe restano entro {passo_error_mm} dal"
            " cerchio, meno di un passo del motore.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"hole": {"radius_mm": 2.5}, "start": {}},
    questions=[
        Question(
            Text(
                "The radius is {radius_mm}, a chord {chord_mm}. How far is its middle from the"
                " circle?",
                "Il raggio è {radius_mm}, una corda {chord_mm}. Quanto dista il suo punto medio dal"
                " cerchio?",
            ),
            "error_mm",
            given={"radius_mm": 5.0, "chord_mm": 2.0},
            mistakes=[
                Mistake(
                    lambda v: v["radius_mm"] - sqrt(v["radius_mm"] ** 2 - v["chord_mm"] ** 2),
                    Text(
                        "The triangle has half of the chord as a side, not the whole.",
                        "Il triangolo ha come lato metà della corda, non tutta.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(v["radius_mm"] ** 2 - v["chord_mm"] ** 2 / 4),
                    Text(
                        "This is the distance from the centre. What is left to the circle?",
                        "Questa è la distanza dal centro. Quanto manca al cerchio?",
                    ),
                ),
            ],
            why=Text(
                "Radius, half chord and the line from the centre to the middle make a right"
                " triangle.",
                "Raggio, mezza corda e la linea dal centro al punto medio formano un triangolo"
                " rettangolo.",
            ),
            hint=Text(
                "Draw the centre, one end and the middle of the chord.",
                "Disegna il centro, un'estremità e il punto medio della corda.",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "Chords of {start.chord_mm} on {radius_mm} err by {start.error_mm}. How much do"
                " chords of half that length err?",
                "Corde di {start.chord_mm} su {radius_mm} sbagliano di {start.error_mm}. Quanto"
                " sbagliano corde lunghe la metà?",
            ),
            "error_mm",
            given={"chord_mm": 2.0},
            mistakes=[
                Mistake(
                    lambda v: 2 * v["error_mm"],
                    Text(
                        "Not half: the length counts with its square.",
                        "Non la metà: la lunghezza conta al quadrato.",
                    ),
                ),
                Mistake(
                    lambda v: 4 * v["error_mm"],
                    Text("Shorter chords are closer.", "Corde più corte sono più vicine."),
                ),
            ],
            why=Text(
                "A quarter: `L² / (8·r)`. That is why an error falls so fast with more chords.",
                "Un quarto: `L² / (8·r)`. Perciò l'errore cala così in fretta con più corde.",
            ),
            hint=Text("Use `L² / (8·r)`.", "Usa `L² / (8·r)`."),
        ),
    ],
    source=Source("core/gcode/arc.hpp", "Arc"),
    printer=OwnPrinter(
        Text(
            "Type an arc into Learn: it says how many moves it becomes.",
            "Scrivi un arco in Impara: dice quanti movimenti diventa.",
        ),
        page="learn",
    ),
)
