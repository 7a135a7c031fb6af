"""Change one value of a machine file, and see what it changes, and what not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table
from passo.learn.planned import planned, shipped

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_LEG_MM = 40.0
_KEYS = {
    "acceleration": Text("`accel_mm_s2` of X and Y", "`accel_mm_s2` di X e Y"),
    "deviation": Text("`junction_deviation_mm`", "`junction_deviation_mm`"),
    "speed": Text("`speed_mm_s` of X and Y", "`speed_mm_s` di X e Y"),
    "steps": Text("`steps_per_mm` of X and Y", "`steps_per_mm` di X e Y"),
}
_FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)


def _changed(key: str, factor: float) -> MachineConfig:
    machine = shipped("i3")
    if key == "deviation":
        value = machine.limits.junction_deviation_mm * factor
        limits = machine.limits.model_copy(update={"junction_deviation_mm": value})
        return machine.model_copy(update={"limits": limits})
    if key == "steps":
        steppers = {
            name: stepper.model_copy(update={"steps_per_mm": stepper.steps_per_unit * factor})
            if name in "xy"
            else stepper
            for name, stepper in machine.steppers.items()
        }
        return machine.model_copy(update={"steppers": steppers})
    axes = {
        name: axis.model_copy(
            update={"accel_mm_s2": axis.accel_mm_s2 * factor}
            if key == "acceleration"
            else {"speed_mm_s": axis.speed_mm_s * factor}
        )
        if name in "xy"
        else axis
        for name, axis in machine.axes.items()
    }
    return machine.model_copy(update={"axes": axes})


def _square(machine: MachineConfig, speed_mm_s: float) -> tuple[float, float, float]:
    """Time of a square, its highest speed, and the speed in its corners."""
    lines = [f"G1 X{_LEG_MM} F{60 * speed_mm_s:.3f}", f"G1 Y{_LEG_MM}", "G1 X0", "G1 Y0"]
    moves, _ = planned("\n".join(lines) + "\n", machine)
    seconds = moves[-1].end_ticks / machine.board.clock_hz
    return seconds, max(move.cruise_speed for move in moves), moves[1].start_speed


def _compute(key: str, factor: float, speed_mm_s: float) -> Outcome:
    before_s, _, before_corner = _square(shipped("i3"), speed_mm_s)
    after_s, top, corner = _square(_changed(key, factor), speed_mm_s)
    scale = factor if key == "steps" else 1.0
    rows: list[list[Words]] = []
    for each, name in _KEYS.items():
        times = [_square(_changed(each, by), speed_mm_s)[0] for by in (0.5, 2.0)]
        rows.append([name, *(f"{100 * (t / before_s - 1):+.1f}" for t in times)])
    return Outcome(
        numbers=[
            Number("before_s", Text("Time before", "Tempo prima"), before_s, "s", decimals=3),
            Number("after_s", Text("Time after", "Tempo dopo"), after_s, "s", decimals=3),
            Number(
                "change_percent",
                Text("Change of the time", "Variazione del tempo"),
                100 * (after_s / before_s - 1),
                "%",
                decimals=1,
            ),
            Number("top_mm_s", Text("Highest speed", "Velocità massima"), top, "mm/s"),
            Number(
                "before_corner_mm_s",
                Text("Corner before", "Angolo prima"),
                before_corner,
                "mm/s",
            ),
            Number("corner_mm_s", Text("Corner after", "Angolo dopo"), corner, "mm/s"),
            Number(
                "side_mm",
                Text("Side of the printed square", "Lato del quadrato stampato"),
                _LEG_MM * scale,
                "mm",
            ),
        ],
        graphs=[
            Graph(
                Text("Time against the factor", "Tempo in funzione del fattore"),
                Text("factor", "fattore"),
                "s",
                [
                    Line(
                        Text("this value", "questo valore"),
                        _FACTORS,
                        [_square(_changed(key, by), speed_mm_s)[0] for by in _FACTORS],
                    )
                ],
                values=(),
            )
        ],
        tables=[
            Table(
                Text("Change of the time, %", "Variazione del tempo, %"),
                [
                    Text("value", "valore"),
                    Text("half of it", "la metà"),
                    Text("twice as much", "il doppio"),
                ],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "configuration-as-an-experiment",
    Text("One value of a machine file", "Un valore di un file macchina"),
    Text(
        "The planner drives a square of 40 mm on the machine `i3`, with one value multiplied.",
        "Il pianificatore percorre un quadrato di 40 mm sulla macchina `i3`, con un valore"
        " moltiplicato.",
    ),
    [
        Parameter(
            "key",
            Text("Value", "Valore"),
            "deviation",
            choices=[Choice(key, words) for key, words in _KEYS.items()],
        ),
        Parameter(
            "factor",
            Text("Factor", "Fattore"),
            4.0,
            choices=[Choice(each) for each in _FACTORS],
        ),
        Parameter(
            "speed_mm_s",
            Text("Feedrate", "Velocità richiesta"),
            100.0,
            low=20.0,
            high=300.0,
            step=10.0,
            unit="mm/s",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="configuration-as-an-experiment",
    chapter=Chapter.PRACTICE,
    place=10,
    rows=(32,),
    minutes=25,
    title=Text("Configuration as an experiment", "La configurazione come esperimento"),
    goal=Text(
        "You predict the effect of one value of a machine file before you change it.",
        "Prevedi l'effetto di un valore del file macchina prima di cambiarlo.",
    ),
    text=[
        Text(
            "A machine file has hundreds of values. Learn them one at a time: change one, predict"
            " what it changes, look. Here the planner drives a square of {side_mm} at"
            " {speed_mm_s}; unchanged it takes {before_s}.",
            "Un file macchina ha centinaia di valori. Imparali uno alla volta: cambiane uno,"
            " prevedi che cosa cambia, guarda. Qui il pianificatore percorre un quadrato di"
            " {side_mm} a {speed_mm_s}; senza modifiche impiega {before_s}.",
        ),
        Text(
            "The junction deviation says how far a corner may be cut. Its root is in the speed:"
            " {factor:n} times the deviation doubles the speed in the corner, from"
            " {before_corner_mm_s} to {corner_mm_s}. The square takes {change_percent} of time.",
            "La junction deviation dice quanto un angolo può essere tagliato. Nella velocità c'è la"
            " sua radice: {factor:n} volte la deviazione raddoppia la velocità nell'angolo, da"
            " {before_corner_mm_s} a {corner_mm_s}. Il tempo del quadrato varia di"
            " {change_percent}.",
        ),
        Text(
            "Four times the acceleration changes more: {fast.change_percent}. But not to a quarter:"
            " at {speed_mm_s} most of each side is driven at constant speed.",
            "Quattro volte l'accelerazione cambia di più: {fast.change_percent}. Ma non a un"
            " quarto: a {speed_mm_s} la maggior parte di ogni lato è a velocità costante.",
        ),
        Text(
            "Some values change nothing. The highest speed of the axes may be doubled: the file"
            " asks for {speed_mm_s} only, so the time changes by {speed.change_percent}. A limit"
            " acts only where nothing else is lower.",
            "Alcuni valori non cambiano nulla. Puoi raddoppiare la velocità massima degli assi: il"
            " file chiede solo {speed_mm_s}, quindi il tempo varia di {speed.change_percent}. Un"
            " limite agisce solo dove nient'altro è più basso.",
        ),
        Text(
            "And some values are facts about the machine, not wishes. Twice the steps per"
            " millimetre leave the time as it is, but the square becomes {steps.side_mm} wide.",
            "E alcuni valori sono fatti della macchina, non desideri. Il doppio dei passi al"
            " millimetro lascia il tempo com'è, ma il quadrato diventa largo {steps.side_mm}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "fast": {"key": "acceleration"},
        "speed": {"key": "speed", "factor": 2.0},
        "steps": {"key": "steps", "factor": 2.0},
    },
    questions=[
        Question(
            Text(
                "The corner is passed at {before_corner_mm_s}. You set the junction deviation to a"
                " quarter. Which speed has the corner then?",
                "L'angolo si passa a {before_corner_mm_s}. Porti la junction deviation a un quarto."
                " Quale velocità ha allora l'angolo?",
            ),
            "corner_mm_s",
            given={"factor": 0.25},
            mistakes=[
                Mistake(
                    lambda v: v["before_corner_mm_s"] / 4,
                    Text(
                        "The speed is in proportion to the root of the deviation.",
                        "La velocità è proporzionale alla radice della deviazione.",
                    ),
                ),
                Mistake(
                    lambda v: v["before_corner_mm_s"] * 2,
                    Text(
                        "A smaller deviation is a tighter arc: slower, not faster.",
                        "Una deviazione minore è un arco più stretto: più lento, non più veloce.",
                    ),
                ),
                Mistake(
                    lambda v: v["before_corner_mm_s"],
                    Text(
                        "No other limit binds this corner. It does change.",
                        "Nessun altro limite agisce in questo angolo. Cambia.",
                    ),
                ),
            ],
            why=Text(
                "`v = √(a · r)`, and r is in proportion to the deviation.",
                "`v = √(a · r)`, e r è proporzionale alla deviazione.",
            ),
            hint=Text(
                "How does the speed on an arc depend on its radius?",
                "Come dipende la velocità su un arco dal suo raggio?",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "The file asks for {speed_mm_s}. You double the highest speed of X and Y. By how"
                " many percent does the time change?",
                "Il file chiede {speed_mm_s}. Raddoppi la velocità massima di X e Y. Di quanti"
                " percento cambia il tempo?",
            ),
            "change_percent",
            given={"key": "speed", "factor": 2.0},
            mistakes=[
                Mistake(
                    lambda _: -50.0,
                    Text(
                        "The axes may go faster, but the file does not ask for it.",
                        "Gli assi possono andare più veloci, ma il file non lo chiede.",
                    ),
                ),
                Mistake(
                    lambda _: 100.0,
                    Text(
                        "A limit is not the speed itself. Which limit binds here?",
                        "Un limite non è la velocità stessa. Quale limite agisce qui?",
                    ),
                ),
            ],
            why=Text(
                "The feedrate of the file is lower than the limit before and after.",
                "La velocità del file è sotto il limite, prima e dopo.",
            ),
            hint=Text(
                "Compare the limit with the feedrate of the file.",
                "Confronta il limite con la velocità del file.",
            ),
        ),
        Question(
            Text(
                "You set the steps per millimetre of X and Y to half of the right value. How wide"
                " is a square of `40 mm`?",
                "Imposti i passi al millimetro di X e Y alla metà del giusto. Quanto è largo un"
                " quadrato di `40 mm`?",
            ),
            "side_mm",
            given={"key": "steps", "factor": 0.5},
            mistakes=[
                Mistake(
                    lambda _: 80.0,
                    Text(
                        "The board then sends fewer steps, and the machine needs as many as"
                        " before.",
                        "La scheda manda allora meno passi, e alla macchina ne servono come prima.",
                    ),
                ),
                Mistake(
                    lambda _: 40.0,
                    Text(
                        "The board counts with the file, the pulley with its teeth. They disagree"
                        " now.",
                        "La scheda conta con il file, la puleggia con i denti. Ora non concordano.",
                    ),
                ),
            ],
            why=Text(
                "Half the steps are half the way.",
                "Metà dei passi sono metà della strada.",
            ),
            hint=Text(
                "How many steps does the board send now, and how far do they move the belt?",
                "Quanti passi manda ora la scheda, e di quanto muovono la cinghia?",
            ),
        ),
    ],
    source=Source("src/passo/config/motion.py", "Limits"),
    printer=OwnPrinter(
        Text(
            "The machine page shows each value with its unit, its default and where it comes from."
            " Change one, and print the same small test before and after.",
            "La pagina della macchina mostra ogni valore con unità, valore predefinito e origine."
            " Cambiane uno, e stampa lo stesso piccolo test prima e dopo.",
        ),
        page="machine",
    ),
    links=[
        Link(Text("Planning", "Pianificazione"), document="docs/explanation/planning.md"),
        Link(
            Text("Compare settings", "Confronta impostazioni"),
            document="docs/how-to/compare-settings.md",
        ),
    ],
)
