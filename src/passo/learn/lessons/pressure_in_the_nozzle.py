"""Pressure in the nozzle: filament comes late, and pressure advance sends it early."""

from __future__ import annotations

from itertools import pairwise
from math import exp, pi

from passo.learn.bilingual import Text
from passo.learn.calculators.line_and_flow import line_area_mm2
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_WIDTH_MM, _HEIGHT_MM, _FILAMENT_MM = 0.45, 0.2, 1.75  # of the line, and of its filament
_FILAMENT_MM2 = pi / 4 * _FILAMENT_MM**2
_FILAMENT_PER_MM = line_area_mm2(_WIDTH_MM, _HEIGHT_MM) / _FILAMENT_MM2
_TAU_S = 0.05  # of the simulated nozzle: its flow follows the pushed filament with this delay
_POINTS = 150


def _compute(advance_s: float, speed_mm_s: float, acceleration_mm_s2: float) -> Outcome:
    ramp_s = speed_mm_s / acceleration_mm_s2
    end_s = 2 * ramp_s + 0.4
    step_s = end_s / _POINTS
    e_speed = speed_mm_s * _FILAMENT_PER_MM
    e_accel = acceleration_mm_s2 * _FILAMENT_PER_MM

    def wanted(t: float) -> float:
        return _FILAMENT_PER_MM * max(
            0.0, min(acceleration_mm_s2 * t, speed_mm_s, (end_s - t) * acceleration_mm_s2)
        )

    def pushed(t: float) -> float:
        slope = e_accel if t < ramp_s else -e_accel if t > end_s - ramp_s else 0.0
        return wanted(t) + advance_s * slope

    times = [step_s * i for i in range(_POINTS + 1)]
    flow, lag_mm = [0.0], 0.0
    for before, after in pairwise(times):
        # The exact answer of a first-order system to a constant push over one interval.
        drive = pushed((before + after) / 2)
        flow.append(drive + (flow[-1] - drive) * exp(-step_s / _TAU_S))
        lag = (wanted(before) + wanted(after) - flow[-2] - flow[-1]) / 2
        lag_mm += abs(lag) * step_s
    return Outcome(
        numbers=[
            Number(
                "extra_mm",
                Text("Filament sent early", "Filamento in anticipo"),
                advance_s * e_speed,
                "mm",
                3,
            ),
            Number(
                "e_mm_s", Text("Speed of the filament", "Velocità del filamento"), e_speed, "mm/s"
            ),
            Number(
                "push_mm_s",
                Text("Highest speed while it speeds up", "Velocità massima in accelerazione"),
                e_speed + advance_s * e_accel,
                "mm/s",
            ),
            Number(
                "lag_mm3",
                Text("Filament in the wrong place", "Filamento nel posto sbagliato"),
                lag_mm * _FILAMENT_MM2,
                "mm³",
                3,
            ),
            Number("tau_s", Text("Delay of this nozzle", "Ritardo di questo ugello"), _TAU_S, "s"),
            Number(
                "per_mm",
                Text("Filament of a millimetre of path", "Filamento per millimetro di percorso"),
                _FILAMENT_PER_MM,
                "mm",
                4,
            ),
        ],
        graphs=[
            Graph(
                Text("Filament per second", "Filamento al secondo"),
                Text("time, s", "tempo, s"),
                "mm/s",
                [
                    Line(
                        Text("the line needs", "serve alla linea"),
                        times,
                        [wanted(t) for t in times],
                        1,
                        True,
                    ),
                    Line(
                        Text("the extruder pushes", "spinge l'estrusore"),
                        times,
                        [pushed(t) for t in times],
                        2,
                    ),
                    Line(Text("the nozzle gives", "esce dall'ugello"), times, flow),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "pressure-in-the-nozzle",
    Text("One line with pressure advance", "Una linea con pressure advance"),
    Text(
        "A line is printed from rest to rest. The simulated nozzle gives filament with a delay.",
        "Una linea si stampa da fermo a fermo. L'ugello simulato dà filamento in ritardo.",
    ),
    [
        Parameter(
            "advance_s",
            Text("Pressure advance", "Pressure advance"),
            0.0,
            0.0,
            0.1,
            0.005,
            unit="s",
        ),
        Parameter("speed_mm_s", Text("Speed", "Velocità"), 100.0, 20.0, 200.0, 10.0, unit="mm/s"),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            2000.0,
            500.0,
            5000.0,
            500.0,
            unit="mm/s²",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="pressure-in-the-nozzle",
    chapter=Chapter.MOTION,
    place=120,
    rows=(25,),
    minutes=25,
    title=Text("Pressure in the nozzle", "Pressione nell'ugello"),
    goal=Text(
        "You explain thin beginnings and thick ends of lines, and compute the cure.",
        "Spieghi gli inizi sottili e le fini grosse delle linee, e calcoli il rimedio.",
    ),
    text=[
        Text(
            "Molten plastic leaves the nozzle because filament presses on it. Between gears and"
            " nozzle the filament gives way like a spring. So the flow follows the push late: here"
            " by {tau_s}.",
            "La plastica fusa esce dall'ugello perché il filamento la preme. Tra ingranaggi e"
            " ugello il filamento cede come una molla. Così il flusso segue la spinta in ritardo:"
            " qui di {tau_s}.",
        ),
        Text(
            "At the beginning of a line too little comes out, at its end too much: {lag_mm3} in the"
            " wrong place. Corners become thick, for there the head slows down.",
            "All'inizio di una linea esce troppo poco, alla fine troppo: {lag_mm3} nel posto"
            " sbagliato. Gli angoli diventano grossi, perché lì la testina rallenta.",
        ),
        Text(
            "Pressure advance pushes early: at each moment the filament is ahead by `K` times its"
            " speed. With `K` = {tuned.advance_s} and {e_mm_s} of filament that is"
            " {tuned.extra_mm}, and only {tuned.lag_mm3} is left in the wrong place.",
            "Il pressure advance spinge in anticipo: in ogni istante il filamento è avanti di `K`"
            " volte la sua velocità. Con `K` = {tuned.advance_s} e {e_mm_s} di filamento sono"
            " {tuned.extra_mm}, e solo {tuned.lag_mm3} resta nel posto sbagliato.",
        ),
        Text(
            "It has a price: while the head speeds up, the extruder needs `K` times its"
            " acceleration on top, {tuned.push_mm_s} in place of {e_mm_s}. If it cannot, the"
            " planner must slow the head down.",
            "Ha un prezzo: mentre la testina accelera, l'estrusore ha bisogno in più di `K` volte"
            " la sua accelerazione, {tuned.push_mm_s} invece di {e_mm_s}. Se non può, il"
            " pianificatore deve rallentare la testina.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"tuned": {"advance_s": 0.05}},
    questions=[
        Question(
            Text(
                "The head prints at {speed_mm_s}; each millimetre of path takes {per_mm} of"
                " filament. How much filament is sent early with `K` = {advance_s}?",
                "La testina stampa a {speed_mm_s}; ogni millimetro di percorso richiede {per_mm} di"
                " filamento. Quanto filamento è in anticipo con `K` = {advance_s}?",
            ),
            "extra_mm",
            given={"advance_s": 0.04, "speed_mm_s": 150.0},
            mistakes=[
                Mistake(
                    lambda v: v["advance_s"] * v["speed_mm_s"],
                    Text(
                        "This takes the speed of the head. The filament moves much more slowly.",
                        "Questo usa la velocità della testina. Il filamento va molto più piano.",
                    ),
                ),
                Mistake(
                    lambda v: v["e_mm_s"],
                    Text(
                        "That is the speed of the filament. Multiply it by `K`.",
                        "Questa è la velocità del filamento. Moltiplicala per `K`.",
                    ),
                ),
            ],
            why=Text(
                "The filament moves at {e_mm_s}, and `K` is the time by which it is ahead.",
                "Il filamento si muove a {e_mm_s}, e `K` è il tempo di cui è avanti.",
            ),
            hint=Text(
                "First the speed of the filament, then `K` times it.",
                "Prima la velocità del filamento, poi `K` volte tanto.",
            ),
        ),
        Question(
            Text(
                "The head speeds up with {acceleration_mm_s2} to {speed_mm_s}, with `K` ="
                " {advance_s}. Which speed must the extruder reach?",
                "La testina accelera con {acceleration_mm_s2} fino a {speed_mm_s}, con `K` ="
                " {advance_s}. Quale velocità deve raggiungere l'estrusore?",
            ),
            "push_mm_s",
            given={"advance_s": 0.06, "acceleration_mm_s2": 3000.0},
            mistakes=[
                Mistake(
                    lambda v: v["e_mm_s"],
                    Text(
                        "That is enough at constant speed. While it speeds up, more is needed.",
                        "Basta a velocità costante. Mentre accelera serve di più.",
                    ),
                ),
                Mistake(
                    lambda v: v["push_mm_s"] - v["e_mm_s"],
                    Text(
                        "This is what comes on top of the speed itself.",
                        "Questo è ciò che si aggiunge alla velocità stessa.",
                    ),
                ),
            ],
            why=Text(
                "{e_mm_s} for the line, and `K` times the acceleration of the filament on top.",
                "{e_mm_s} per la linea, e in più `K` volte l'accelerazione del filamento.",
            ),
            hint=Text(
                "The filament's acceleration is the head's, times {per_mm} per millimetre.",
                "L'accelerazione del filamento è quella della testina, per {per_mm} al millimetro.",
            ),
        ),
    ],
    source=Source("core/filters/advance.hpp", "Advance"),
    printer=OwnPrinter(
        Text(
            "The page's task prints a tower or lines, and finds your value.",
            "L'attività della pagina stampa una torre o linee, e trova il tuo valore.",
        ),
        command="M900 K",
        page="calibrate",
    ),
    links=[
        Link(
            Text("Print fast without ringing", "Stampare veloce senza oscillazioni"),
            document="docs/how-to/print-fast-without-ringing.md",
        )
    ],
)
