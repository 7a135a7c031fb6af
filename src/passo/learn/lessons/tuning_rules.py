"""Automatic tuning: five rules for one oscillation."""

from __future__ import annotations

from passo import _core
from passo.heat.rules import RULES
from passo.learn.bilingual import Text, short_figure
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.heated import heated
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table

_TARGET_C = 200.0
_SECONDS = 400.0
_FROM_S = 60.0


def _compute(ku: float, tu_s: float, rule: float) -> Outcome:
    rows: list[list[str]] = []
    lines: list[Line] = []
    over_c = settled_s = 0.0
    for number, known in enumerate(RULES):
        gains = known.gains(ku, tu_s)
        run = heated(_core.PidControl(gains.kp, gains.ki, gains.kd), _TARGET_C, _SECONDS)
        over = max(0.0, run.highest_c - _TARGET_C)
        settled = run.settled_s(_TARGET_C, 1.0)
        figures = [gains.kp, gains.ki, gains.kd, over, settled]
        rows.append([f"R{number} {known.name}", *(short_figure(figure, 2) for figure in figures)])
        late = run.after(_FROM_S)
        lines.append(Line(f"R{number}", late.times_s[::3], late.celsius[::3], number))
        if number == int(rule):
            over_c, settled_s = over, settled
    chosen = RULES[int(rule)].gains(ku, tu_s)
    return Outcome(
        numbers=[
            Number("kp", Text("Kp of the rule", "Kp della regola"), chosen.kp),
            Number("ki", Text("Ki of the rule", "Ki della regola"), chosen.ki, "", 3),
            Number("kd", Text("Kd of the rule", "Kd della regola"), chosen.kd),
            Number("over_c", Text("Its overshoot", "La sua sovraelongazione"), over_c, "°C"),
            Number(
                "settled_s",
                Text("Time until it stays within a degree", "Tempo finché resta entro un grado"),
                settled_s,
                "s",
                0,
            ),
        ],
        graphs=[
            Graph(
                Text("Five rules, one hotend", "Cinque regole, un hotend"),
                Text("time, s", "tempo, s"),
                "°C",
                lines,
                values=(_TARGET_C,),
            )
        ],
        tables=[
            Table(
                Text("The rules of M303 R", "Le regole di M303 R"),
                [
                    Text("rule", "regola"),
                    "Kp",
                    "Ki",
                    "Kd",
                    Text("overshoot, °C", "sovraelongazione, °C"),
                    Text("settled, s", "stabile, s"),
                ],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "tuning-rules",
    Text("Gains from an oscillation", "Guadagni da un'oscillazione"),
    Text(
        "A relay makes the hotend swing. Its period and its ultimate gain give the gains.",
        "Un relè fa oscillare l'hotend. Il periodo e il guadagno critico danno i guadagni.",
    ),
    [
        Parameter("ku", Text("Ultimate gain Ku", "Guadagno critico Ku"), 80.0, 10.0, 200.0, 5.0),
        Parameter("tu_s", Text("Period Tu", "Periodo Tu"), 24.0, 5.0, 60.0, 1.0, unit="s"),
        Parameter(
            "rule",
            Text("Rule", "Regola"),
            0.0,
            choices=[Choice(float(i), Text(r.name, r.name)) for i, r in enumerate(RULES)],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="tuning-rules",
    chapter=Chapter.HEAT,
    place=60,
    rows=(15,),
    minutes=20,
    title=Text("Automatic tuning", "Taratura automatica"),
    goal=Text(
        "You compute PID gains from an oscillation, and choose a rule.",
        "Calcoli i guadagni del PID da un'oscillazione, e scegli una regola.",
    ),
    text=[
        Text(
            "M303 switches the heater fully on below the target and off above it. The hotend"
            " swings. From the height of the swing follows the ultimate gain `Ku`: with so much P"
            " alone it would swing forever. The period is `Tu`.",
            "M303 accende del tutto sotto il valore e spegne sopra. L'hotend oscilla."
            " Dall'ampiezza segue il guadagno critico `Ku`: con tanto P da solo oscillerebbe per"
            " sempre. Il periodo è `Tu`.",
        ),
        Text(
            "Ziegler and Nichols (`1942`) tried many plants and gave a rule: `Kp = 0.6·Ku`,"
            " `Ki = 1.2·Ku/Tu`, `Kd = 0.075·Ku·Tu`. With `Ku` = {ku} and `Tu` = {tu_s} that is"
            " {kp}, {ki} and {kd}.",
            "Ziegler e Nichols (`1942`) provarono molti impianti e diedero una regola:"
            " `Kp = 0.6·Ku`, `Ki = 1.2·Ku/Tu`, `Kd = 0.075·Ku·Tu`. Con `Ku` = {ku} e `Tu` = {tu_s}"
            " sono {kp}, {ki} e {kd}.",
        ),
        Text(
            "It reacts fast to disturbances. Softer rules react more slowly, and swing less on a"
            " heater whose sensor is far away. The table computes all five of `M303 R` for the"
            " same swing, and lets the same hotend heat with each.",
            "Reagisce in fretta ai disturbi. Regole più morbide reagiscono più piano, e oscillano"
            " meno con un sensore lontano. La tabella calcola tutte e cinque quelle di `M303 R`"
            " per la stessa oscillazione, e scalda lo stesso hotend con ognuna.",
        ),
    ],
    experiment=EXPERIMENT,
    questions=[
        Question(
            Text(
                "A relay tune finds `Ku` = {ku} and `Tu` = {tu_s}. Which `Ki` does the classic"
                " rule give?",
                "Una taratura a relè trova `Ku` = {ku} e `Tu` = {tu_s}. Quale `Ki` dà la regola"
                " classica?",
            ),
            "ki",
            given={"ku": 50.0, "tu_s": 40.0},
            mistakes=[
                Mistake(
                    lambda v: 1.2 * v["ku"],
                    Text("Divide by the period.", "Dividi per il periodo."),
                ),
                Mistake(
                    lambda v: 1.2 * v["ku"] * v["tu_s"],
                    Text(
                        "I works over time: a slow heater needs less of it. Divide by the period.",
                        "I agisce nel tempo: un riscaldatore lento ne vuole meno. Dividi per il"
                        " periodo.",
                    ),
                ),
            ],
            why=Text(
                "`1.2·Ku/Tu`. A slow heater has a long period, and gets little I.",
                "`1.2·Ku/Tu`. Un riscaldatore lento ha un periodo lungo, e riceve poca I.",
            ),
            hint=Text("The rule is in the text.", "La regola è nel testo."),
        ),
        Question(
            Text(
                "And the `Kd` of the classic rule, with `Ku` = {ku} and `Tu` = {tu_s}?",
                "E il `Kd` della regola classica, con `Ku` = {ku} e `Tu` = {tu_s}?",
            ),
            "kd",
            given={"ku": 40.0, "tu_s": 20.0},
            mistakes=[
                Mistake(
                    lambda v: 0.075 * v["ku"],
                    Text("Times the period, too.", "Anche per il periodo."),
                ),
                Mistake(
                    lambda v: 0.075 * v["ku"] / v["tu_s"],
                    Text(
                        "D looks at the speed of the rise: a slow heater needs more of it.",
                        "D guarda la velocità di salita: un riscaldatore lento ne vuole di più.",
                    ),
                ),
            ],
            why=Text("`0.075·Ku·Tu`.", "`0.075·Ku·Tu`."),
            hint=Text("The rule is in the text.", "La regola è nel testo."),
        ),
    ],
    source=Source("src/passo/heat/rules.py", "Rule"),
    printer=OwnPrinter(
        Text(
            "Tune your hotend with the page's task, or with M303 and a rule.",
            "Tara il tuo hotend con l'attività della pagina, o con M303 e una regola.",
        ),
        command="M303 E0 S200 R2",
        page="calibrate",
    ),
    links=[
        Link(
            Text("Tune a heater", "Tarare un riscaldatore"), document="docs/how-to/tune-a-heater.md"
        )
    ],
)
