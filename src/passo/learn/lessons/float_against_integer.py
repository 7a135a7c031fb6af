"""A thousand tiny moves: what becomes of the fractions of steps."""

from __future__ import annotations

from math import floor

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_POINTS = 200  # of a drawn line


def _nearest(steps: float) -> int:
    return floor(steps + 0.5)


def _compute(move_mm: float, moves: float, steps_per_mm: float) -> Outcome:
    count, each = int(moves), move_mm * steps_per_mm
    cut, rounded = count * floor(each), count * _nearest(each)
    exact = _nearest(count * each)
    points = sorted({round(count * i / _POINTS) for i in range(_POINTS + 1)})
    made = [float(n) for n in points]

    def error_mm(steps_after: list[float]) -> list[float]:
        return [
            steps / steps_per_mm - n * move_mm for n, steps in zip(points, steps_after, strict=True)
        ]

    return Outcome(
        numbers=[
            Number("each", Text("Steps of one move", "Passi di un movimento"), each, decimals=3),
            Number(
                "cut_steps",
                Text("Steps if each move is cut off", "Passi se ogni movimento è troncato"),
                float(cut),
                decimals=0,
            ),
            Number(
                "rounded_steps",
                Text("Steps if each move is rounded", "Passi se ogni movimento è arrotondato"),
                float(rounded),
                decimals=0,
            ),
            Number(
                "exact_steps",
                Text("Steps if the position is rounded", "Passi se si arrotonda la posizione"),
                float(exact),
                decimals=0,
            ),
            Number(
                "cut_error_mm",
                Text("Error of cutting off", "Errore del troncamento"),
                cut / steps_per_mm - count * move_mm,
                "mm",
                decimals=3,
            ),
            Number(
                "rounded_error_mm",
                Text("Error of rounding each move", "Errore dell'arrotondamento"),
                rounded / steps_per_mm - count * move_mm,
                "mm",
                decimals=3,
            ),
            Number(
                "length_mm", Text("Length asked for", "Lunghezza richiesta"), count * move_mm, "mm"
            ),
        ],
        graphs=[
            Graph(
                Text("Error of the position", "Errore della posizione"),
                Text("moves", "movimenti"),
                "mm",
                [
                    Line(
                        Text("each move cut off", "ogni movimento troncato"),
                        made,
                        error_mm([float(n * floor(each)) for n in points]),
                    ),
                    Line(
                        Text("each move rounded", "ogni movimento arrotondato"),
                        made,
                        error_mm([float(n * _nearest(each)) for n in points]),
                        1,
                    ),
                    Line(
                        Text("position rounded", "posizione arrotondata"),
                        made,
                        error_mm([float(_nearest(n * each)) for n in points]),
                        2,
                    ),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "float-against-integer",
    Text("Tiny moves in a row", "Movimenti minuscoli in fila"),
    Text(
        "Equal relative moves in one direction, counted in steps in three ways.",
        "Movimenti relativi uguali in una direzione, contati in passi in tre modi.",
    ),
    [
        Parameter(
            "move_mm",
            Text("Length of a move", "Lunghezza di un movimento"),
            0.0123,
            0.001,
            0.1,
            0.0001,
            unit="mm",
        ),
        Parameter("moves", Text("Moves", "Movimenti"), 1000.0, 10.0, 5000.0, 10.0),
        Parameter(
            "steps_per_mm",
            Text("Steps per millimetre", "Passi per millimetro"),
            80.0,
            choices=[Choice(value) for value in (80.0, 100.0, 160.0, 400.0)],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="float-against-integer",
    chapter=Chapter.MOTION,
    place=90,
    rows=(22,),
    minutes=20,
    title=Text("Fractions of steps", "Frazioni di passi"),
    goal=Text(
        "You find out why a firmware may lose millimetres without losing a step.",
        "Scopri perché un firmware può perdere millimetri senza perdere un passo.",
    ),
    text=[
        Text(
            "A motor takes whole steps. A move of {move_mm} at {steps_per_mm:n} steps per"
            " millimetre is {each} steps. What becomes of the fraction?",
            "Un motore fa passi interi. Un movimento di {move_mm} con {steps_per_mm:n} passi per"
            " millimetro è {each} passi. Che fine fa la frazione?",
        ),
        Text(
            "A first firmware cuts it off, move by move. After {moves:n} moves it has taken"
            " {cut_steps:n} steps, and the error is {cut_error_mm}. Small moves are where this"
            " hurts most: curves are made of them.",
            "Un primo firmware la tronca, movimento per movimento. Dopo {moves:n} movimenti ha"
            " fatto {cut_steps:n} passi, e l'errore è {cut_error_mm}. Nei movimenti piccoli il"
            " danno è maggiore: le curve sono fatte di essi.",
        ),
        Text(
            "A second one rounds each move: {rounded_steps:n} steps, an error of"
            " {rounded_error_mm}. Better by luck, and still growing with each move.",
            "Un secondo arrotonda ogni movimento: {rounded_steps:n} passi, un errore di"
            " {rounded_error_mm}. Meglio per caso, e cresce ancora a ogni movimento.",
        ),
        Text(
            "Passo rounds the position, not the move: it asks where the axis must be, counted from"
            " its zero, and steps to the nearest position. That makes {exact_steps:n} steps, and"
            " the error never exceeds half a step, however many moves there are.",
            "Passo arrotonda la posizione, non il movimento: chiede dove deve essere l'asse,"
            " contando dal suo zero, e va alla posizione più vicina. Sono {exact_steps:n} passi, e"
            " l'errore non supera mai mezzo passo, per quanti movimenti ci siano.",
        ),
    ],
    experiment=EXPERIMENT,
    questions=[
        Question(
            Text(
                "{moves:n} moves of {move_mm} at {steps_per_mm:n} steps per millimetre. How many"
                " steps does a firmware take that cuts off each move?",
                "{moves:n} movimenti di {move_mm} con {steps_per_mm:n} passi per millimetro. Quanti"
                " passi fa un firmware che tronca ogni movimento?",
            ),
            "cut_steps",
            given={"move_mm": 0.0199, "moves": 500.0, "steps_per_mm": 100.0},
            mistakes=[
                Mistake(
                    lambda v: v["moves"] * v["each"],
                    Text(
                        "That would be right, if nothing were cut off.",
                        "Sarebbe giusto, se nulla fosse troncato.",
                    ),
                ),
                Mistake(
                    lambda v: v["rounded_steps"],
                    Text(
                        "This rounds. Cutting off always goes down to the whole number below.",
                        "Questo arrotonda. Troncare va sempre al numero intero inferiore.",
                    ),
                ),
            ],
            why=Text(
                "Each move has {each} steps, and keeps only the whole one: almost half of the way"
                " is missing.",
                "Ogni movimento ha {each} passi, e ne tiene solo quello intero: manca quasi metà"
                " della strada.",
            ),
            hint=Text(
                "How many whole steps does one move have?",
                "Quanti passi interi ha un movimento?",
            ),
            tolerance=0.002,
        ),
        Question(
            Text(
                "And how many steps does Passo take for {moves:n} moves of {move_mm} at"
                " {steps_per_mm:n} steps per millimetre?",
                "E quanti passi fa Passo per {moves:n} movimenti di {move_mm} con {steps_per_mm:n}"
                " passi per millimetro?",
            ),
            "exact_steps",
            given={"move_mm": 0.0031, "moves": 2000.0},
            mistakes=[
                Mistake(
                    lambda v: v["cut_steps"],
                    Text(
                        "No single move has a whole step, but the position moves on.",
                        "Nessun movimento ha un passo intero, ma la posizione avanza.",
                    ),
                ),
                Mistake(
                    lambda v: v["length_mm"],
                    Text(
                        "That is the length in millimetres.", "Questa è la lunghezza in millimetri."
                    ),
                ),
            ],
            why=Text(
                "The way is {length_mm}, and the position at its end is rounded once.",
                "La strada è {length_mm}, e la posizione alla fine si arrotonda una volta sola.",
            ),
            hint=Text(
                "Where is the axis at the end, in millimetres?",
                "Dove si trova l'asse alla fine, in millimetri?",
            ),
            tolerance=0.002,
        ),
    ],
    source=Source("core/steps/step_solver.hpp", "StepSolver"),
    printer=OwnPrinter(
        Text(
            "M114 shows where the axes are. Send a tiny relative move many times, then compare.",
            "M114 mostra dove sono gli assi. Invia molte volte un movimento relativo minuscolo, poi"
            " confronta.",
        ),
        command="M114",
    ),
)
