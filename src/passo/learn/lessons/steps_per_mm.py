"""Steps per millimetre."""

from __future__ import annotations

from passo.learn.bilingual import Text
from passo.learn.calculators.steps_per_mm import CALCULATOR
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source

_M8: dict[str, float | str] = {"drive": "screw", "lead_mm": 1.25}

LESSON = Lesson(
    name="steps-per-mm",
    chapter=Chapter.MOTION,
    place=20,
    rows=(7,),
    minutes=20,
    title=Text("Steps per millimetre", "Passi al millimetro"),
    goal=Text(
        "You find how many steps an axis needs for a millimetre, from its parts alone.",
        "Trovi quanti passi servono a un asse per un millimetro, solo dalle sue parti.",
    ),
    text=[
        Text(
            "A stepper motor turns in equal steps. The usual one makes {full_steps:n} steps in one"
            " rotation. Its driver divides each of them into {microsteps} microsteps, so one"
            " rotation has {steps_per_rotation:n} of them.",
            "Un motore passo-passo gira a passi uguali. Quello comune fa {full_steps:n} passi in un"
            " giro. Il driver divide ciascuno in {microsteps} micropassi, quindi un giro ne ha"
            " {steps_per_rotation:n}.",
        ),
        Text(
            "A pulley with {teeth} moves its belt by one pitch for each tooth. With a pitch of"
            " {pitch_mm} that is {teeth:n} × {pitch_mm} = {travel_mm} in one rotation.",
            "Una puleggia con {teeth} muove la cinghia di un passo per ogni dente. Con un passo di"
            " {pitch_mm} sono {teeth:n} × {pitch_mm} = {travel_mm} in un giro.",
        ),
        Text(
            "Divide the two: {steps_per_rotation} / {travel_mm} = {steps_per_mm}. One step is then"
            " {step_um}.",
            "Dividi i due numeri: {steps_per_rotation} / {travel_mm} = {steps_per_mm}. Un passo è"
            " quindi {step_um}.",
        ),
        Text(
            "A lead screw has no teeth: in one rotation its nut moves by the lead. With a lead of"
            " {screw.lead_mm} the axis has {screw.steps_per_mm}. The threaded rod M5 has"
            " {rod.lead_mm} for each rotation, so {rod.steps_per_mm}.",
            "Una vite non ha denti: in un giro la sua madrevite avanza dell'avanzamento della"
            " filettatura. Con {screw.lead_mm} l'asse ha {screw.steps_per_mm}. La barra filettata"
            " M5 ha {rod.lead_mm} per giro, quindi {rod.steps_per_mm}.",
        ),
        Text(
            "The parts give the exact number for belts and screws. Do not correct it with a printed"
            " cube: that measures plastic, too. An extruder is different, because its wheel bites"
            " into the filament; there you measure.",
            "Per cinghie e viti le parti danno il numero esatto. Non correggerlo con un cubo"
            " stampato: misureresti anche la plastica. L'estrusore è diverso, perché la sua ruota"
            " morde il filamento; lì si misura.",
        ),
    ],
    experiment=CALCULATOR,
    cases={
        "screw": {"drive": "screw", "lead_mm": 8.0},
        "rod": {"drive": "screw", "lead_mm": 0.8},
    },
    questions=[
        Question(
            Text(
                "A pulley has {teeth}, its belt a pitch of {pitch_mm}, the driver makes"
                " {microsteps} microsteps. How many steps are a millimetre?",
                "Una puleggia ha {teeth}, la cinghia un passo di {pitch_mm}, il driver fa"
                " {microsteps} micropassi. Quanti passi sono un millimetro?",
            ),
            "steps_per_mm",
            given={"teeth": 16.0},
            mistakes=[
                Mistake(
                    lambda v: v["full_steps"] / v["travel_mm"],
                    Text(
                        "Those are full steps. The driver makes {microsteps} microsteps of each.",
                        "Questi sono passi interi. Il driver fa {microsteps} micropassi di ognuno.",
                    ),
                ),
                Mistake(
                    lambda v: v["steps_per_rotation"] / v["teeth"],
                    Text(
                        "That is the number for one tooth. One tooth is {pitch_mm}.",
                        "Questo è il numero per un dente. Un dente è {pitch_mm}.",
                    ),
                ),
                Mistake(
                    lambda v: v["travel_mm"] / v["steps_per_rotation"],
                    Text(
                        "You divided the other way round: that is the length of one step.",
                        "Hai diviso al contrario: questa è la lunghezza di un passo.",
                    ),
                ),
            ],
            why=Text(
                "{steps_per_rotation} in one rotation, which moves {travel_mm}: a smaller pulley"
                " gives more steps for a millimetre, and less speed.",
                "{steps_per_rotation} in un giro, che muove {travel_mm}: una puleggia più piccola"
                " dà più passi al millimetro, e meno velocità.",
            ),
            hint=Text(
                "Steps of one rotation, divided by the millimetres of one rotation.",
                "Passi di un giro, divisi per i millimetri di un giro.",
            ),
        ),
        Question(
            Text(
                "The rod M8 moves the nut by {lead_mm} in one rotation, with {microsteps}"
                " microsteps. How many steps are a millimetre?",
                "La barra M8 muove la madrevite di {lead_mm} in un giro, con {microsteps}"
                " micropassi. Quanti passi sono un millimetro?",
            ),
            "steps_per_mm",
            given=_M8,
            mistakes=[
                Mistake(
                    lambda v: v["steps_per_rotation"] * v["lead_mm"],
                    Text(
                        "You multiplied. A screw with a small lead needs more steps for a"
                        " millimetre, not fewer.",
                        "Hai moltiplicato. Una vite con poco avanzamento richiede più passi al"
                        " millimetro, non meno.",
                    ),
                ),
                Mistake(
                    lambda v: v["full_steps"] / v["lead_mm"],
                    Text(
                        "Those are full steps. Count the {microsteps} microsteps, too.",
                        "Questi sono passi interi. Conta anche i {microsteps} micropassi.",
                    ),
                ),
            ],
            why=Text(
                "{steps_per_rotation} / {lead_mm}: one step lifts the nozzle by {step_um}.",
                "{steps_per_rotation} / {lead_mm}: un passo alza l'ugello di {step_um}.",
            ),
            hint=Text(
                "A screw has no teeth: divide the steps of one rotation by its lead.",
                "Una vite non ha denti: dividi i passi di un giro per il suo avanzamento.",
            ),
        ),
    ],
    source=Source("src/passo/config/motion.py", "Stepper.steps_per_unit"),
    printer=OwnPrinter(
        Text(
            "M92 shows the steps per millimetre of your printer. Compare them with your pulleys;"
            " for the extruder, the page measures.",
            "M92 mostra i passi al millimetro della tua stampante. Confrontali con le tue pulegge;"
            " per l'estrusore, misura la pagina.",
        ),
        command="M92",
        page="calibrate/steps",
    ),
    links=[
        Link(
            Text("Motor keys of the machine file", "Chiavi dei motori nel file macchina"),
            document="docs/reference/machine-file.md",
        )
    ],
)
