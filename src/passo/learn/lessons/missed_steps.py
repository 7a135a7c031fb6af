"""A rotor under load: its angle behind the field, and the load that makes it lose steps."""

from __future__ import annotations

from math import asin, degrees, pi, sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line
from passo.learn.stepper_model import CYCLE_MM, RADIUS_M, TRAVEL_MM, Drive, Move, run, shaft_rad

_FULL_STEPS = 4  # in a cycle of the currents
_MOVE_MM = 60.0
_OBSTACLE_MM = (27.0, 33.0)


def _compute(
    current_a: float,
    supply_v: float,
    mass_kg: float,
    acceleration_mm_s2: float,
    speed_mm_s: float,
    drag_n: float,
    obstacle_n: float,
) -> Outcome:
    drive = Drive(current_a, supply_v, mass_kg, drag_n)
    top_mm_s = min(speed_mm_s, sqrt(acceleration_mm_s2 * _MOVE_MM))
    holding = drive.pull_out_nm(0.0)
    at_speed = drive.pull_out_nm(shaft_rad(top_mm_s))
    speeding_up = drive.inertia_kgm2 * shaft_rad(acceleration_mm_s2) + drag_n * RADIUS_M
    at_obstacle = (drag_n + obstacle_n) * RADIUS_M
    needed = max(speeding_up, at_obstacle)
    steady = drag_n * RADIUS_M / at_speed if at_speed else 1.0
    behind = asin(min(1.0, steady))
    move = Move(_MOVE_MM, acceleration_mm_s2, top_mm_s, _OBSTACLE_MM)
    times, ideal, real = run(drive, move, obstacle_n)
    slipped = round((ideal[-1] - real[-1]) / CYCLE_MM)
    speeds = [float(v) for v in range(0, 1001, 20)]
    return Outcome(
        numbers=[
            Number(
                "holding_nmm", Text("Holding torque", "Coppia di tenuta"), 1000 * holding, "N·mm"
            ),
            Number(
                "pull_out_n",
                Text("Largest force at full speed", "Forza massima a piena velocità"),
                at_speed / RADIUS_M,
                "N",
                decimals=1,
            ),
            Number(
                "needed_n",
                Text("Largest force that the move needs", "Forza massima che serve"),
                needed / RADIUS_M,
                "N",
                decimals=1,
            ),
            Number(
                "load_deg",
                Text("Load angle at full speed", "Angolo di carico a piena velocità"),
                degrees(behind),
                "°",
                decimals=1,
            ),
            Number(
                "lag_mm",
                Text("Lag at full speed", "Ritardo a piena velocità"),
                CYCLE_MM * behind / (2 * pi),
                "mm",
                decimals=3,
            ),
            Number(
                "lost_steps",
                Text("Lost full steps", "Passi interi persi"),
                float(_FULL_STEPS * slipped),
                decimals=0,
            ),
            Number(
                "shift_mm",
                Text("Shift of all that follows", "Spostamento di tutto il seguito"),
                CYCLE_MM * slipped,
                "mm",
            ),
        ],
        graphs=[
            Graph(
                Text("Position", "Posizione"),
                Text("time, s", "tempo, s"),
                "mm",
                [
                    Line(Text("steps of the board", "passi della scheda"), times, ideal, 1, True),
                    Line(Text("carriage", "carrello"), times, real),
                ],
            ),
            Graph(
                Text("Pull-out force of the motor", "Forza limite del motore"),
                Text("speed, mm/s", "velocità, mm/s"),
                "N",
                [
                    Line(
                        f"{volts:.0f} V",
                        speeds,
                        [
                            Drive(current_a, volts, 0.0, 0.0).pull_out_nm(shaft_rad(v)) / RADIUS_M
                            for v in speeds
                        ],
                        number,
                    )
                    for number, volts in enumerate((12.0, 24.0))
                ],
            ),
        ],
    )


