"""Switching a heater on and off, against PID."""

from __future__ import annotations

from itertools import pairwise

from passo import _core
from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.heated import AMBIENT_C, RISE_C, SENSOR_LAG_S, TIME_CONSTANT_S, heated
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_SECONDS = 500.0
_FROM_S = 250.0  # when it is hot
_EVERY_S = 0.5
_KP, _KI, _KD = 13.0, 0.4, 80.0


def _compute(hysteresis_c: float, target_c: float) -> Outcome:
    switched = heated(_core.OnOffControl(hysteresis_c), target_c, _SECONDS, every_s=_EVERY_S)
    steady = heated(_core.PidControl(_KP, _KI, _KD), target_c, _SECONDS, every_s=_EVERY_S)
    hot, calm = switched.after(_FROM_S), steady.after(_FROM_S)
    on = [power > 0 for power in hot.power]
    times = sum(later and not before for before, later in pairwise(on))
    heats = RISE_C / TIME_CONSTANT_S - (target_c - AMBIENT_C) / TIME_CONSTANT_S
    return Outcome(
        numbers=[
            Number(
                "swing_c",
                Text("Swing of on-off", "Oscillazione on-off"),
                max(hot.celsius) - min(hot.celsius),
                "°C",
            ),
            Number(
                "calm_c",
                Text("Swing of PID", "Oscillazione del PID"),
                max(calm.celsius) - min(calm.celsius),
                "°C",
            ),
            Number(
                "times",
                Text("Switchings on in a minute", "Accensioni al minuto"),
                60 * times / (_SECONDS - _FROM_S),
                decimals=1,
            ),
            Number(
                "rise_c_s",
                Text("Rise at the target, heater on", "Salita al valore, acceso"),
                heats,
                "°C/s",
            ),
            Number(
                "late_c",
                Text("Rise while the sensor is late", "Salita durante il ritardo del sensore"),
                heats * SENSOR_LAG_S,
                "°C",
            ),
            Number("lag_s", Text("Delay of the sensor", "Ritardo del sensore"), SENSOR_LAG_S, "s"),
        ],
        graphs=[
            Graph(
                Text("Temperature", "Temperatura"),
                Text("time, s", "tempo, s"),
                "°C",
                [
                    Line("on-off", hot.times_s[::2], hot.celsius[::2]),
                    Line("PID", calm.times_s[::2], calm.celsius[::2], 1),
                ],
                values=(target_c,),
            ),
            Graph(
                Text("Power", "Potenza"),
                Text("time, s", "tempo, s"),
                "%",
                [
                    Line("on-off", hot.times_s, [100 * power for power in hot.power]),
                    Line("PID", calm.times_s[::2], [100 * p for p in calm.power[::2]], 1),
                ],
            ),
        ],
    )


