"""Look-ahead: how far the planner must see so that short moves become fast."""

from __future__ import annotations

from math import ceil, sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_MM_S = "mm/s"
_MOVES = 40  # of the straight line


def _trapezoid(v0: float, v1: float, cap: float, a: float, length: float) -> tuple[float, float]:
    """The highest speed, and the time, of a move between two speeds."""
    top = min(cap, sqrt((v0 * v0 + v1 * v1) / 2 + a * length))
    ramps = (2 * top * top - v0 * v0 - v1 * v1) / (2 * a)
    return top, (2 * top - v0 - v1) / a + max(0.0, length - ramps) / top


def _speeds(known: int, length: float, a: float, cap: float) -> list[float]:
    """The speeds between the moves. When a move begins, the planner knows it and the `known` - 1
    next ones, and must be able to stop at the end of the last known one."""
    speeds = [0.0]
    for move in range(_MOVES):
        further = min(known - 1, _MOVES - 1 - move)
        reachable = sqrt(speeds[-1] ** 2 + 2 * a * length)
        speeds.append(min(cap, reachable, sqrt(2 * a * further * length)))
    return speeds


def _drawn(
    speeds: list[float], length: float, a: float, cap: float
) -> tuple[list[float], list[float], float, float]:
    """Path, speed over it, the highest speed and the time of all moves."""
    x, y, best, total_s = [0.0], [0.0], 0.0, 0.0
    for i in range(_MOVES):
        v0, v1 = speeds[i], speeds[i + 1]
        top, time_s = _trapezoid(v0, v1, cap, a, length)
        rise, fall = (top * top - v0 * v0) / (2 * a), (top * top - v1 * v1) / (2 * a)
        begin, end = i * length, (i + 1) * length
        x += [begin + rise, end - fall, end]
        y += [top, top, v1]
        best, total_s = max(best, top), total_s + time_s
    return x, y, best, total_s


