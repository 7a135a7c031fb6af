"""PID by hand, on a simulated hotend: what each of the three terms is for."""

from __future__ import annotations

from passo import _core
from passo.heat.rules import FULL_POWER
from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.heated import AMBIENT_C, RISE_C, SENSOR_LAG_S, TIME_CONSTANT_S, Heating, heated
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_SECONDS = 600.0
_WITHIN_C = 1.0
_EVERY_S = 0.5


def _textbook(kp: float, ki: float, kd: float, target_c: float) -> Heating:
    """PID as books write it: the sum of the distance has no bound."""
    body = sensor = before = AMBIENT_C
    total = 0.0
    times, celsius, powers = [0.0], [AMBIENT_C], [0.0]
    while times[-1] < _SECONDS:
        error = target_c - sensor
        total += ki * error * _EVERY_S
        asked = kp * error + total - kd * (sensor - before) / _EVERY_S
        power = min(1.0, max(0.0, asked / FULL_POWER))
        before = sensor
        body += (RISE_C * power - (body - AMBIENT_C)) / TIME_CONSTANT_S * _EVERY_S
        sensor += (body - sensor) / SENSOR_LAG_S * _EVERY_S
        times.append(times[-1] + _EVERY_S)
        celsius.append(sensor)
        powers.append(power)
    return Heating(times, celsius, powers)


def _compute(kp: float, ki: float, kd: float, target_c: float) -> Outcome:
    run = _textbook(kp, ki, kd, target_c)
    passo = heated(_core.PidControl(kp, ki, kd), target_c, _SECONDS)
    last = run.celsius[-1]
    return Outcome(
        numbers=[
            Number("last_c", Text("Temperature at the end", "Temperatura alla fine"), last, "°C"),
            Number(
                "steady_c",
                Text("Steady error by the formula", "Errore statico secondo la formula"),
                0.0 if ki else (target_c - AMBIENT_C) / (1 + RISE_C * kp / FULL_POWER),
                "°C",
            ),
            Number(
                "over_c",
                Text("Overshoot", "Sovraelongazione"),
                max(0.0, run.highest_c - target_c),
                "°C",
            ),
            Number(
                "passo_over_c",
                Text("Overshoot of Passo's PID", "Sovraelongazione del PID di Passo"),
                max(0.0, passo.highest_c - target_c),
                "°C",
            ),
            Number(
                "settled_s",
                Text("Time until it stays within a degree", "Tempo finché resta entro un grado"),
                run.settled_s(target_c, _WITHIN_C),
                "s",
                0,
            ),
            Number(
                "held_percent",
                Text("Power that holds the target", "Potenza che mantiene il valore"),
                100 * (target_c - AMBIENT_C) / RISE_C,
                "%",
            ),
            Number("rise", Text("Rise at full power", "Salita a piena potenza"), RISE_C, "°C", 0),
            Number("room", Text("Room", "Ambiente"), AMBIENT_C, "°C", 0),
        ],
        graphs=[
            Graph(
                Text("Temperature", "Temperatura"),
                Text("time, s", "tempo, s"),
                "°C",
                [
                    Line(Text("hotend", "hotend"), run.times_s[::5], run.celsius[::5]),
                    Line(
                        Text("target", "valore richiesto"), [0.0, _SECONDS], [target_c] * 2, 1, True
                    ),
                ],
            ),
            Graph(
                Text("Power", "Potenza"),
                Text("time, s", "tempo, s"),
                "%",
                [
                    Line(
                        Text("heater", "riscaldatore"),
                        run.times_s[::5],
                        [100 * power for power in run.power[::5]],
                        2,
                    )
                ],
            ),
        ],
    )


