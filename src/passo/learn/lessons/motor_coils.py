"""Two coils turn a rotor: full steps, half steps, microsteps."""

from __future__ import annotations

from math import cos, degrees, hypot, pi, sin

from passo.learn.bilingual import Text, Words, figure
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Mark, Plane, Table, edges

_FULL_STEPS = 200  # of a rotation
_HOME = pi / 4  # where drivers start: the same current in both coils
_SIGNS = {"normal": (1, 1), "one": (1, -1), "both": (-1, -1), "open": (1, 0)}
_DIRECTIONS = {
    1: Text("forward", "avanti"),
    -1: Text("backward", "indietro"),
    0: Text("none: it vibrates", "nessuno: vibra"),
}


def _compute(microsteps: float, position: float, current_a: float, wiring: str) -> Outcome:
    sign_a, sign_b = _SIGNS[wiring]

    def phase(step: float) -> float:
        return _HOME + pi / 2 * step / microsteps

    def currents(step: float) -> tuple[float, float]:
        return sign_a * current_a * cos(phase(step)), sign_b * current_a * sin(phase(step))

    coil_a, coil_b = currents(position)
    direction = sign_a * sign_b
    cycle = [currents(step) for step in range(int(4 * microsteps) + 1)]
    full_steps = [step / microsteps for step in range(len(cycle))]
    return Outcome(
        numbers=[
            Number("coil_a_a", Text("Current in coil A", "Corrente nella bobina A"), coil_a, "A"),
            Number("coil_b_a", Text("Current in coil B", "Corrente nella bobina B"), coil_b, "A"),
            Number(
                "field_a", Text("Both together", "Entrambe insieme"), hypot(coil_a, coil_b), "A"
            ),
            Number(
                "cycle_deg",
                Text("Turn of the currents", "Giro delle correnti"),
                degrees(phase(position) - _HOME),
                "°",
            ),
            Number(
                "rotor_deg",
                Text("Turn of the rotor", "Giro del rotore"),
                direction * 360 * position / (_FULL_STEPS * microsteps),
                "°",
                decimals=4,
            ),
            Number(
                "direction",
                Text("Direction", "Verso"),
                float(direction),
                decimals=0,
                words=_DIRECTIONS[direction],
            ),
        ],
        graphs=[
            Graph(
                Text("Coil currents over four full steps", "Correnti in quattro passi interi"),
                Text("full steps", "passi interi"),
                "A",
                [
                    Line(Text("coil A", "bobina A"), *edges(full_steps, [one for one, _ in cycle])),
                    Line(
                        Text("coil B", "bobina B"),
                        *edges(full_steps, [one for _, one in cycle]),
                        colour=1,
                    ),
                ],
            )
        ],
        planes=[_circle(cycle, (coil_a, coil_b), current_a)],
        tables=[_sine_table(microsteps, current_a)],
    )


def _circle(cycle: list[tuple[float, float]], now: tuple[float, float], radius: float) -> Plane:
    around = [2 * pi * k / 72 for k in range(73)]
    reach = 1.25 * radius
    return Plane(
        Text("The field of both coils", "Il campo delle due bobine"),
        [
            Line("", [-reach, reach], [0, 0], colour=6),
            Line("", [0, 0], [-reach, reach], colour=6),
            Line(
                "", [radius * cos(a) for a in around], [radius * sin(a) for a in around], colour=6
            ),
            Line("", [0, now[0]], [0, now[1]], colour=4),
        ],
        [
            *(Mark(a, b) for a, b in cycle),
            Mark(reach, 0, Text("coil A", "bobina A"), dot=False),
            Mark(0, reach, Text("coil B", "bobina B"), dot=False, beside="above"),
            Mark(now[0], now[1], Text("now", "adesso"), colour=4),
        ],
    )


def _sine_table(microsteps: float, current_a: float) -> Table:
    rows: list[list[Words]] = []
    for step in range(int(microsteps) + 1):
        angle = pi / 2 * step / microsteps
        shares = [figure(value, 3) for value in (current_a * cos(angle), current_a * sin(angle))]
        rows.append([str(step), figure(degrees(angle), 2), *shares])
    return Table(
        Text("Sine table of a quarter of the cycle", "Tavola dei seni di un quarto di ciclo"),
        [
            Text("microstep", "micropasso"),
            Text("angle, °", "angolo, °"),
            Text("cosine coil, A", "bobina del coseno, A"),
            Text("sine coil, A", "bobina del seno, A"),
        ],
        rows,
    )