def _compute(
    known: float, length_mm: float, speed_mm_s: float, acceleration_mm_s2: float
) -> Outcome:
    a, cap = acceleration_mm_s2, speed_mm_s
    speeds = _speeds(int(known), length_mm, a, cap)
    x, y, best, total_s = _drawn(speeds, length_mm, a, cap)
    all_x, all_y, _, all_s = _drawn(_speeds(_MOVES, length_mm, a, cap), length_mm, a, cap)
    stop_mm = cap * cap / (2 * a)
    window = min(int(known), _MOVES)
    back_x = [length_mm * window * i / 40 for i in range(41)]
    back_y = [min(2 * cap, sqrt(2 * a * (window * length_mm - at))) for at in back_x[:-1]] + [0.0]
    return Outcome(
        numbers=[
            Number("top_mm_s", Text("Highest speed", "Velocità massima"), best, _MM_S),
            Number("total_s", Text("Time", "Durata"), total_s, "s", decimals=3),
            Number(
                "slower",
                Text("Times slower than with all moves", "Volte più lento che con tutti"),
                total_s / all_s,
            ),
            Number("stop_mm", Text("Distance to stop", "Distanza per fermarsi"), stop_mm, "mm"),
            Number(
                "needed",
                Text("Moves that hold this distance", "Movimenti che la contengono"),
                float(ceil(stop_mm / length_mm - 1e-9)),
                decimals=0,
            ),
        ],
        graphs=[
            Graph(
                Text("Speed along the line", "Velocità lungo la linea"),
                Text("path, mm", "percorso, mm"),
                _MM_S,
                [
                    Line(Text("with this queue", "con questa coda"), x, y),
                    Line(Text("all moves known", "tutti i movimenti noti"), all_x, all_y, 1, True),
                    Line(
                        Text("backward from the last known end", "all'indietro dall'ultima fine"),
                        back_x,
                        back_y,
                        2,
                        True,
                    ),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "look-ahead",
    Text("A straight line in short moves", "Una linea retta in movimenti corti"),
    Text(
        "A slicer has cut one straight line into equal moves. The planner knows only a part of"
        " them.",
        "Uno slicer ha tagliato una linea retta in movimenti uguali. Il pianificatore ne conosce"
        " solo una parte.",
    ),
    [
        Parameter(
            "known",
            Text("Known moves", "Movimenti noti"),
            4.0,
            choices=[Choice(value) for value in (1.0, 2.0, 4.0, 16.0, 256.0)],
        ),
        Parameter(
            "length_mm",
            Text("Length of a move", "Lunghezza di un movimento"),
            0.5,
            low=0.1,
            high=5.0,
            step=0.1,
            unit="mm",
        ),
        Parameter(
            "speed_mm_s",
            Text("Feedrate", "Velocità richiesta"),
            100.0,
            low=10.0,
            high=200.0,
            step=10.0,
            unit=_MM_S,
        ),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            1000.0,
            low=500.0,
            high=5000.0,
            step=500.0,
            unit="mm/s²",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="look-ahead",
    chapter=Chapter.MOTION,
    place=60,
    rows=(6,),
    minutes=25,
    title=Text("Look-ahead", "Guardare avanti"),
    goal=Text(
        "You know why a printer needs a queue of moves, and how long it must be.",
        "Sai perché una stampante ha bisogno di una coda di movimenti, e quanto lunga.",
    ),
    text=[
        Text(
            "The planner must be able to stop at the end of the last move that it knows: perhaps"
            " no other one comes. This rule costs speed.",
            "Il pianificatore deve potersi fermare alla fine dell'ultimo movimento che conosce:"
            " forse non ne arriva un altro. Questa regola costa velocità.",
        ),
        Text(
            "With one known move, each of {length_mm} begins and ends at rest. Its top is"
            " `√(a·length)` = {one.top_mm_s}, and the line takes {one.slower:n} times as long.",
            "Con un solo movimento noto, ognuno di {length_mm} inizia e finisce da fermo. La sua"
            " punta è `√(a·lunghezza)` = {one.top_mm_s}, e la linea dura {one.slower:n} volte"
            " tanto.",
        ),
        Text(
            "Planning has two passes. The backward pass begins at the last known end with speed"
            " zero, and finds for each earlier corner the highest speed from which braking is"
            " still possible: `v² = 2·a·distance`. The forward pass begins at the present speed,"
            " and allows only what the acceleration can reach. The lower one counts.",
            "La pianificazione ha due passaggi. Quello all'indietro parte dall'ultima fine nota con"
            " velocità zero, e trova per ogni angolo precedente la velocità massima da cui si può"
            " ancora frenare: `v² = 2·a·distanza`. Quello in avanti parte dalla velocità attuale, e"
            " permette solo ciò che l'accelerazione raggiunge. Vale la più bassa.",
        ),
        Text(
            "With {known:n} known moves the line reaches {top_mm_s}. To stop from {speed_mm_s}"
            " takes `v² / (2·a)` = {stop_mm}, which is {needed:n} moves. A longer queue gains"
            " nothing on a straight line.",
            "Con {known:n} movimenti noti la linea raggiunge {top_mm_s}. Per fermarsi da"
            " {speed_mm_s} serve `v² / (2·a)` = {stop_mm}, cioè {needed:n} movimenti. Una coda più"
            " lunga non guadagna nulla su una linea retta.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"one": {"known": 1.0}},
    questions=[
        Question(
            Text(
                "Moves of {length_mm}, {acceleration_mm_s2}, a feedrate of {speed_mm_s}. How many"
                " moves hold the distance to stop?",
                "Movimenti di {length_mm}, {acceleration_mm_s2}, velocità richiesta {speed_mm_s}."
                " Quanti movimenti contengono la distanza per fermarsi?",
            ),
            "needed",
            given={"length_mm": 0.2, "speed_mm_s": 60.0},
            mistakes=[
                Mistake(
                    lambda v: 2 * v["stop_mm"] / v["length_mm"],
                    Text(
                        "Twice too many. While it brakes, the mean speed is half of the top.",
                        "Il doppio. Mentre frena, la velocità media è metà di quella massima.",
                    ),
                ),
                Mistake(
                    lambda v: v["stop_mm"],
                    Text(
                        "That is the distance in millimetres. Divide it by the length of a move.",
                        "Questa è la distanza in millimetri. Dividila per la lunghezza di un"
                        " movimento.",
                    ),
                ),
            ],
            why=Text(
                "The distance is {stop_mm}. Curves of a slicer have such short moves: a queue of a"
                " few moves would make them slow.",
                "La distanza è {stop_mm}. Le curve di uno slicer hanno movimenti così corti: una"
                " coda di pochi movimenti le renderebbe lente.",
            ),
            hint=Text(
                "Take `v² / (2·a)` first, then count moves.",
                "Calcola prima `v² / (2·a)`, poi conta i movimenti.",
            ),
        ),
        Question(
            Text(
                "Only one move is known at a time. Which speed does a move of {length_mm} reach"
                " with {acceleration_mm_s2}?",
                "È noto un solo movimento alla volta. Quale velocità raggiunge un movimento di"
                " {length_mm} con {acceleration_mm_s2}?",
            ),
            "top_mm_s",
            given={"known": 1.0, "length_mm": 0.9},
            mistakes=[
                Mistake(
                    lambda v: v["speed_mm_s"],
                    Text(
                        "The feedrate would need more distance than there is.",
                        "La velocità richiesta avrebbe bisogno di più distanza.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(2 * v["acceleration_mm_s2"] * v["length_mm"]),
                    Text(
                        "It must also brake within this move: only half of it is for speeding up.",
                        "Deve anche frenare in questo movimento: solo metà serve per accelerare.",
                    ),
                ),
            ],
            why=Text(
                "It is the triangle of one lonely move: `√(a·length)`.",
                "È il triangolo di un movimento isolato: `√(a·lunghezza)`.",
            ),
            hint=Text(
                "Speeding up and braking share the length.",
                "Accelerare e frenare si dividono la lunghezza.",
            ),
        ),
    ],
    source=Source("core/plan/planner.hpp", "Planner"),
    printer=OwnPrinter(
        Text(
            "Open a file with curves in the viewer, coloured by speed. Where a curve is slow,"
            " look at the length of its moves.",
            "Apri nel visualizzatore un file con curve, colorato per velocità. Dove una curva è"
            " lenta, guarda la lunghezza dei movimenti.",
        ),
        page="viewer",
    ),
    links=[Link(Text("Planning", "Pianificazione"), document="docs/explanation/planning.md")],
)