EXPERIMENT = Experiment(
    "pid-by-hand",
    Text("A hotend with your gains", "Un hotend con i tuoi guadagni"),
    Text(
        "A simulated hotend heats from the room's temperature. The textbook's PID controls"
        " it. Compare it with Passo's own PID.",
        "Un hotend simulato si scalda dalla temperatura ambiente. Lo regola il PID"
        " dei libri. Confrontalo con quello di Passo.",
    ),
    [
        Parameter("kp", Text("Kp: by distance", "Kp: per distanza"), 10.0, 1.0, 300.0, 1.0),
        Parameter(
            "ki",
            Text("Ki: by distance over time", "Ki: per distanza nel tempo"),
            0.0,
            0.0,
            4.0,
            0.05,
        ),
        Parameter(
            "kd",
            Text("Kd: by speed of the rise", "Kd: per velocità di salita"),
            0.0,
            0.0,
            300.0,
            10.0,
        ),
        Parameter(
            "target_c", Text("Target", "Valore richiesto"), 200.0, 100.0, 250.0, 5.0, unit="°C"
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="pid-by-hand",
    chapter=Chapter.HEAT,
    place=50,
    rows=(13,),
    minutes=35,
    title=Text("PID by hand", "PID a mano"),
    goal=Text(
        "You set three gains by hand, and know which of them mends what.",
        "Imposti a mano tre guadagni, e sai quale corregge che cosa.",
    ),
    text=[
        Text(
            "P alone gives power in proportion to the distance from the target. But the target"
            " needs power to be held, here {held_percent}. With P alone there is power only while"
            " there is distance: the hotend stays below, at {last_c}.",
            "P da solo dà potenza in proporzione alla distanza dal valore richiesto. Ma mantenerlo"
            " richiede potenza, qui {held_percent}. Con solo P c'è potenza finché c'è distanza:"
            " l'hotend resta sotto, a {last_c}.",
        ),
        Text(
            "This steady error is `(target − room) / (1 + rise·Kp / 255)` = {steady_c}. More P"
            " makes it smaller: with `Kp` = {strong.kp} it is {strong.steady_c}, and never zero."
            " But the sensor is late, so strong P goes beyond the target, here by"
            " {strong.over_c}, and swings.",
            "Questo errore statico è `(valore − ambiente) / (1 + salita·Kp / 255)` = {steady_c}."
            " Più P lo riduce: con `Kp` = {strong.kp} è {strong.steady_c}, e mai zero. Ma il"
            " sensore è in ritardo, così un P forte supera il valore, qui di {strong.over_c}, e"
            " oscilla.",
        ),
        Text(
            "D takes power away the faster the temperature rises: it brakes before the target."
            " With `Kd` = {damped.kd} on top the same P overshoots by {damped.over_c}. Too much D"
            " makes the noise of the sensor into jumps of power.",
            "D toglie potenza quanto più in fretta sale la temperatura: frena prima del valore."
            " Con `Kd` = {damped.kd} in più lo stesso P supera il valore di {damped.over_c}. Troppo"
            " D trasforma il rumore del sensore in salti di potenza.",
        ),
        Text(
            "I sums up the distance over time, and adds power until none is left: it removes the"
            " steady error. But it also sums while the hotend heats up, when full power cannot be"
            " exceeded anyway. This windup must be undone by time above the target: `Ki` ="
            " {windup.ki} overshoots by {windup.over_c}! So good controllers stop the sum while"
            " it cannot help. Passo's PID with the same gains overshoots by"
            " {windup.passo_over_c}.",
            "I somma la distanza nel tempo, e aggiunge potenza finché non ne resta: elimina"
            " l'errore statico. Ma somma anche durante il riscaldamento, quando la piena potenza"
            " non si può comunque superare. Questo windup si smaltisce solo sopra il valore: `Ki` ="
            " {windup.ki} lo supera di {windup.over_c}! Perciò un buon regolatore ferma la somma"
            " quando non può servire. Il PID di Passo con gli stessi guadagni lo supera di"
            " {windup.passo_over_c}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "strong": {"kp": 200.0},
        "damped": {"kp": 200.0, "kd": 200.0},
        "windup": {"kp": 20.0, "ki": 0.1},
    },
    questions=[
        Question(
            Text(
                "The heater at full power would bring the hotend {rise:n} degrees above the room,"
                " which has {room}. P alone, `Kp` = {kp}, target {target_c}. How large is the"
                " steady error?",
                "A piena potenza l'hotend salirebbe di {rise:n} gradi sopra l'ambiente, che è a"
                " {room}. Solo P, `Kp` = {kp}, valore {target_c}. Quanto è l'errore statico?",
            ),
            "steady_c",
            given={"kp": 20.0, "target_c": 225.0},
            mistakes=[
                Mistake(
                    lambda v: v["target_c"] / (1 + v["rise"] * v["kp"] / 255),
                    Text(
                        "The room is warm, too: only the difference must be heated.",
                        "Anche l'ambiente è caldo: si scalda solo la differenza.",
                    ),
                ),
                Mistake(
                    lambda v: (v["target_c"] - v["room"]) / (v["rise"] * v["kp"] / 255),
                    Text(
                        "Almost. The error itself lowers what must be held: `1 +` in the divisor.",
                        "Quasi. L'errore stesso riduce ciò che va mantenuto: `1 +` nel divisore.",
                    ),
                ),
            ],
            why=Text(
                "The power is `Kp·error / 255`, and holds `rise·power` above the room.",
                "La potenza è `Kp·errore / 255`, e mantiene `salita·potenza` sopra l'ambiente.",
            ),
            hint=Text(
                "Write both: power from the error, and temperature from the power.",
                "Scrivi entrambe: potenza dall'errore, temperatura dalla potenza.",
            ),
        ),
        Question(
            Text(
                "Which power, in percent, holds {target_c}, whatever the gains are?",
                "Quale potenza, in percento, mantiene {target_c}, quali che siano i guadagni?",
            ),
            "held_percent",
            given={"target_c": 245.0},
            mistakes=[
                Mistake(
                    lambda v: 100 * v["target_c"] / v["rise"],
                    Text(
                        "Count from the room's temperature, not from zero.",
                        "Conta dalla temperatura ambiente, non da zero.",
                    ),
                ),
                Mistake(
                    lambda v: 100.0,
                    Text(
                        "Full power would make it far too hot.",
                        "A piena potenza diventerebbe troppo caldo.",
                    ),
                ),
            ],
            why=Text(
                "It loses in proportion to the difference to the room, and full power holds"
                " {rise:n} degrees.",
                "Perde in proporzione alla differenza con l'ambiente, e la piena potenza mantiene"
                " {rise:n} gradi.",
            ),
            hint=Text(
                "Which part of the rise at full power is it?",
                "Quale parte della salita a piena potenza è?",
            ),
        ),
    ],
    source=Source("core/heat/pid.hpp", "Pid"),
    printer=OwnPrinter(
        Text(
            "M301 shows the gains of your hotend, M303 measures them.",
            "M301 mostra i guadagni del tuo hotend, M303 li misura.",
        ),
        command="M301",
        page="calibrate",
    ),
    links=[Link(Text("Heat", "Calore"), document="docs/explanation/heat.md")],
)
