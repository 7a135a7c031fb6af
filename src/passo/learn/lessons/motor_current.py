"""From the label of a motor to the voltage at the screw of its driver."""

from __future__ import annotations

from math import sqrt

from passo.learn.bilingual import Text
from passo.learn.calculators.motor_current import CALCULATOR
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source

LESSON = Lesson(
    name="motor-current",
    chapter=Chapter.ELECTRICITY,
    place=30,
    rows=(9,),
    minutes=20,
    title=Text("Motor current and V_ref", "Corrente del motore e V_ref"),
    goal=Text(
        "You compute the reference voltage for a motor, and tell peak and RMS current apart.",
        "Calcoli la tensione di riferimento per un motore, e distingui corrente di picco ed"
        " efficace.",
    ),
    text=[
        Text(
            "A driver measures the current of a coil with a small resistor, here {sense_ohm}. It"
            " switches the supply off as soon as the voltage over this resistor reaches a limit."
            " A voltage V_ref, set with a screw, gives that limit.",
            "Un driver misura la corrente di una bobina con una piccola resistenza, qui"
            " {sense_ohm}. Stacca l'alimentazione appena la tensione su di essa raggiunge un"
            " limite. Una tensione V_ref, regolata con un trimmer, dà quel limite.",
        ),
        Text(
            "On an A4988 it is `V_ref = 8 · I_peak · R`. The motor is rated {rated_a}; {percent} of"
            " that are {peak_a}, so V_ref is {reference_v}. A DRV8825 amplifies by `5`: there the"
            " same current needs only {drv.reference_v}.",
            "Su un A4988 è `V_ref = 8 · I_picco · R`. Il motore è da {rated_a}; il {percent} di"
            " questo è {peak_a}, quindi V_ref è {reference_v}. Un DRV8825 amplifica per `5`: lì la"
            " stessa corrente richiede solo {drv.reference_v}.",
        ),
        Text(
            "The resistor differs from maker to maker: read it under a lens (`R100` is"
            " `0.1 Ω`). With {other.sense_ohm} in place of {sense_ohm}, the same current needs"
            " {other.reference_v}.",
            "La resistenza cambia da un produttore all'altro: leggila con una lente (`R100` è"
            " `0.1 Ω`). Con {other.sense_ohm} al posto di {sense_ohm}, la stessa corrente richiede"
            " {other.reference_v}.",
        ),
        Text(
            "A coil with a sine current gets its peak only for a moment. The heat follows the RMS"
            " current, which is the peak divided by `√2`: {rms_a}. Machine files and TMC drivers"
            " use RMS; an A4988 is set to the peak.",
            "Una bobina con corrente sinusoidale riceve il picco solo per un attimo. Il calore"
            " segue la corrente efficace, cioè il picco diviso `√2`: {rms_a}. I file macchina e i"
            " driver TMC usano quella efficace; un A4988 si regola sul picco.",
        ),
        Text(
            "Torque grows with the current, heat with its square: both coils together make"
            " {heat_w}. With {full.percent} it would be {full.heat_w}.",
            "La coppia cresce con la corrente, il calore con il suo quadrato: le due bobine insieme"
            " fanno {heat_w}. Con {full.percent} sarebbero {full.heat_w}.",
        ),
    ],
    experiment=CALCULATOR,
    cases={
        "drv": {"driver": "DRV8825"},
        "other": {"sense_ohm": 0.05},
        "full": {"percent": 100.0},
    },
    questions=[
        Question(
            Text(
                "{driver}, sense resistor {sense_ohm}, peak {peak_a}: which V_ref do you set?",
                "{driver}, resistenza {sense_ohm}, picco {peak_a}: quale V_ref imposti?",
            ),
            "reference_v",
            given={"driver": "A4988", "rated_a": 1.5, "percent": 80.0, "sense_ohm": 0.068},
            mistakes=[
                Mistake(
                    lambda v: v["peak_a"] * 8 * 0.1,
                    Text(
                        "So it would be with the usual `0.1 Ω`. This board has {sense_ohm}.",
                        "Così sarebbe con i soliti `0.1 Ω`. Questa scheda ha {sense_ohm}.",
                    ),
                ),
                Mistake(
                    lambda v: v["peak_a"] * 5 * v["sense_ohm"],
                    Text(
                        "The factor `5` is that of a DRV8825. An A4988 has `8`.",
                        "Il fattore `5` è di un DRV8825. Un A4988 ha `8`.",
                    ),
                ),
                Mistake(
                    lambda v: v["rms_a"] * 8 * v["sense_ohm"],
                    Text(
                        "This driver limits the peak, and the question gives the peak. Do not"
                        " divide by `√2`.",
                        "Questo driver limita il picco, e la domanda dà il picco. Non dividere per"
                        " `√2`.",
                    ),
                ),
            ],
            why=Text("`8 · I_peak · R`.", "`8 · I_picco · R`."),
            hint=Text(
                "The voltage over the resistor is `I · R`, and this driver compares it with an"
                " eighth of V_ref.",
                "La tensione sulla resistenza è `I · R`, e questo driver la confronta con un ottavo"
                " di V_ref.",
            ),
        ),
        Question(
            Text(
                "The peak is {peak_a}, a coil has {coil_ohm}. How much heat do both coils make"
                " together?",
                "Il picco è {peak_a}, una bobina ha {coil_ohm}. Quanto calore fanno insieme le due"
                " bobine?",
            ),
            "heat_w",
            given={"rated_a": 2.0, "percent": 60.0, "coil_ohm": 2.0},
            mistakes=[
                Mistake(
                    lambda v: 2 * v["peak_a"] ** 2 * v["coil_ohm"],
                    Text(
                        "Both coils never have the peak at the same time. Use the RMS current.",
                        "Le due bobine non hanno mai il picco insieme. Usa la corrente efficace.",
                    ),
                ),
                Mistake(
                    lambda v: v["peak_a"] ** 2 * v["coil_ohm"] / 2,
                    Text("That is one coil. There are two.", "Questa è una bobina. Sono due."),
                ),
                Mistake(
                    lambda v: 2 * v["peak_a"] / sqrt(2) * v["coil_ohm"],
                    Text(
                        "That is a voltage. The power is `I² · R`.",
                        "Questa è una tensione. La potenza è `I² · R`.",
                    ),
                ),
            ],
            why=Text(
                "RMS is {rms_a}; twice `I² · R`. It is the same as `I_peak² · R` of one coil: the"
                " squares of sine and cosine add up to one.",
                "L'efficace è {rms_a}; due volte `I² · R`. È come `I_picco² · R` di una bobina: i"
                " quadrati di seno e coseno sommano a uno.",
            ),
            hint=Text(
                "First the RMS current of a coil, then `I² · R`, then both coils.",
                "Prima la corrente efficace di una bobina, poi `I² · R`, poi le due bobine.",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("src/passo/config/trinamic/currents.py", "CurrentLaw.numbers"),
    printer=OwnPrinter(
        Text(
            "M906 sets the current of drivers with registers, in mA RMS. With a screw, measure"
            " V_ref against ground with great care, and turn it with a plastic tool: a short"
            " circuit at the screw destroys the module.",
            "M906 imposta la corrente dei driver con registri, in mA efficaci. Con un trimmer,"
            " misura V_ref verso massa con grande attenzione e un cacciavite di plastica: un corto"
            " circuito sul trimmer distrugge il modulo.",
        ),
        command="M906",
    ),
    links=[Link(Text("Drivers", "Driver"), document="docs/how-to/set-up-drivers.md")],
)
