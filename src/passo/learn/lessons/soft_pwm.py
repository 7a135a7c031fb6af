"""Power in portions: a timer interrupt that counts switches a heater."""

from __future__ import annotations

from math import floor

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, edges

_COUNTS = 256
_PERIODS = 3


def _compute(
    tick_hz: float, speed: float, duty_percent: float, power_w: float, capacity_j_k: float
) -> Outcome:
    levels = _COUNTS / 2**speed
    frequency_hz = tick_hz / levels
    period_s = 1 / frequency_hz
    share = floor(duty_percent / 100 * levels + 0.5) / levels
    ripple_c = power_w / capacity_j_k * share * (1 - share) * period_s
    times = [0.0]
    watts = [power_w if share > 0 else 0.0]
    wave_c = [-ripple_c / 2]
    for k in range(_PERIODS):
        times += [(k + share) * period_s, (k + 1) * period_s]
        watts += [0.0 if share < 1 else power_w, power_w if share > 0 else 0.0]
        wave_c += [ripple_c / 2, -ripple_c / 2]
    speeds = range(5)
    return Outcome(
        numbers=[
            Number("frequency_hz", Text("Frequency", "Frequenza"), frequency_hz, "Hz"),
            Number("period_ms", Text("Period", "Periodo"), 1000 * period_s, "ms", decimals=1),
            Number("levels", Text("Levels of power", "Livelli di potenza"), levels, decimals=0),
            Number("real_percent", Text("Real duty cycle", "Duty cycle reale"), 100 * share, "%"),
            Number("mean_w", Text("Mean power", "Potenza media"), power_w * share, "W", decimals=1),
            Number(
                "ripple_c",
                Text("Ripple of the temperature", "Ondulazione della temperatura"),
                ripple_c,
                "°C",
                decimals=3,
            ),
        ],
        graphs=[
            Graph(
                Text("Power over time", "Potenza nel tempo"),
                Text("time, s", "tempo, s"),
                "W",
                [
                    Line(Text("heater", "riscaldatore"), *edges(times, watts)),
                    Line(
                        Text("mean", "media"),
                        [0.0, times[-1]],
                        [power_w * share, power_w * share],
                        colour=1,
                        dashed=True,
                    ),
                ],
            ),
            Graph(
                Text("Temperature around its mean", "Temperatura attorno alla media"),
                Text("time, s", "tempo, s"),
                "°C",
                [Line(Text("heater block", "blocco riscaldatore"), times, wave_c)],
            ),
            Graph(
                Text("Ripple at each speed", "Ondulazione a ogni velocità"),
                Text("frequency, Hz", "frequenza, Hz"),
                "°C",
                [
                    Line(
                        Text("half power", "metà potenza"),
                        [tick_hz * 2**k / _COUNTS for k in speeds],
                        [power_w / capacity_j_k / 4 * _COUNTS / 2**k / tick_hz for k in speeds],
                    )
                ],
            ),
        ],
    )


