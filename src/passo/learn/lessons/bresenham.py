"""Bresenham's algorithm: two motors on one straight line, and what it costs the slower one."""

from __future__ import annotations

from itertools import pairwise
from math import ceil

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Plane, Table, edges

_SHOWN = 12  # rows of the table


def _slow_steps(fast: int, slow: int) -> list[int]:
    """The fast steps, from 1, with which the slow motor steps: its error reaches one half."""
    steps: list[int] = []
    error = 0  # in 2·fast-ths of a step, so that one half is `fast`
    for number in range(1, fast + 1):
        error += 2 * slow
        if error >= fast:
            steps.append(number)
            error -= 2 * fast
    return steps


def _gaps(at: list[float]) -> list[float]:
    return [after - before for before, after in pairwise(at)]


def _compute(fast_steps: float, slow_steps: float, rate_hz: float) -> Outcome:
    fast, slow = int(fast_steps), min(int(slow_steps), int(fast_steps))
    interval_ms = 1000 / rate_hz
    taken = _slow_steps(fast, slow)
    # A step is taken where the line crosses the middle between two positions.
    bresenham_ms = [(number - 0.5) * interval_ms for number in taken]
    exact_ms = [(k + 0.5) * fast / slow * interval_ms for k in range(slow)]
    late_ms = [b - e for b, e in zip(bresenham_ms, exact_ms, strict=True)]
    gaps = _gaps(bresenham_ms) or [fast * interval_ms]
    exact_gap_ms = fast / slow * interval_ms
    path_x, path_y, y = [0.0], [0.0], 0
    rows: list[list[str]] = []
    error = 0.0
    for number in range(1, fast + 1):
        steps = number in taken
        y += steps
        path_x, path_y = [*path_x, number], [*path_y, y]
        error += slow / fast
        if number <= _SHOWN:
            rows.append(
                [str(number), f"{error:.2f}", "+1" if steps else "", f"{error - steps:.2f}"]
            )
        error -= steps
    times, speeds = edges([0.0, *bresenham_ms], [0.0, *(1000 / gap for gap in [gaps[0], *gaps])])
    return Outcome(
        numbers=[
            Number(
                "exact_gap_ms",
                Text("Exact interval of the slow motor", "Intervallo esatto del motore lento"),
                exact_gap_ms,
                "ms",
            ),
            Number(
                "short_gap_ms",
                Text("Shortest interval by Bresenham", "Intervallo minimo con Bresenham"),
                min(gaps),
                "ms",
            ),
            Number(
                "long_gap_ms",
                Text("Longest interval by Bresenham", "Intervallo massimo con Bresenham"),
                max(gaps),
                "ms",
            ),
            Number(
                "late_ms",
                Text("Largest error of a step's time", "Errore massimo nel tempo di un passo"),
                max(map(abs, late_ms)),
                "ms",
            ),
            Number(
                "first_at",
                Text(
                    "Its first step comes with fast step", "Il primo passo arriva col passo veloce"
                ),
                float(ceil(fast / (2 * slow))),
                decimals=0,
            ),
        ],
        planes=[
            Plane(
                Text("The line in steps", "La linea in passi"),
                [
                    Line("Bresenham", path_x, path_y),
                    Line(Text("ideal", "ideale"), [0, fast], [0, slow], 1, True),
                ],
                unit=Text("steps", "passi"),
            )
        ],
        graphs=[
            Graph(
                Text("Steps per second of the slow motor", "Passi al secondo del motore lento"),
                Text("time, ms", "tempo, ms"),
                "Hz",
                [
                    Line("Bresenham", times, speeds),
                    Line(
                        Text("exact", "esatto"),
                        [0.0, fast * interval_ms],
                        [1000 / exact_gap_ms] * 2,
                        1,
                        True,
                    ),
                ],
            )
        ],
        tables=[
            Table(
                Text("The first steps by hand", "I primi passi a mano"),
                [
                    Text("fast step", "passo veloce"),
                    Text("error", "errore"),
                    Text("slow motor", "motore lento"),
                    Text("error after it", "errore dopo"),
                ],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "bresenham",
    Text("Two motors, one line", "Due motori, una linea"),
    Text(
        "The fast motor steps evenly. Bresenham's algorithm decides with which of its steps the"
        " slow motor steps, too.",
        "Il motore veloce fa passi regolari. L'algoritmo di Bresenham decide con quali di essi si"
        " muove anche il motore lento.",
    ),
    [
        Parameter(
            "fast_steps",
            Text("Steps of the fast motor", "Passi del motore veloce"),
            20.0,
            2.0,
            60.0,
        ),
        Parameter(
            "slow_steps", Text("Steps of the slow motor", "Passi del motore lento"), 8.0, 1.0, 60.0
        ),
        Parameter(
            "rate_hz",
            Text("Fast steps per second", "Passi veloci al secondo"),
            1000.0,
            low=100.0,
            high=10000.0,
            step=100.0,
            unit="Hz",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="bresenham",
    chapter=Chapter.MOTION,
    place=30,
    rows=(3,),
    minutes=30,
    title=Text("Bresenham and exact times", "Bresenham e i tempi esatti"),
    goal=Text(
        "You draw a line in steps by hand, and see what the slow motor feels.",
        "Disegni a mano una linea in passi, e vedi che cosa sente il motore lento.",
    ),
    text=[
        Text(
            "A straight line needs {fast_steps:n} steps of one motor and {slow_steps:n} of the"
            " other. Many firmwares count like this: with each step of the fast motor they add"
            " `slow / fast` to an error. When it reaches one half, the slow motor steps, and the"
            " error becomes smaller by one.",
            "Una linea retta richiede {fast_steps:n} passi di un motore e {slow_steps:n}"
            " dell'altro. Molti firmware contano così: a ogni passo del motore veloce sommano"
            " `lento / veloce` a un errore. Quando arriva a un mezzo, il motore lento fa un passo,"
            " e l'errore diminuisce di uno.",
        ),
        Text(
            "No position is wrong by more than half a step, and the algorithm needs only additions."
            " That is why small processors use it.",
            "Nessuna posizione è sbagliata di più di mezzo passo, e l'algoritmo ha bisogno solo di"
            " somme. Perciò lo usano i processori piccoli.",
        ),
        Text(
            "But the slow motor can step only together with the fast one. It should step every"
            " {exact_gap_ms}. It steps after {short_gap_ms}, then after {long_gap_ms}: its speed"
            " jumps all the time, and the motor hums.",
            "Ma il motore lento può fare un passo solo insieme a quello veloce. Dovrebbe farlo ogni"
            " {exact_gap_ms}. Lo fa dopo {short_gap_ms}, poi dopo {long_gap_ms}: la sua velocità"
            " salta di continuo, e il motore ronza.",
        ),
        Text(
            "Passo counts nothing. It solves for each motor when the line crosses the middle"
            " between two positions, and sends that time to the board. Here Bresenham's steps are"
            " wrong by up to {late_ms}.",
            "Passo non conta nulla. Calcola per ogni motore quando la linea attraversa la metà tra"
            " due posizioni, e manda quel tempo alla scheda. Qui i passi di Bresenham sbagliano"
            " fino a {late_ms}.",
        ),
    ],
    experiment=EXPERIMENT,
    questions=[
        Question(
            Text(
                "{fast_steps:n} fast steps, {slow_steps:n} slow ones. With which fast step does"
                " the slow motor step for the first time?",
                "{fast_steps:n} passi veloci, {slow_steps:n} lenti. Con quale passo veloce fa il"
                " primo passo il motore lento?",
            ),
            "first_at",
            given={"fast_steps": 30.0, "slow_steps": 4.0},
            mistakes=[
                Mistake(
                    lambda v: ceil(v["fast_steps"] / v["slow_steps"]),
                    Text(
                        "It does not wait for a whole step of error: one half is enough.",
                        "Non aspetta un passo intero di errore: basta un mezzo.",
                    ),
                ),
                Mistake(
                    lambda v: v["fast_steps"] // (2 * v["slow_steps"]),
                    Text(
                        "With this step the error is still below one half.",
                        "Con questo passo l'errore è ancora sotto un mezzo.",
                    ),
                ),
            ],
            why=Text(
                "Each fast step adds `4 / 30` to the error; it reaches one half with this one.",
                "Ogni passo veloce somma `4 / 30` all'errore; con questo arriva a un mezzo.",
            ),
            hint=Text(
                "Add `slow / fast` until the sum is one half or more.",
                "Somma `lento / veloce` finché il totale è un mezzo o più.",
            ),
        ),
        Question(
            Text(
                "The fast motor takes {fast_steps:n} steps at {rate_hz}, the slow one"
                " {slow_steps:n}. Which interval should the slow one have?",
                "Il motore veloce fa {fast_steps:n} passi a {rate_hz}, quello lento"
                " {slow_steps:n}. Quale intervallo dovrebbe avere quello lento?",
            ),
            "exact_gap_ms",
            given={"fast_steps": 50.0, "slow_steps": 20.0, "rate_hz": 2000.0},
            mistakes=[
                Mistake(
                    lambda v: 1000 / v["rate_hz"],
                    Text(
                        "So often the fast motor steps.", "Così spesso si muove il motore veloce."
                    ),
                ),
                Mistake(
                    lambda v: 1000 * v["slow_steps"] / v["fast_steps"] / v["rate_hz"],
                    Text(
                        "The slow motor has more time between its steps, not less.",
                        "Il motore lento ha più tempo tra i passi, non meno.",
                    ),
                ),
            ],
            why=Text(
                "Both end at the same time. Bresenham can only choose {short_gap_ms} or"
                " {long_gap_ms}.",
                "Finiscono nello stesso momento. Bresenham può scegliere solo {short_gap_ms} o"
                " {long_gap_ms}.",
            ),
            hint=Text(
                "Both motors need the same time for the line.",
                "I due motori impiegano lo stesso tempo per la linea.",
            ),
        ),
    ],
    source=Source("core/steps/step_solver.hpp", "StepSolver"),
    printer=OwnPrinter(
        Text(
            "The page's Learn shows the step times of any line, motor by motor.",
            "La pagina Impara mostra i tempi dei passi di ogni riga, motore per motore.",
        ),
        command="passo explain FILE:LINE",
        page="learn",
    ),
    links=[
        Link(
            Text("One line, from text to motor", "Una riga, dal testo al motore"),
            document="docs/tutorial/one-line.md",
        )
    ],
)