EXPERIMENT = Experiment(
    "on-off-against-pid",
    Text("The same hotend, two controllers", "Lo stesso hotend, due regolatori"),
    Text(
        "A hot hotend, held by switching and by PID.",
        "Un hotend caldo, mantenuto con accensioni e con PID.",
    ),
    [
        Parameter("hysteresis_c", Text("Hysteresis", "Isteresi"), 1.0, 0.5, 10.0, 0.5, unit="°C"),
        Parameter(
            "target_c", Text("Target", "Valore richiesto"), 200.0, 100.0, 250.0, 5.0, unit="°C"
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="on-off-against-pid",
    chapter=Chapter.HEAT,
    place=40,
    rows=(14,),
    minutes=20,
    title=Text("On-off against PID", "On-off contro PID"),
    goal=Text(
        "You know when a thermostat is enough, and what it costs.",
        "Sai quando basta un termostato, e che cosa costa.",
    ),
    text=[
        Text(
            "The simplest controller: below `target − hysteresis` it switches on, above"
            " `target + hysteresis` off. The hysteresis keeps it from switching all the time; a"
            " relay survives only so many switchings.",
            "Il regolatore più semplice: sotto `valore − isteresi` accende, sopra"
            " `valore + isteresi` spegne. L'isteresi evita che scatti di continuo; un relè"
            " sopporta solo un certo numero di scatti.",
        ),
        Text(
            "With a hysteresis of {hysteresis_c} one expects a swing of twice that. It is"
            " {swing_c}: the sensor is late by {lag_s}, and in that time the hotend rises by"
            " {late_c} more.",
            "Con un'isteresi di {hysteresis_c} ci si aspetta un'oscillazione doppia. È {swing_c}:"
            " il sensore è in ritardo di {lag_s}, e intanto l'hotend sale di altri {late_c}.",
        ),
        Text(
            "PID gives a part of the power, and holds the same hotend within {calm_c}. A part of"
            " the power means switching many times a second: a MOSFET can, a relay cannot.",
            "Il PID dà una parte della potenza, e mantiene lo stesso hotend entro {calm_c}. Una"
            " parte della potenza significa scattare molte volte al secondo: un MOSFET può, un"
            " relè no.",
        ),
        Text(
            "A bed is heavy and slow, so on-off is often good enough for it. With a hysteresis of"
            " {wide.hysteresis_c} this hotend switches {wide.times:n} times a minute in place of"
            " {times:n}, and swings by {wide.swing_c}.",
            "Un piano è pesante e lento, e spesso gli basta on-off. Con un'isteresi di"
            " {wide.hysteresis_c} questo hotend scatta {wide.times:n} volte al minuto invece di"
            " {times:n}, e oscilla di {wide.swing_c}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"wide": {"hysteresis_c": 5.0}},
    questions=[
        Question(
            Text(
                "Full power would bring this hotend `400 °C` above a room of `25 °C`, with a time"
                " constant of `160 s`. How fast does it rise at {target_c} with the heater on, in"
                " degrees per second?",
                "A piena potenza questo hotend salirebbe di `400 °C` sopra i `25 °C` dell'ambiente,"
                " con costante di tempo `160 s`. A quale velocità sale a {target_c} acceso, in"
                " gradi al secondo?",
            ),
            "rise_c_s",
            given={"target_c": 105.0},
            mistakes=[
                Mistake(
                    lambda v: 400 / 160,
                    Text(
                        "So fast it rises when it is cold. Now it also loses heat.",
                        "Così sale quando è freddo. Ora perde anche calore.",
                    ),
                ),
                Mistake(
                    lambda v: (400 - v["target_c"]) / 160,
                    Text(
                        "It loses heat to the room: count from `25 °C`.",
                        "Perde calore verso l'ambiente: conta da `25 °C`.",
                    ),
                ),
            ],
            why=Text(
                "What is left to the final temperature, divided by the time constant.",
                "Ciò che manca alla temperatura finale, diviso per la costante di tempo.",
            ),
            hint=Text(
                "To which temperature would it rise, and how far away is that?",
                "Fino a quale temperatura salirebbe, e quanto manca?",
            ),
        ),
        Question(
            Text(
                "At {target_c} it rises by {rise_c_s} with the heater on. How far does it rise"
                " while the sensor is late by {lag_s}?",
                "A {target_c} sale di {rise_c_s} acceso. Di quanto sale durante il ritardo del"
                " sensore di {lag_s}?",
            ),
            "late_c",
            given={"target_c": 225.0},
            mistakes=[
                Mistake(
                    lambda v: v["rise_c_s"],
                    Text("That is one second.", "Questo è un secondo."),
                ),
                Mistake(
                    lambda v: v["rise_c_s"] / v["lag_s"],
                    Text("Multiply: speed by time.", "Moltiplica: velocità per tempo."),
                ),
            ],
            why=Text(
                "Rise per second, times the delay. No hysteresis can be smaller than that.",
                "Salita al secondo, per il ritardo. Nessuna isteresi può fare di meglio.",
            ),
            hint=Text("Distance is speed by time.", "Lo spazio è velocità per tempo."),
        ),
    ],
    source=Source("core/heat/on_off.hpp", "OnOff"),
    printer=OwnPrinter(
        Text(
            '`control = { kind = "bang-bang" }` in the table of the bed switches it so.',
            '`control = { kind = "bang-bang" }` nella tabella del piano lo regola così.',
        ),
        page="machine",
    ),
    links=[Link(Text("Heat", "Calore"), document="docs/explanation/heat.md")],
)
