"""The power supply, its cables and its fuse."""

from __future__ import annotations

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table

_COPPER_OHM_MM2_M = 0.0175  # at 20 °C
_DRIVER_EFFICIENCY = 0.8
_ELECTRONICS_W = 10.0  # board, computer and fans
_RESERVE = 1.2
_MM2 = (0.5, 0.75, 1.0, 1.5, 2.5, 4.0)
_PARTS = (
    Text("hotend", "hotend"),
    Text("bed", "piano"),
    Text("motors", "motori"),
    Text("electronics", "elettronica"),
)


def _compute(
    supply_v: float,
    rated_v: float,
    hotend_w: float,
    bed_w: float,
    motors: float,
    motor_w: float,
    cable_m: float,
    cable_mm2: float,
) -> Outcome:
    grown = (supply_v / rated_v) ** 2  # a heater is a resistor
    parts_w = (
        hotend_w * grown,
        bed_w * grown,
        motors * motor_w / _DRIVER_EFFICIENCY,
        _ELECTRONICS_W,
    )
    total_w = sum(parts_w)
    bed_a = bed_w * grown / supply_v

    def lost_v(mm2: float) -> float:
        return bed_a * _COPPER_OHM_MM2_M * 2 * cable_m / mm2

    sections = [0.5 + 0.1 * k for k in range(36)]
    return Outcome(
        numbers=[
            Number("total_w", Text("All at once", "Tutto insieme"), total_w, "W", decimals=0),
            Number(
                "supply_w",
                Text("Power supply with reserve", "Alimentatore con riserva"),
                _RESERVE * total_w,
                "W",
                decimals=0,
            ),
            Number("total_a", Text("Current", "Corrente"), total_w / supply_v, "A", decimals=1),
            Number("real_bed_w", Text("Real bed", "Piano reale"), bed_w * grown, "W", decimals=0),
            Number(
                "bed_a", Text("Current of the bed", "Corrente del piano"), bed_a, "A", decimals=1
            ),
            Number(
                "lost_v",
                Text("Lost in its cable", "Persa nel suo cavo"),
                lost_v(cable_mm2),
                "V",
            ),
            Number(
                "cable_w",
                Text("Heat in its cable", "Calore nel suo cavo"),
                lost_v(cable_mm2) * bed_a,
                "W",
                decimals=1,
            ),
        ],
        graphs=[
            Graph(
                Text("Heat in the cable of the bed", "Calore nel cavo del piano"),
                Text("section of the cable, mm²", "sezione del cavo, mm²"),
                "W",
                [
                    Line(
                        Text("both wires", "i due fili"),
                        sections,
                        [lost_v(mm2) * bed_a for mm2 in sections],
                    )
                ],
            )
        ],
        tables=[
            Table(
                Text("Budget", "Bilancio"),
                [Text("part", "parte"), "W", "A"],
                [
                    [name, f"{watt:.0f}", f"{watt / supply_v:.1f}"]
                    for name, watt in zip(_PARTS, parts_w, strict=True)
                ],
            )
        ],
    )


def _volts(name: str, label: Text) -> Parameter:
    return Parameter(name, label, 12.0, unit="V", choices=[Choice(12.0), Choice(24.0)])