EXPERIMENT = Experiment(
    "missed-steps",
    Text("A motor under load", "Un motore sotto carico"),
    Text(
        "A model of a motor, its driver and a carriage moves 60 mm. In the middle an obstacle"
        " pushes against it.",
        "Un modello di motore, driver e carrello si muove di 60 mm. Nel mezzo un ostacolo lo"
        " frena.",
    ),
    [
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
            "supply_v",
            Text("Supply of the driver", "Alimentazione del driver"),
            24.0,
            unit="V",
            choices=[Choice(12.0), Choice(24.0)],
        ),
        Parameter(
            "mass_kg",
            Text("Moving mass", "Massa in movimento"),
            0.4,
            low=0.1,
            high=2.0,
            step=0.1,
            unit="kg",
        ),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            3000.0,
            low=500.0,
            high=40_000.0,
            step=500.0,
            unit="mm/s²",
        ),
        Parameter(
            "speed_mm_s", Text("Speed", "Velocità"), 150.0, 50.0, 1000.0, step=10.0, unit="mm/s"
        ),
        Parameter(
            "drag_n", Text("Friction of the axis", "Attrito dell'asse"), 5.0, 0.0, 20.0, unit="N"
        ),
        Parameter(
            "obstacle_n",
            Text("Force of the obstacle", "Forza dell'ostacolo"),
            20.0,
            0.0,
            60.0,
            unit="N",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="missed-steps",
    chapter=Chapter.ELECTRICITY,
    place=15,
    rows=(9,),
    minutes=30,
    title=Text("Load angle and missed steps", "Angolo di carico e passi persi"),
    goal=Text(
        "You compute how far a loaded motor stays behind its steps, and when it loses them.",
        "Calcoli quanto un motore sotto carico resta indietro, e quando perde passi.",
    ),
    text=[
        Text(
            "A stepper motor pulls only while its rotor is behind the field. The torque is"
            " `T = T_max · sin(load angle)`. With {drag_n} of friction at {speed_mm_s} the load"
            " angle is {load_deg}, and the carriage is {lag_mm} behind.",
            "Un motore passo-passo tira solo se il rotore è indietro rispetto al campo. La coppia è"
            " `T = T_max · sin(angolo di carico)`. Con {drag_n} di attrito a {speed_mm_s} l'angolo"
            " di carico è {load_deg}, e il carrello è indietro di {lag_mm}.",
        ),
        Text(
            "The angle is measured in the cycle of the currents: at `90°` the rotor is one full"
            " step behind, and the torque has its maximum, the pull-out torque. Here that is"
            " {pull_out_n} at the belt. Any more load, and the rotor slips to the next tooth.",
            "L'angolo si misura nel ciclo delle correnti: a `90°` il rotore è indietro di un passo"
            " intero, e la coppia è massima, la coppia limite. Qui sono {pull_out_n} alla cinghia."
            " Con più carico il rotore scivola al dente seguente.",
        ),
        Text(
            "The board does not see that: without an encoder it counts its own pulses. A moving"
            " rotor rarely catches up again at this speed. With {hit.obstacle_n} from the obstacle"
            " it loses {hit.lost_steps} full steps, and all that follows is shifted by"
            " {hit.shift_mm}.",
            "La scheda non lo vede: senza encoder conta solo i propri impulsi. A questa velocità il"
            " rotore di rado si riaggancia subito. Con {hit.obstacle_n} dall'ostacolo perde"
            " {hit.lost_steps} passi interi, e tutto il seguito è spostato di {hit.shift_mm}.",
        ),
        Text(
            "Acceleration needs force, too: mass times acceleration, for the rotor as well. With"
            " {hard.acceleration_mm_s2} the move needs {hard.needed_n}.",
            "Anche accelerare richiede forza: massa per accelerazione, compreso il rotore. Con"
            " {hard.acceleration_mm_s2} il movimento richiede {hard.needed_n}.",
        ),
        Text(
            "At high speed the coils get less current, because their inductance delays it and the"
            " turning rotor makes a voltage against the supply. At {slow.speed_mm_s} and"
            " {slow.supply_v} only {slow.pull_out_n} are left; at {fast.supply_v} it is"
            " {fast.pull_out_n}. The model leaves out resonance, which takes more.",
            "Ad alta velocità le bobine ricevono meno corrente, perché l'induttanza la ritarda e il"
            " rotore che gira produce una tensione contraria. A {slow.speed_mm_s} e {slow.supply_v}"
            " restano solo {slow.pull_out_n}; a {fast.supply_v} sono {fast.pull_out_n}. Il modello"
            " trascura la risonanza, che ne toglie ancora.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "hit": {"obstacle_n": 20.0},
        "hard": {"acceleration_mm_s2": 20_000.0, "obstacle_n": 0.0},
        "slow": {"speed_mm_s": 800.0, "acceleration_mm_s2": 15_000.0, "supply_v": 12.0},
        "fast": {"speed_mm_s": 800.0, "acceleration_mm_s2": 15_000.0, "supply_v": 24.0},
    },
    questions=[
        Question(
            Text(
                "The motor has a holding torque of {holding_nmm} at {current_a}. One rotation moves"
                " the belt by `40 mm`. Which force is the most that it can pull with, slowly?",
                "Il motore ha una coppia di tenuta di {holding_nmm} a {current_a}. Un giro muove la"
                " cinghia di `40 mm`. Qual è la forza massima con cui può tirare, piano?",
            ),
            "pull_out_n",
            given={"current_a": 1.5},
            mistakes=[
                Mistake(
                    lambda v: v["holding_nmm"] / TRAVEL_MM,
                    Text(
                        "You divided by the circumference. The lever is the radius: divide that by"
                        " `2·π` first.",
                        "Hai diviso per la circonferenza. Il braccio è il raggio: prima dividi per"
                        " `2·π`.",
                    ),
                ),
                Mistake(
                    lambda v: v["pull_out_n"] / 2,
                    Text(
                        "You divided by the diameter. The lever is the radius.",
                        "Hai diviso per il diametro. Il braccio è il raggio.",
                    ),
                ),
            ],
            why=Text(
                "`F = T / r`, and the radius is `40 mm / (2·π)`.",
                "`F = T / r`, e il raggio è `40 mm / (2·π)`.",
            ),
            hint=Text(
                "Torque is force times lever. How long is the lever of this pulley?",
                "La coppia è forza per braccio. Quanto è lungo il braccio di questa puleggia?",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "The friction is {drag_n}, the largest force {pull_out_n}. Which load angle has the"
                " motor at constant speed?",
                "L'attrito è {drag_n}, la forza massima {pull_out_n}. Quale angolo di carico ha il"
                " motore a velocità costante?",
            ),
            "load_deg",
            given={"current_a": 0.7, "drag_n": 10.0},
            mistakes=[
                Mistake(
                    lambda v: 90 * v["drag_n"] / v["pull_out_n"],
                    Text(
                        "The torque does not grow evenly with the angle. It is a sine.",
                        "La coppia non cresce in modo uniforme con l'angolo. È un seno.",
                    ),
                ),
                Mistake(
                    lambda v: v["load_deg"] / 50,
                    Text(
                        "That is the angle of the shaft. The load angle is that of the currents.",
                        "Questo è l'angolo dell'albero; serve quello delle correnti.",
                    ),
                ),
            ],
            why=Text(
                "The sine of the angle is friction divided by the largest force. The lag is"
                " {lag_mm}.",
                "Il seno dell'angolo è attrito diviso forza massima. Il ritardo è {lag_mm}.",
            ),
            hint=Text(
                "Which sine has the part of the force that is used?",
                "Quale seno corrisponde alla parte di forza usata?",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "After a collision everything is shifted by {shift_mm}. Two hundred full steps are"
                " one rotation, and that is `40 mm`. How many full steps were lost?",
                "Dopo un urto tutto è spostato di {shift_mm}. Duecento passi interi sono un giro,"
                " cioè `40 mm`. Quanti passi interi sono andati persi?",
            ),
            "lost_steps",
            given={"obstacle_n": 30.0},
            mistakes=[
                Mistake(
                    lambda v: v["lost_steps"] / 4,
                    Text(
                        "That is the number of teeth that slipped. Each is four full steps.",
                        "Questo è il numero di denti saltati. Ognuno vale quattro passi interi.",
                    ),
                ),
                Mistake(
                    lambda v: v["lost_steps"] * 16,
                    Text(
                        "These are microsteps. The question is about full steps.",
                        "Questi sono micropassi. La domanda riguarda i passi interi.",
                    ),
                ),
            ],
            why=Text(
                "A lost position is always a multiple of four full steps: the rotor rests only"
                " where a tooth agrees with the field.",
                "La posizione persa è sempre un multiplo di quattro passi interi: il rotore si"
                " ferma solo dove un dente coincide con il campo.",
            ),
            hint=Text(
                "How long is one full step at the belt?",
                "Quanto è lungo un passo intero alla cinghia?",
            ),
        ),
    ],
    source=Source("src/passo/learn/stepper_model.py", "Drive.pull_out_nm"),
    printer=OwnPrinter(
        Text(
            "Compare the position before and after: home the axis again, and see whether M114"
            " agrees with the endstop. Then lower the acceleration, or raise the current.",
            "Confronta la posizione prima e dopo: rifai l'homing dell'asse, e guarda se M114"
            " concorda con il finecorsa. Poi abbassa l'accelerazione, o alza la corrente.",
        ),
        command="G28",
    ),
    links=[Link(Text("Drivers", "Driver"), document="docs/how-to/set-up-drivers.md")],
)
