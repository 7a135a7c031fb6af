"""The speed of one move over time: a trapezoid or a triangle."""

from __future__ import annotations

from math import sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line
from passo.learn.planned import planned, shipped

_MM_S = "mm/s"
_TRAPEZOID = Text("trapezoid", "trapezio")
_TRIANGLE = Text("triangle", "triangolo")


def _compute(length_mm: float, speed_mm_s: float, acceleration_mm_s2: float) -> Outcome:
    machine = shipped("i3")
    limits = f"M204 P{acceleration_mm_s2:.3f} T{acceleration_mm_s2:.3f}"
    (move,), _ = planned(f"{limits}\nG1 X{length_mm:.4f} F{60 * speed_mm_s:.4f}\n", machine)
    hz = machine.board.clock_hz
    ramp_s, cruise_s = move.accelerate_ticks / hz, move.cruise_ticks / hz
    brake_s = move.decelerate_ticks / hz
    top = move.cruise_speed
    cruises = move.cruise_length > 1e-9
    ends_s = [0.0, ramp_s, ramp_s + cruise_s, ramp_s + cruise_s + brake_s]
    wanted = speed_mm_s
    return Outcome(
        numbers=[
            Number(
                "shape",
                Text("Shape", "Forma"),
                float(cruises),
                words=_TRAPEZOID if cruises else _TRIANGLE,
            ),
            Number("top_mm_s", Text("Highest speed", "Velocità massima"), top, _MM_S),
            Number(
                "ramp_mm",
                Text("Distance to speed up", "Distanza per accelerare"),
                move.accelerate_length,
                "mm",
            ),
            Number(
                "ramp_s", Text("Time to speed up", "Tempo per accelerare"), ramp_s, "s", decimals=3
            ),
            Number(
                "cruise_mm",
                Text("Distance at the highest speed", "Distanza a velocità massima"),
                move.cruise_length,
                "mm",
            ),
            Number(
                "total_s",
                Text("Time of the move", "Durata del movimento"),
                ends_s[-1],
                "s",
                decimals=3,
            ),
        ],
        graphs=[
            Graph(
                Text("Speed over time", "Velocità nel tempo"),
                Text("time, s", "tempo, s"),
                _MM_S,
                [
                    Line(Text("planned", "pianificata"), ends_s, [0.0, top, top, 0.0]),
                    Line(
                        Text("feedrate of the line", "velocità della riga"),
                        [0.0, ends_s[-1]],
                        [wanted, wanted],
                        colour=1,
                        dashed=True,
                    ),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "trapezoid-and-triangle",
    Text("One move, planned", "Un movimento, pianificato"),
    Text(
        "Passo plans one move from rest to rest on the machine `i3`.",
        "Passo pianifica un movimento da fermo a fermo sulla macchina `i3`.",
    ),
    [
        Parameter(
            "length_mm", Text("Length", "Lunghezza"), 60.0, low=0.5, high=200.0, step=0.5, unit="mm"
        ),
        Parameter(
            "speed_mm_s",
            Text("Feedrate", "Velocità richiesta"),
            100.0,
            low=5.0,
            high=300.0,
            step=5.0,
            unit=_MM_S,
        ),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            1000.0,
            low=100.0,
            high=3000.0,
            step=100.0,
            unit="mm/s²",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="trapezoid-and-triangle",
    chapter=Chapter.MOTION,
    place=40,
    rows=(4,),
    minutes=25,
    title=Text("Trapezoid and triangle", "Trapezio e triangolo"),
    goal=Text(
        "You predict how fast a move becomes, and whether it reaches its feedrate at all.",
        "Prevedi quanto diventa veloce un movimento, e se raggiunge la velocità richiesta.",
    ),
    text=[
        Text(
            "A motor cannot jump to {speed_mm_s}: it would lose steps. So the speed grows evenly:"
            " with {acceleration_mm_s2}, by {acceleration_mm_s2:n} mm/s in each second. After"
            " {ramp_s} it is there.",
            "Un motore non può saltare a {speed_mm_s}: perderebbe passi. La velocità cresce quindi"
            " in modo uniforme: con {acceleration_mm_s2}, di {acceleration_mm_s2:n} mm/s ogni"
            " secondo. Dopo {ramp_s} ci arriva.",
        ),
        Text(
            "Speeding up costs distance. From rest it is `v² / (2·a)`, here {ramp_mm}. Braking"
            " costs the same again.",
            "Accelerare costa distanza. Da fermo è `v² / (2·a)`, qui {ramp_mm}. Frenare costa"
            " altrettanto.",
        ),
        Text(
            "What is left of {length_mm} is driven at the full speed: {cruise_mm}. Over time the"
            " speed is a trapezoid.",
            "Ciò che resta di {length_mm} si percorre a velocità piena: {cruise_mm}. Nel tempo la"
            " velocità è un trapezio.",
        ),
        Text(
            "A short move has no room for that. With {short.length_mm} it must brake half way:"
            " the speed is a triangle, and its top is `√(a·length)` = {short.top_mm_s}, whatever"
            " feedrate you ask for.",
            "Un movimento corto non ha spazio. Con {short.length_mm} deve frenare a metà: la"
            " velocità è un triangolo, e la sua punta è `√(a·lunghezza)` = {short.top_mm_s},"
            " qualunque velocità tu chieda.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"short": {"length_mm": 4.0}},
    questions=[
        Question(
            Text(
                "How far does the head move until it has {speed_mm_s}, with {acceleration_mm_s2}?",
                "Quanta strada fa la testina per raggiungere {speed_mm_s}, con"
                " {acceleration_mm_s2}?",
            ),
            "ramp_mm",
            given={"speed_mm_s": 150.0, "acceleration_mm_s2": 1500.0},
            mistakes=[
                Mistake(
                    lambda v: v["speed_mm_s"] ** 2 / v["acceleration_mm_s2"],
                    Text(
                        "Twice too much. While it speeds up, the mean speed is only half of the"
                        " top.",
                        "Il doppio del giusto. Mentre accelera, la velocità media è solo metà della"
                        " massima.",
                    ),
                ),
                Mistake(
                    lambda v: v["speed_mm_s"] / v["acceleration_mm_s2"],
                    Text(
                        "That is the time, in seconds. The distance is this time at the mean"
                        " speed.",
                        "Questo è il tempo, in secondi. La distanza è questo tempo alla velocità"
                        " media.",
                    ),
                ),
            ],
            why=Text(
                "The mean speed is half of {speed_mm_s}, for {ramp_s}. Twice the speed needs four"
                " times the distance.",
                "La velocità media è metà di {speed_mm_s}, per {ramp_s}. Una velocità doppia"
                " richiede quattro volte la distanza.",
            ),
            hint=Text(
                "Take the time first, `v / a`, then the mean speed for that time.",
                "Prima trova il tempo, `v / a`, poi la velocità media per quel tempo.",
            ),
        ),
        Question(
            Text(
                "The feedrate is {speed_mm_s}, the acceleration {acceleration_mm_s2}, but the move"
                " is only {length_mm} long. Which speed does it reach?",
                "La velocità richiesta è {speed_mm_s}, l'accelerazione {acceleration_mm_s2}, ma il"
                " movimento è lungo solo {length_mm}. Quale velocità raggiunge?",
            ),
            "top_mm_s",
            given={"length_mm": 2.5, "speed_mm_s": 200.0},
            mistakes=[
                Mistake(
                    lambda v: v["speed_mm_s"],
                    Text(
                        "It would need half of `v² / a` to speed up, and as much to brake. The move"
                        " is shorter.",
                        "Servirebbe metà di `v² / a` per accelerare, e altrettanto per frenare. Il"
                        " movimento è più corto.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(2 * v["acceleration_mm_s2"] * v["length_mm"]),
                    Text(
                        "So fast it would be at the end, without braking. It must stop there, so it"
                        " brakes from the middle on.",
                        "Così veloce sarebbe alla fine, senza frenare. Ma lì deve fermarsi, quindi"
                        " frena dalla metà.",
                    ),
                ),
            ],
            why=Text(
                "Half of the move speeds up: `v² = 2·a·length/2`. The shape is a {shape}.",
                "Metà del movimento accelera: `v² = 2·a·lunghezza/2`. La forma è un {shape}.",
            ),
            hint=Text(
                "Speeding up may use half of the length. Which speed belongs to that distance?",
                "Per accelerare può usare metà della lunghezza. Quale velocità corrisponde?",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("core/plan/planner.hpp", "Planner"),
    printer=OwnPrinter(
        Text(
            "M204 shows and sets the acceleration. Change it, and listen to a short move.",
            "M204 mostra e imposta l'accelerazione. Cambiala, e ascolta un movimento corto.",
        ),
        command="M204",
        page="learn",
    ),
    links=[
        Link(Text("Planning", "Pianificazione"), document="docs/explanation/planning.md"),
        Link(
            Text("Plan any line of G-code", "Pianifica una riga qualsiasi di G-code"), page="learn"
        ),
    ],
)