EXPERIMENT = Experiment(
    "power-budget",
    Text("Power budget of a printer", "Bilancio di potenza di una stampante"),
    Text(
        "What the power supply, the cable of the bed and a fuse must carry.",
        "Che cosa devono reggere l'alimentatore, il cavo del piano e un fusibile.",
    ),
    [
        _volts("supply_v", Text("Power supply", "Alimentatore")),
        _volts("rated_v", Text("Heaters are made for", "I riscaldatori sono fatti per")),
        Parameter("hotend_w", Text("Hotend", "Hotend"), 48.0, 20.0, 80.0, unit="W"),
        Parameter("bed_w", Text("Bed", "Piano"), 144.0, 40.0, 400.0, step=4.0, unit="W"),
        Parameter("motors", Text("Motors", "Motori"), 5.0, 3.0, 9.0, unit=Text("motors", "motori")),
        Parameter(
            "motor_w",
            Text("Heat of one motor", "Calore di un motore"),
            4.0,
            low=1.0,
            high=10.0,
            step=0.5,
            unit="W",
        ),
        Parameter(
            "cable_m",
            Text("Cable to the bed, one way", "Cavo fino al piano, sola andata"),
            1.0,
            low=0.2,
            high=3.0,
            step=0.1,
            unit="m",
        ),
        Parameter(
            "cable_mm2",
            Text("Its section", "La sua sezione"),
            1.5,
            unit="mm²",
            choices=[Choice(mm2) for mm2 in _MM2],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="power-budget",
    chapter=Chapter.ELECTRICITY,
    place=60,
    rows=(18,),
    minutes=20,
    title=Text("Power budget", "Bilancio di potenza"),
    goal=Text(
        "You choose a power supply and the cable of a bed by numbers.",
        "Scegli un alimentatore e il cavo di un piano in base ai numeri.",
    ),
    text=[
        Text(
            "Add up what can run at the same time: hotend {hotend_w}, bed {bed_w}, {motors}, board"
            " and fans. Together {total_w}, or {total_a} at {supply_v}. With a fifth as reserve the"
            " supply should give {supply_w}.",
            "Somma ciò che può funzionare insieme: hotend {hotend_w}, piano {bed_w}, {motors},"
            " scheda e ventole. In tutto {total_w}, cioè {total_a} a {supply_v}. Con un quinto di"
            " riserva l'alimentatore dovrebbe dare {supply_w}.",
        ),
        Text(
            "Voltage and current share the work: `P = U · I`. The same bed made for"
            " {high.supply_v} needs only {high.bed_a} in place of {bed_a}. Half the current is a"
            " quarter of the heat in cables, plugs and transistors.",
            "Tensione e corrente si dividono il lavoro: `P = U · I`. Lo stesso piano fatto per"
            " {high.supply_v} richiede solo {high.bed_a} invece di {bed_a}. Metà corrente è un"
            " quarto del calore in cavi, spine e transistor.",
        ),
        Text(
            "A heater is a resistor. Its label holds for one voltage only. Connect this bed of"
            " {rated_v} to {wrong.supply_v}: it takes twice the current at twice the voltage,"
            " {wrong.real_bed_w}. That may start a fire.",
            "Un riscaldatore è una resistenza. La sua etichetta vale per una sola tensione. Collega"
            " questo piano da {rated_v} a {wrong.supply_v}: prende il doppio della corrente al"
            " doppio della tensione, {wrong.real_bed_w}. Può causare un incendio.",
        ),
        Text(
            "The cable is a resistor, too, and counts for both directions. With {cable_mm2} and"
            " {cable_m} it loses {lost_v} and gets {cable_w} of heat; with {thin.cable_mm2} it"
            " would be {thin.cable_w}.",
            "Anche il cavo è una resistenza, e conta andata e ritorno. Con {cable_mm2} e {cable_m}"
            " perde {lost_v} e riceve {cable_w} di calore; con {thin.cable_mm2} sarebbero"
            " {thin.cable_w}.",
        ),
        Text(
            "A fuse protects the cable, not the heater. Choose it above the working current and"
            " below what the cable may carry. A loose screw is the weakest place: there the same"
            " current meets the most resistance.",
            "Un fusibile protegge il cavo, non il riscaldatore. Sceglilo sopra la corrente di"
            " lavoro e sotto quella che il cavo può portare. Una vite lenta è il punto più debole:"
            " lì la stessa corrente trova la resistenza maggiore.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "high": {"supply_v": 24.0, "rated_v": 24.0},
        "wrong": {"supply_v": 24.0},
        "thin": {"cable_mm2": 0.5},
    },
    questions=[
        Question(
            Text(
                "A bed of {bed_w} for {rated_v} is connected to {supply_v}. Which power does it"
                " have?",
                "Un piano da {bed_w} per {rated_v} è collegato a {supply_v}. Che potenza ha?",
            ),
            "real_bed_w",
            given={"supply_v": 24.0, "bed_w": 120.0},
            mistakes=[
                Mistake(
                    lambda v: 2 * v["bed_w"],
                    Text(
                        "Twice the voltage also drives twice the current through the same"
                        " resistor.",
                        "Il doppio della tensione spinge anche il doppio della corrente nella"
                        " stessa resistenza.",
                    ),
                ),
                Mistake(
                    lambda v: v["bed_w"],
                    Text(
                        "The label holds for {rated_v} only. The resistance stays, not the power.",
                        "L'etichetta vale solo per {rated_v}. Resta la resistenza, non la potenza.",
                    ),
                ),
                Mistake(
                    lambda v: v["bed_w"] / 2,
                    Text(
                        "That would need a current that falls. In a resistor it grows with the"
                        " voltage.",
                        "Servirebbe una corrente che cala. In una resistenza cresce con la"
                        " tensione.",
                    ),
                ),
            ],
            why=Text(
                "`P = U² / R`: twice the voltage, four times the power.",
                "`P = U² / R`: doppia tensione, quattro volte la potenza.",
            ),
            hint=Text(
                "Compute the resistance of the bed from its label first.",
                "Prima calcola la resistenza del piano dalla sua etichetta.",
            ),
        ),
        Question(
            Text(
                "The bed takes {bed_a}. Its cable is {cable_m} long with {cable_mm2}; a wire of"
                " copper has `0.0175 Ω` for each metre and mm². How much heat do both wires get?",
                "Il piano prende {bed_a}. Il suo cavo è lungo {cable_m} con {cable_mm2}; un filo di"
                " rame ha `0.0175 Ω` per ogni metro e mm². Quanto calore ricevono i due fili?",
            ),
            "cable_w",
            given={"bed_w": 240.0, "cable_m": 1.5, "cable_mm2": 0.75},
            mistakes=[
                Mistake(
                    lambda v: v["cable_w"] / 2,
                    Text(
                        "The current flows there and back: twice the length.",
                        "La corrente va e torna: il doppio della lunghezza.",
                    ),
                ),
                Mistake(
                    lambda v: v["lost_v"],
                    Text(
                        "That is the lost voltage. Multiply it by the current.",
                        "Questa è la tensione persa. Moltiplicala per la corrente.",
                    ),
                ),
                Mistake(
                    lambda v: v["cable_w"] * v["cable_mm2"] ** 2,
                    Text(
                        "A thicker wire has less resistance: divide by the section.",
                        "Un filo più grosso ha meno resistenza: dividi per la sezione.",
                    ),
                ),
            ],
            why=Text(
                "The resistance counts both ways, and `P = I² · R`. The bed misses {lost_v}.",
                "La resistenza conta andata e ritorno, e `P = I² · R`. Al piano manca {lost_v}.",
            ),
            hint=Text(
                "`R = 0.0175 · 2 · length / section`, then `I² · R`.",
                "`R = 0.0175 · 2 · lunghezza / sezione`, poi `I² · R`.",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("core/heat/protection.hpp", "ProtectionLimits"),
    printer=OwnPrinter(
        Text(
            "Let bed and hotend heat at once, and measure the supply at the terminals of the bed."
            " Less than at the power supply is lost in cables and plugs.",
            "Fai scaldare insieme piano e hotend, e misura la tensione ai morsetti del piano. Ciò"
            " che manca rispetto all'alimentatore si perde in cavi e spine.",
        ),
        command="M140 S60",
    ),
    links=[Link(Text("Heat", "Calore"), document="docs/explanation/heat.md")],
)