EXPERIMENT = Experiment(
    "motor-coils",
    Text("The two coils of a stepper motor", "Le due bobine di un motore passo-passo"),
    Text(
        "A driver such as the A4988 sets the current of each coil from a table of sines.",
        "Un driver come l'A4988 regola la corrente di ogni bobina con una tavola di seni.",
    ),
    [
        Parameter(
            "microsteps",
            Text("Microsteps of a full step", "Micropassi di un passo intero"),
            16.0,
            choices=[
                Choice(1.0, Text("1 (full steps)", "1 (passi interi)")),
                Choice(2.0, Text("2 (half steps)", "2 (mezzi passi)")),
                *(Choice(float(each)) for each in (4, 8, 16, 32)),
            ],
        ),
        Parameter(
            "position",
            Text("Step pulses so far", "Impulsi di passo finora"),
            8.0,
            low=0.0,
            high=128.0,
            unit=Text("pulses", "impulsi"),
        ),
        Parameter(
            "current_a",
            Text("Peak current of a coil", "Corrente di picco di una bobina"),
            1.0,
            low=0.2,
            high=2.0,
            step=0.1,
            unit="A",
        ),
        Parameter(
            "wiring",
            Text("Wiring", "Cablaggio"),
            "normal",
            choices=[
                Choice("normal", Text("correct", "corretto")),
                Choice("one", Text("one coil reversed", "una bobina invertita")),
                Choice("both", Text("both coils reversed", "entrambe invertite")),
                Choice("open", Text("coil B not connected", "bobina B scollegata")),
            ],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="motor-coils",
    chapter=Chapter.ELECTRICITY,
    place=10,
    rows=(9, 8),
    minutes=30,
    title=Text("Two coils turn a rotor", "Due bobine fanno girare un rotore"),
    goal=Text(
        "You compute the current in both coils for any microstep, and predict what swapped wires"
        " do.",
        "Calcoli la corrente nelle due bobine per ogni micropasso, e prevedi che cosa fanno i fili"
        " scambiati.",
    ),
    text=[
        Text(
            "A stepper motor has two coils, A and B, at a right angle to each other in the magnetic"
            " cycle. Their currents add up like two arrows. The rotor is a magnet with fifty teeth:"
            " it turns until a tooth agrees with the sum of the arrows.",
            "Un motore passo-passo ha due bobine, A e B, ad angolo retto nel ciclo magnetico. Le"
            " loro correnti si sommano come due frecce. Il rotore è un magnete con cinquanta denti:"
            " gira finché un dente coincide con la somma delle frecce.",
        ),
        Text(
            "Full steps switch the sign of one coil at a time. Each is a quarter of the magnetic"
            " cycle, and {full.rotor_deg} of the shaft: two hundred of them are one rotation. In"
            " between, a half step leaves all the current to one coil.",
            "I passi interi cambiano il segno di una bobina alla volta. Ognuno è un quarto del"
            " ciclo magnetico, e {full.rotor_deg} dell'albero: duecento fanno un giro. Nel mezzo,"
            " un mezzo passo lascia tutta la corrente a una sola bobina.",
        ),
        Text(
            "Microsteps divide the quarter further. Coil A gets `I · cos φ`, coil B `I · sin φ`."
            " The arrow keeps its length of {field_a}, so the torque stays the same while the arrow"
            " turns. With {microsteps} microsteps one pulse turns the shaft by {single.rotor_deg}.",
            "I micropassi dividono ancora il quarto. La bobina A riceve `I · cos φ`, la B"
            " `I · sin φ`. La freccia mantiene la lunghezza di {field_a}, quindi la coppia resta la"
            " stessa mentre la freccia gira. Con {microsteps} micropassi un impulso gira l'albero"
            " di {single.rotor_deg}.",
        ),
        Text(
            "Reverse the two wires of one coil and the arrow turns the other way round: the axis"
            " moves {swapped.direction}. Reverse both coils and it moves {both.direction} again."
            " With a coil that is not connected, the arrow only flips to and fro. The motor"
            " vibrates and does not turn.",
            "Inverti i due fili di una bobina e la freccia gira al contrario: l'asse va"
            " {swapped.direction}. Inverti entrambe e va di nuovo {both.direction}. Con una bobina"
            " scollegata la freccia salta solo avanti e indietro. Il motore vibra e non gira.",
        ),
        Text(
            "Change wires only while the power supply is off. A coil that is disconnected under"
            " current makes a voltage that can destroy the driver.",
            "Cambia i fili solo ad alimentazione spenta. Una bobina scollegata sotto corrente"
            " produce una tensione che può distruggere il driver.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "full": {"microsteps": 1.0, "position": 1.0},
        "single": {"position": 1.0},
        "swapped": {"wiring": "one"},
        "both": {"wiring": "both"},
    },
    questions=[
        Question(
            Text(
                "The driver starts with the same current in both coils. With {microsteps}"
                " microsteps and a peak of {current_a}, which current has coil A after {position}?",
                "Il driver parte con la stessa corrente nelle due bobine. Con {microsteps}"
                " micropassi e un picco di {current_a}, quale corrente ha la bobina A dopo"
                " {position}?",
            ),
            "coil_a_a",
            given={"microsteps": 8.0, "position": 3.0, "current_a": 1.5},
            mistakes=[
                Mistake(
                    lambda v: v["coil_b_a"],
                    Text(
                        "That is coil B. The angle grows, so the cosine falls and the sine rises.",
                        "Questa è la bobina B. L'angolo cresce: il coseno cala e il seno sale.",
                    ),
                ),
                Mistake(
                    lambda v: v["current_a"] * cos(v["cycle_deg"] * pi / 180),
                    Text(
                        "The start is half way between the coils, at `45°`. Add the turn to it.",
                        "La partenza è a metà tra le bobine, a `45°`. Somma il giro a questo.",
                    ),
                ),
                Mistake(
                    lambda v: v["current_a"] * (1 - (45 + v["cycle_deg"]) / 90),
                    Text(
                        "The current does not fall evenly with the angle. It follows the cosine.",
                        "La corrente non cala in modo uniforme con l'angolo. Segue il coseno.",
                    ),
                ),
            ],
            why=Text(
                "The currents have turned by {cycle_deg} from `45°`: `I · cos(45° + turn)`.",
                "Le correnti hanno girato di {cycle_deg} da `45°`: `I · cos(45° + giro)`.",
            ),
            hint=Text(
                "A full step is `90°` of the cycle. Which part of it are {position}?",
                "Un passo intero è `90°` del ciclo. Quale parte sono {position}?",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "By how many degrees does the shaft turn after {position} with {microsteps}"
                " microsteps?",
                "Di quanti gradi gira l'albero dopo {position} con {microsteps} micropassi?",
            ),
            "rotor_deg",
            given={"microsteps": 32.0, "position": 48.0},
            mistakes=[
                Mistake(
                    lambda v: v["cycle_deg"],
                    Text(
                        "So far the currents turn. The rotor has fifty teeth, so it turns by a"
                        " fiftieth of that.",
                        "Di tanto girano le correnti. Il rotore ha cinquanta denti, quindi gira di"
                        " un cinquantesimo.",
                    ),
                ),
                Mistake(
                    lambda v: 360 / 200 * v["position"],
                    Text(
                        "These are full steps. One pulse is only a microstep.",
                        "Questi sono passi interi. Un impulso è solo un micropasso.",
                    ),
                ),
            ],
            why=Text(
                "The currents turn by {cycle_deg}, the shaft by a fiftieth of it.",
                "Le correnti girano di {cycle_deg}, l'albero di un cinquantesimo.",
            ),
            hint=Text(
                "How many full steps are {position}? A full step is {full.rotor_deg}.",
                "Quanti passi interi sono {position}? Un passo intero è {full.rotor_deg}.",
            ),
        ),
        Question(
            Text(
                "An axis moves the wrong way. You reverse both wires of coil A and both wires of"
                " coil B. What happens?",
                "Un asse va nel verso sbagliato. Inverti i due fili della bobina A e i due della"
                " bobina B. Che cosa succede?",
            ),
            "direction",
            given={"wiring": "both"},
            options=[
                (1.0, Text("The same direction as before", "Lo stesso verso di prima")),
                (-1.0, Text("The other direction", "L'altro verso")),
                (0.0, Text("It vibrates and does not turn", "Vibra e non gira")),
            ],
            mistakes=[
                Mistake(
                    lambda _: -1.0,
                    Text(
                        "One reversed coil does that. Two reversals cancel each other.",
                        "Questo lo fa una sola bobina invertita. Due inversioni si annullano.",
                    ),
                ),
                Mistake(
                    lambda _: 0.0,
                    Text(
                        "It vibrates if a coil is open, or if wires of two coils are mixed up. Here"
                        " each coil still has its own two wires.",
                        "Vibra se una bobina è aperta, o se i fili delle due bobine sono mescolati."
                        " Qui ogni bobina ha ancora i suoi due fili.",
                    ),
                ),
            ],
            why=Text(
                "The arrow starts on the opposite side but turns the same way: {direction}.",
                "La freccia parte dal lato opposto ma gira nello stesso verso: {direction}.",
            ),
            hint=Text(
                "Change the signs of both currents, and follow the arrow for a step.",
                "Cambia segno a entrambe le correnti, e segui la freccia per un passo.",
            ),
        ),
    ],
    source=Source("firmware/core/stepper.c", "command_set_next_step_dir"),
    printer=OwnPrinter(
        Text(
            "An axis that moves the wrong way needs no other wires: put or remove `!` before its"
            " direction pin in the machine file. This command turns the motor forth and back, also"
            " before homing.",
            "Un asse che va nel verso sbagliato non richiede altri fili: metti o togli `!` davanti"
            " al pin di direzione nel file macchina. Questo comando gira il motore avanti e"
            " indietro, anche prima dell'homing.",
        ),
        command="STEPPER_BUZZ STEPPER=stepper_x",
    ),
    links=[Link(Text("Drivers", "Driver"), document="docs/how-to/set-up-drivers.md")],
)