EXPERIMENT = Experiment(
    "soft-pwm",
    Text("A heater that is switched by counting", "Un riscaldatore comandato contando"),
    Text(
        "A timer interrupt counts. The output is on while the count is below a level.",
        "Un interrupt a tempo conta. L'uscita è accesa finché il conteggio è sotto un livello.",
    ),
    [
        Parameter(
            "tick_hz",
            Text("Interrupts per second", "Interrupt al secondo"),
            3906.25,
            unit="Hz",
            choices=[Choice(976.5625), Choice(3906.25), Choice(7812.5)],
        ),
        Parameter(
            "speed",
            Text("Speed of the counter", "Velocità del contatore"),
            0.0,
            choices=[Choice(float(k)) for k in range(5)],
        ),
        Parameter(
            "duty_percent",
            Text("Requested duty cycle", "Duty cycle richiesto"),
            40.0,
            0,
            100,
            unit="%",
        ),
        Parameter("power_w", Text("Heater", "Riscaldatore"), 48.0, 10.0, 400.0, unit="W"),
        Parameter(
            "capacity_j_k",
            Text("Heat that warms it by one degree", "Calore che lo scalda di un grado"),
            12.0,
            low=1.0,
            high=1000.0,
            unit="J/°C",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="soft-pwm",
    chapter=Chapter.ELECTRICITY,
    place=70,
    rows=(19,),
    minutes=20,
    title=Text("Software PWM", "PWM software"),
    goal=Text(
        "You compute frequency, levels and ripple of an output that is switched by counting.",
        "Calcoli frequenza, livelli e ondulazione di un'uscita comandata contando.",
    ),
    text=[
        Text(
            "A pin can only be on or off. PWM switches it on for a part of each period, the duty"
            " cycle. A heater of {power_w} at {duty_percent} gives {mean_w} on average.",
            "Un pin può essere solo acceso o spento. Il PWM lo accende per una parte di ogni"
            " periodo, il duty cycle. Un riscaldatore da {power_w} al {duty_percent} dà in media"
            " {mean_w}.",
        ),
        Text(
            "Firmwares for AVR chips do this in a timer interrupt, {tick_hz:n} times per second. It"
            " counts to `256` and begins again: {frequency_hz}, a period of {period_ms}. This is"
            " software PWM; it works on any pin.",
            "I firmware per chip AVR lo fanno in un interrupt a tempo, {tick_hz:n} volte al"
            " secondo. Conta fino a `256` e ricomincia: {frequency_hz}, un periodo di"
            " {period_ms}. È il PWM software; funziona su qualsiasi pin.",
        ),
        Text(
            "Is that too slow? The block of a hotend stores {capacity_j_k:n} J in each degree, so"
            " it moves by only {ripple_c} within a period. A sensor does not even see that. A"
            " heater needs no fast PWM.",
            "È troppo lento? Il blocco di un hotend accumula {capacity_j_k:n} J per ogni grado,"
            " quindi si muove di soli {ripple_c} in un periodo. Un sensore nemmeno lo vede. Un"
            " riscaldatore non ha bisogno di un PWM veloce.",
        ),
        Text(
            "A fan does: it hums or stops at {frequency_hz}. The counter can go in larger steps."
            " At speed {fast.speed} it makes {fast.frequency_hz}, but only {fast.levels} levels are"
            " left: {fast.duty_percent} becomes {fast.real_percent}.",
            "Una ventola sì: a {frequency_hz} ronza o si ferma. Il contatore può andare a passi più"
            " grandi. A velocità {fast.speed} fa {fast.frequency_hz}, ma restano solo {fast.levels}"
            " livelli: {fast.duty_percent} diventa {fast.real_percent}.",
        ),
        Text(
            "Passo's firmware does not count. It gives its timer the clock of each edge, so the"
            " duty cycle stays fine at any frequency. Each edge costs one interrupt.",
            "Il firmware di Passo non conta. Dà al suo timer l'istante di ogni fronte, quindi il"
            " duty cycle resta fine a ogni frequenza. Ogni fronte costa un interrupt.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"fast": {"speed": 4.0}},
    questions=[
        Question(
            Text(
                "The interrupt runs at {tick_hz}, the counter at speed {speed}: each speed doubles"
                " its step. Which frequency has the output?",
                "L'interrupt va a {tick_hz}, il contatore a velocità {speed}: ogni velocità"
                " raddoppia il passo. Quale frequenza ha l'uscita?",
            ),
            "frequency_hz",
            given={"speed": 3.0},
            mistakes=[
                Mistake(
                    lambda v: v["tick_hz"] / 256,
                    Text(
                        "That is speed `0`. Here the counter reaches its end sooner.",
                        "Questa è la velocità `0`. Qui il contatore arriva prima alla fine.",
                    ),
                ),
                Mistake(
                    lambda v: v["tick_hz"] / 256 * v["speed"],
                    Text(
                        "Each speed doubles the step again: a power of two.",
                        "Ogni velocità raddoppia ancora il passo: una potenza di due.",
                    ),
                ),
                Mistake(
                    lambda v: v["tick_hz"] / 256 / 2 ** v["speed"],
                    Text(
                        "Larger steps make the period shorter, not longer.",
                        "Passi più grandi accorciano il periodo, non lo allungano.",
                    ),
                ),
            ],
            why=Text(
                "{levels} interrupts are one period.",
                "{levels} interrupt fanno un periodo.",
            ),
            hint=Text(
                "How many interrupts does the counter need for its `256` counts?",
                "Quanti interrupt servono al contatore per i suoi `256` conteggi?",
            ),
        ),
        Question(
            Text(
                "A fan gets {duty_percent} with {levels} levels, rounded to the nearest. Which duty"
                " cycle does it really get?",
                "Una ventola riceve il {duty_percent} con {levels} livelli, arrotondato al più"
                " vicino. Quale duty cycle riceve davvero?",
            ),
            "real_percent",
            given={"speed": 4.0, "duty_percent": 70.0},
            mistakes=[
                Mistake(
                    lambda v: v["duty_percent"],
                    Text(
                        "That level does not exist: the steps are a whole number of counts.",
                        "Quel livello non esiste: i passi sono un numero intero di conteggi.",
                    ),
                ),
                Mistake(
                    lambda v: (
                        100 * (floor(v["duty_percent"] * v["levels"] / 100) + 1) / v["levels"]
                    ),
                    Text(
                        "You rounded up. The level below is nearer.",
                        "Hai arrotondato in su. Il livello sotto è più vicino.",
                    ),
                ),
            ],
            why=Text(
                "The nearest whole count, divided by {levels}.",
                "Il conteggio intero più vicino, diviso {levels}.",
            ),
            hint=Text(
                "How many of the {levels} levels are {duty_percent}?",
                "Quanti dei {levels} livelli sono il {duty_percent}?",
            ),
            tolerance=0.005,
        ),
        Question(
            Text(
                "A heater of {power_w} has {capacity_j_k}, the period is {period_ms}, the duty"
                " cycle {real_percent}. By how much does the temperature move within a period?",
                "Un riscaldatore da {power_w} ha {capacity_j_k}, il periodo è {period_ms}, il duty"
                " cycle {real_percent}. Di quanto si muove la temperatura in un periodo?",
            ),
            "ripple_c",
            given={"tick_hz": 976.5625, "duty_percent": 50.0},
            mistakes=[
                Mistake(
                    lambda v: v["power_w"] / v["capacity_j_k"] * v["period_ms"] / 1000,
                    Text(
                        "So much it would move with full power for a whole period and no loss.",
                        "Di tanto si muoverebbe a piena potenza per un periodo intero, senza"
                        " perdite.",
                    ),
                ),
                Mistake(
                    lambda v: v["power_w"] / v["capacity_j_k"] * v["period_ms"] / 2000,
                    Text(
                        "While it is on, the block also loses the mean power. Only the difference"
                        " warms it.",
                        "Mentre è acceso, il blocco perde anche la potenza media. Lo scalda solo la"
                        " differenza.",
                    ),
                ),
            ],
            why=Text(
                "While on, `P − mean` warms it: `P · (1 − D)` for the time `D · T`.",
                "Da acceso lo scalda `P − media`: `P · (1 − D)` per il tempo `D · T`.",
            ),
            hint=Text(
                "How much power is left to warm it while it is on, and for how long?",
                "Quanta potenza resta per scaldarlo mentre è acceso, e per quanto tempo?",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("firmware/core/outputs.c", "command_set_digital_out_pwm_cycle"),
    printer=OwnPrinter(
        Text(
            "`pwm_hz` in the machine file is the frequency of an output. Slow down a fan with M106"
            " and listen for the frequency at which it hums least.",
            "`pwm_hz` nel file macchina è la frequenza di un'uscita. Rallenta una ventola con"
            " M106 e ascolta a quale frequenza ronza meno.",
        ),
        command="M106 S80",
    ),
    links=[
        Link(
            Text("Write a machine file", "Scrivi un file macchina"),
            document="docs/how-to/write-a-machine-file.md",
        )
    ],
)
