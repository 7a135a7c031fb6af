"""Homing gives the machine its zero; coordinates of the work move on top of it."""

from __future__ import annotations

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line
from passo.learn.planned import planned, shipped
from passo.motion.triggered_moves import sampling_s


def _compute(
    first_mm: float,
    called_mm: float,
    second_mm: float,
    speed_mm_s: float,
    acceleration_mm_s2: float,
) -> Outcome:
    machine = shipped("i3")
    lines = f"G1 X{first_mm:.3f} F3000\nG92 X{called_mm:.3f}\nG1 X{second_mm:.3f}\nG4 P1\n"
    moves, _ = planned(lines, machine)
    machine_mm = moves[-1].end_mm[0] if moves else 0.0
    poll_ms = 1000 * sampling_s(machine.steppers["x"].steps_per_unit * speed_mm_s)
    past_mm = speed_mm_s**2 / (2 * acceleration_mm_s2)
    speeds = [float(v) for v in range(0, 101, 4)]
    return Outcome(
        numbers=[
            Number(
                "machine_mm",
                Text("Position of the machine at the end", "Posizione della macchina alla fine"),
                machine_mm,
                "mm",
            ),
            Number(
                "offset_mm",
                Text("Offset of the coordinates", "Scostamento delle coordinate"),
                first_mm - called_mm,
                "mm",
            ),
            Number(
                "past_mm",
                Text("Way beyond the switch", "Strada oltre il finecorsa"),
                past_mm,
                "mm",
                3,
            ),
            Number(
                "late_mm",
                Text("Way between two looks at the switch", "Strada tra due letture"),
                speed_mm_s * poll_ms / 1000,
                "mm",
                3,
            ),
            Number("poll_ms", Text("Between two looks", "Tra due letture"), poll_ms, "ms"),
        ],
        graphs=[
            Graph(
                Text("Way beyond the switch", "Strada oltre il finecorsa"),
                Text("speed of homing, mm/s", "velocità di homing, mm/s"),
                "mm",
                [
                    Line(
                        Text("with this acceleration", "con questa accelerazione"),
                        speeds,
                        [v * v / (2 * acceleration_mm_s2) for v in speeds],
                    )
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "homing-and-coordinates",
    Text("After homing", "Dopo l'homing"),
    Text(
        "The machine is at its zero. It moves, G92 gives its place a new name, it moves again.",
        "La macchina è al suo zero. Si muove, G92 dà al punto un nuovo nome, si muove ancora.",
    ),
    [
        Parameter(
            "first_mm", Text("First `G1 X`", "Primo `G1 X`"), 50.0, 50.0, 150.0, 5.0, unit="mm"
        ),
        Parameter("called_mm", Text("`G92 X`", "`G92 X`"), 0.0, 0.0, 50.0, 5.0, unit="mm"),
        Parameter(
            "second_mm", Text("Second `G1 X`", "Secondo `G1 X`"), 10.0, 0.0, 50.0, 1.0, unit="mm"
        ),
        Parameter(
            "speed_mm_s",
            Text("Speed of homing", "Velocità di homing"),
            40.0,
            2.0,
            100.0,
            2.0,
            unit="mm/s",
        ),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            1000.0,
            500.0,
            3000.0,
            100.0,
            unit="mm/s²",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="homing-and-coordinates",
    chapter=Chapter.MOTION,
    place=100,
    rows=(28,),
    minutes=25,
    title=Text("Homing and coordinates", "Homing e coordinate"),
    goal=Text(
        "You know where a printer is, and what G92 changes: names, not places.",
        "Sai dove si trova una stampante, e che cosa cambia G92: i nomi, non i luoghi.",
    ),
    text=[
        Text(
            "After power-on a motor knows nothing of its position: it only counts steps. Homing"
            " drives each axis to a switch, whose place is written in the machine file. From then"
            " on the count is a position.",
            "Dopo l'accensione un motore non sa nulla della sua posizione: conta solo passi."
            " L'homing porta ogni asse a un finecorsa, la cui posizione è nel file della macchina."
            " Da allora il conteggio è una posizione.",
        ),
        Text(
            "A switch is found twice. First fast: from {speed_mm_s} the axis needs {past_mm} to"
            " stop, and the switch must survive that. Then slowly. The board looks at the switch"
            " about once a step: every {poll_ms} at {speed_mm_s}, in which the axis moves"
            " {late_mm}. At {slow.speed_mm_s} it is {slow.late_mm}, and the switch bends less.",
            "Il finecorsa si cerca due volte. Prima in fretta: da {speed_mm_s} l'asse ha bisogno di"
            " {past_mm} per fermarsi, e il finecorsa deve sopportarlo. Poi piano. La scheda guarda"
            " il finecorsa circa una volta per passo: ogni {poll_ms} a {speed_mm_s}, e l'asse si"
            " muove di {late_mm}. A {slow.speed_mm_s} sono {slow.late_mm}, e il finecorsa si piega"
            " meno.",
        ),
        Text(
            "`G92` moves nothing. It says: the place where you are is now called {called_mm}."
            " The difference is kept, and added to each later coordinate. Slicers use it for the"
            " filament: `G92 E0` before each line keeps numbers small.",
            "`G92` non muove nulla. Dice: il punto dove sei ora si chiama {called_mm}. La"
            " differenza resta, e si somma a ogni coordinata seguente. Gli slicer la usano per il"
            " filamento: `G92 E0` mantiene piccoli i numeri.",
        ),
        Text(
            "So after `G1` to {first_mm}, `G92` to {called_mm} and `G1` to {second_mm} the machine"
            " stands at {machine_mm}. Limits of the axis are checked there, in machine"
            " coordinates.",
            "Così dopo `G1` a {first_mm}, `G92` a {called_mm} e `G1` a {second_mm} la macchina è a"
            " {machine_mm}. I limiti dell'asse si controllano lì, in coordinate della macchina.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"slow": {"speed_mm_s": 4.0}},
    questions=[
        Question(
            Text(
                "The axis is homed to zero. Then `G1` to {first_mm}, `G92` to {called_mm}, `G1` to"
                " {second_mm}. Where is the machine?",
                "L'asse è a zero. Poi `G1` a {first_mm}, `G92` a {called_mm}, `G1` a {second_mm}."
                " Dov'è la macchina?",
            ),
            "machine_mm",
            given={"first_mm": 80.0, "called_mm": 25.0, "second_mm": 40.0},
            mistakes=[
                Mistake(
                    lambda v: v["second_mm"],
                    Text(
                        "So it is called. G92 has given the place another name.",
                        "Così si chiama. G92 ha dato al punto un altro nome.",
                    ),
                ),
                Mistake(
                    lambda v: v["first_mm"] + v["second_mm"],
                    Text(
                        "That would be right after `G92 X0`, or with relative moves.",
                        "Sarebbe giusto dopo `G92 X0`, o con movimenti relativi.",
                    ),
                ),
            ],
            why=Text(
                "The coordinates are offset by {offset_mm}: add it to the last `G1`.",
                "Le coordinate sono spostate di {offset_mm}: sommalo all'ultimo `G1`.",
            ),
            hint=Text(
                "How far does the last `G1` move, and from where?",
                "Di quanto si muove l'ultimo `G1`, e da dove?",
            ),
        ),
        Question(
            Text(
                "An axis meets its switch at {speed_mm_s} and brakes with {acceleration_mm_s2}. How"
                " far beyond the switch does it stop?",
                "Un asse incontra il finecorsa a {speed_mm_s} e frena con {acceleration_mm_s2}. A"
                " quale distanza oltre il finecorsa si ferma?",
            ),
            "past_mm",
            given={"speed_mm_s": 60.0, "acceleration_mm_s2": 1500.0},
            mistakes=[
                Mistake(
                    lambda v: v["speed_mm_s"] ** 2 / v["acceleration_mm_s2"],
                    Text(
                        "Twice too far: the mean speed while it brakes is half.",
                        "Il doppio: la velocità media mentre frena è metà.",
                    ),
                ),
                Mistake(
                    lambda v: v["late_mm"],
                    Text(
                        "That is the way until the board notices. Then it still has to brake.",
                        "Questa è la strada finché la scheda se ne accorge. Poi deve ancora"
                        " frenare.",
                    ),
                ),
            ],
            why=Text(
                "`v² / (2·a)`. At half the speed it is a quarter.",
                "`v² / (2·a)`. A metà velocità è un quarto.",
            ),
            hint=Text("It is the distance to stop, as before.", "È la distanza per fermarsi."),
        ),
    ],
    source=Source("src/passo/motion/homing.py", "Homer"),
    printer=OwnPrinter(
        Text(
            "M114 shows the position. Home, move, send G92, and ask again: the head has not moved.",
            "M114 mostra la posizione. Fai l'homing, muovi, invia G92, e chiedi di nuovo: la"
            " testina non si è mossa.",
        ),
        command="M114",
    ),
)
