"""The transistor of a heater: why a bed destroys what a hotend leaves cold."""

from __future__ import annotations

from passo.learn.bilingual import Text
from passo.learn.calculators.mosfet_heat import CALCULATOR
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source

_LIMIT_C = 175.0

LESSON = Lesson(
    name="mosfet-heat",
    chapter=Chapter.ELECTRICITY,
    place=50,
    rows=(17,),
    minutes=25,
    title=Text("Heat of a MOSFET", "Calore di un MOSFET"),
    goal=Text(
        "You compute how hot the transistor of a heater becomes, and choose a part that lasts.",
        "Calcoli quanto si scalda il transistor di un riscaldatore, e scegli una parte che dura.",
    ),
    text=[
        Text(
            "The board switches a heater with a MOSFET. Switched on, it still has a small"
            " resistance, R_DS(on). The current of the heater flows through it and makes heat:"
            " `P = I² · R`. A hotend of {hotend.current_a} makes {hotend.power_w} in an"
            " STP55NF06L.",
            "La scheda comanda un riscaldatore con un MOSFET. Acceso, ha ancora una piccola"
            " resistenza, R_DS(on). La corrente del riscaldatore la attraversa e produce calore:"
            " `P = I² · R`. Un hotend da {hotend.current_a} fa {hotend.power_w} in un STP55NF06L.",
        ),
        Text(
            "This heat has to reach the air. The thermal resistance says how many degrees each watt"
            " costs, without a heat sink {rise_c_per_w}. So the hotend warms its transistor by"
            " {hotend.rise_c}, to {hotend.junction_c} inside.",
            "Questo calore deve arrivare all'aria. La resistenza termica dice quanti gradi costa"
            " ogni watt, senza dissipatore {rise_c_per_w}. Quindi l'hotend scalda il suo transistor"
            " di {hotend.rise_c}, fino a {hotend.junction_c} all'interno.",
        ),
        Text(
            "A bed of {current_a} has three times the current, hence nine times the heat:"
            " {power_w}, and {junction_c} inside. The part allows `175 °C`. Such a transistor"
            " fails, and most MOSFETs fail switched on: the bed heats without end.",
            "Un piano da {current_a} ha il triplo della corrente, quindi nove volte il calore:"
            " {power_w}, e {junction_c} all'interno. La parte ammette `175 °C`. Un transistor così"
            " si guasta, e di solito un MOSFET si guasta acceso: il piano scalda senza fine.",
        ),
        Text(
            "It is even worse. R_DS(on) grows with the temperature, about half as much again when"
            " it is hot. More resistance makes more heat. With the IRLB8743 this turns"
            " {better.junction_c} into {better.hot_junction_c}. With the STP55NF06L there is no"
            " end: {hot_junction_c}.",
            "È anche peggio. R_DS(on) cresce con la temperatura, circa la metà in più da caldo. Più"
            " resistenza fa più calore. Con l'IRLB8743 questo porta {better.junction_c} a"
            " {better.hot_junction_c}. Con l'STP55NF06L non c'è fine: {hot_junction_c}.",
        ),
        Text(
            "Two ways out: a better part, or a heat sink. An IRLB3034 stays at"
            " {best.hot_junction_c} as it is; the first part with a sink of {sink.rise_c_per_w} at"
            " {sink.hot_junction_c}. Read R_DS(on) in the data sheet at the gate voltage of your"
            " board: at a lower voltage it is higher.",
            "Due vie d'uscita: una parte migliore, o un dissipatore. Un IRLB3034 resta a"
            " {best.hot_junction_c} così com'è; la prima parte con un dissipatore da"
            " {sink.rise_c_per_w} a {sink.hot_junction_c}. Leggi R_DS(on) nel foglio dati alla"
            " tensione di gate della tua scheda: a una tensione più bassa è più alta.",
        ),
    ],
    experiment=CALCULATOR,
    cases={
        "hotend": {"current_a": 4.0},
        "better": {"part": "IRLB8743"},
        "best": {"part": "IRLB3034"},
        "sink": {"rise_c_per_w": 10.0},
    },
    questions=[
        Question(
            Text(
                "A heater of {current_a} at an STP55NF06L (`18 mΩ`), {rise_c_per_w}, air of"
                " {ambient_c}. How hot is the junction, if R stays constant?",
                "Un riscaldatore da {current_a} su un STP55NF06L (`18 mΩ`), {rise_c_per_w}, aria a"
                " {ambient_c}. Quanto è calda la giunzione, se R resta costante?",
            ),
            "junction_c",
            given={"current_a": 8.0, "ambient_c": 30.0},
            mistakes=[
                Mistake(
                    lambda v: v["rise_c"],
                    Text(
                        "That is only the rise. The air has {ambient_c} already.",
                        "Questo è solo l'aumento. L'aria è già a {ambient_c}.",
                    ),
                ),
                Mistake(
                    lambda v: v["ambient_c"] + v["rise_c"] / v["current_a"],
                    Text(
                        "The current counts twice: `I² · R`, not `I · R`.",
                        "La corrente conta due volte: `I² · R`, non `I · R`.",
                    ),
                ),
                Mistake(
                    lambda v: v["ambient_c"] + v["power_w"],
                    Text(
                        "That is the power, in watt. Each watt is {rise_c_per_w:n} degrees.",
                        "Questa è la potenza, in watt. Ogni watt vale {rise_c_per_w:n} gradi.",
                    ),
                ),
            ],
            why=Text(
                "{power_w} of heat raise it by {rise_c} above the air.",
                "{power_w} di calore la alzano di {rise_c} sopra l'aria.",
            ),
            hint=Text(
                "First the heat, `I² · R`, then the rise, then the air.",
                "Prima il calore, `I² · R`, poi l'aumento, poi l'aria.",
            ),
        ),
        Question(
            Text(
                "Which current brings an IRLB3034 (`1.7 mΩ`) without a heat sink to its limit of"
                " `175 °C`, in air of {ambient_c} and with a constant R?",
                "Quale corrente porta un IRLB3034 (`1.7 mΩ`) senza dissipatore al limite di"
                " `175 °C`, in aria a {ambient_c} e con R costante?",
            ),
            "highest_a",
            given={"part": "IRLB3034"},
            mistakes=[
                Mistake(
                    lambda v: (_LIMIT_C / v["rise_c_per_w"] / 0.0017) ** 0.5,
                    Text(
                        "Start from the air: only the difference to it is left for the rise.",
                        "Parti dall'aria: per l'aumento resta solo la differenza da essa.",
                    ),
                ),
                Mistake(
                    lambda v: v["highest_a"] ** 2,
                    Text(
                        "That is the square of the current. Take the root.",
                        "Questo è il quadrato della corrente. Fai la radice.",
                    ),
                ),
                Mistake(
                    lambda v: (_LIMIT_C - v["ambient_c"]) / v["rise_c_per_w"],
                    Text(
                        "That is the heat that it may have, in watt. Which current makes it?",
                        "Questo è il calore ammesso, in watt. Quale corrente lo produce?",
                    ),
                ),
            ],
            why=Text(
                "`I = √(rise / R_th / R)`. In a box, with R growing, plan for much less.",
                "`I = √(aumento / R_th / R)`. In una scatola, con R che cresce, resta molto sotto.",
            ),
            hint=Text(
                "Go backwards: allowed rise, allowed heat, then the current from `P = I² · R`.",
                "Vai a ritroso: aumento ammesso, calore ammesso, poi la corrente da `P = I² · R`.",
            ),
        ),
    ],
    source=Source("core/heat/protection.hpp", "Protection"),
    printer=OwnPrinter(
        Text(
            "A MOSFET that fails switched on is found by its heat: try it on the simulated printer."
            " Only a switch in the supply can stop such a heater, so wire M81 to one.",
            "Un MOSFET guasto da acceso si riconosce dal suo calore: provalo sulla stampante"
            " simulata. Solo un interruttore sull'alimentazione ferma un simile riscaldatore:"
            " collega M81 a uno.",
        ),
        command="M81",
        page="learn",
    ),
    links=[
        Link(Text("Heat", "Calore"), document="docs/explanation/heat.md"),
        Link(Text("Simulate faults", "Simula guasti"), document="docs/how-to/simulate-faults.md"),
    ],
)
