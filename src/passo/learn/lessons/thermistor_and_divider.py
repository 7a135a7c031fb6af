"""From temperature to a count of the ADC, and back."""

from __future__ import annotations

from passo.config.thermistor import Divider, Ntc
from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Mark, Plane

_CURVE_C = [float(c) for c in range(0, 301, 5)]
_BITS = (10.0, 12.0)
_VOLT = "V"


def _compute(
    celsius: float,
    r25_ohm: float,
    beta_k: float,
    pullup_ohm: float,
    assumed_pullup_ohm: float,
    supply_v: float,
    bits: float,
) -> Outcome:
    sensor, divider = Ntc(r25_ohm, beta_k), Divider(pullup_ohm)

    def per_count_c(at_c: float, of_bits: float) -> float:
        """Degrees between two counts of the ADC around a temperature."""
        half = 0.5
        slope = divider.share(sensor.ohm(at_c - half)) - divider.share(sensor.ohm(at_c + half))
        return 1 / (slope * 2**of_bits)

    ohm = sensor.ohm(celsius)
    share = divider.share(ohm)
    count = float(int(share * 2**bits))
    read_c = sensor.celsius(Divider(assumed_pullup_ohm).ohm(share))
    return Outcome(
        numbers=[
            Number(
                "ohm",
                Text("Resistance of the thermistor", "Resistenza del termistore"),
                ohm,
                "Ω",
                decimals=0,
            ),
            Number(
                "volt",
                Text("Voltage at the pin", "Tensione sul pin"),
                supply_v * share,
                _VOLT,
                decimals=3,
            ),
            Number("count", Text("Count of the ADC", "Conteggio dell'ADC"), count, decimals=0),
            Number(
                "per_count_c",
                Text("Degrees for each count", "Gradi per conteggio"),
                per_count_c(celsius, bits),
                "°C",
            ),
            Number(
                "read_c",
                Text("Temperature that the printer shows", "Temperatura mostrata"),
                read_c,
                "°C",
                decimals=1,
            ),
            Number(
                "error_c", Text("Its error", "Il suo errore"), read_c - celsius, "°C", decimals=1
            ),
        ],
        graphs=[
            Graph(
                Text("Voltage at the pin", "Tensione sul pin"),
                Text("temperature, °C", "temperatura, °C"),
                _VOLT,
                [
                    Line(
                        Text("NTC under its pull-up", "NTC con la sua resistenza di pull-up"),
                        _CURVE_C,
                        [supply_v * divider.share(sensor.ohm(c)) for c in _CURVE_C],
                    ),
                    Line(
                        Text("this temperature", "questa temperatura"),
                        [celsius, celsius],
                        [0.0, supply_v * share],
                        colour=1,
                        dashed=True,
                    ),
                ],
            ),
            Graph(
                Text("Degrees between two counts", "Gradi tra due conteggi"),
                Text("temperature, °C", "temperatura, °C"),
                "°C",
                [
                    Line(
                        Text(f"{each:.0f} bits", f"{each:.0f} bit"),
                        _CURVE_C,
                        [per_count_c(c, each) for c in _CURVE_C],
                        colour=number,
                    )
                    for number, each in enumerate(_BITS)
                ],
            ),
        ],
        planes=[
            _diagram(
                f"{pullup_ohm:.0f} Ω",
                f"{ohm:.0f} Ω",
                f"{supply_v * share:.2f} V",
                f"{supply_v:g} V",
            )
        ],
    )


def _diagram(pullup: str, thermistor: str, pin: str, supply: str) -> Plane:
    def resistor(bottom: float, top: float) -> Line:
        middle, half = (bottom + top) / 2, 0.5
        low, high = middle - half, middle + half
        return Line(
            "",
            [0, 0, -0.25, -0.25, 0, 0, 0, 0.25, 0.25, 0],
            [bottom, low, low, high, high, top, high, high, low, low],
        )

    return Plane(
        Text("Voltage divider", "Partitore di tensione"),
        [
            resistor(2.0, 4.0),
            resistor(0.0, 2.0),
            Line("", [0, 1.6], [2.0, 2.0], colour=1),
            Line("", [-0.4, 0.4], [0.0, 0.0], colour=6),
        ],
        [
            Mark(0, 4.0, supply, colour=4, beside="above"),
            Mark(0.25, 3.0, pullup, dot=False),
            Mark(0.25, 1.0, thermistor, dot=False),
            Mark(1.6, 2.0, Text(f"pin: {pin}", f"pin: {pin}"), colour=1),
            Mark(0, 0.0, Text("ground", "massa"), dot=False, beside="below"),
        ],
    )


EXPERIMENT = Experiment(
    "thermistor-and-divider",
    Text("A thermistor at a pin", "Un termistore su un pin"),
    Text(
        "The sensor and the pull-up of a board, with the conversion that Passo uses.",
        "Il sensore e il pull-up di una scheda, con la conversione che usa Passo.",
    ),
    [
        Parameter(
            "celsius", Text("Temperature", "Temperatura"), 200.0, low=0.0, high=300.0, unit="°C"
        ),
        Parameter(
            "r25_ohm",
            Text("Resistance at 25 °C", "Resistenza a 25 °C"),
            100_000.0,
            unit="Ω",
            choices=[Choice(10_000.0), Choice(100_000.0)],
        ),
        Parameter("beta_k", Text("β", "β"), 3950.0, low=3000.0, high=4800.0, step=10.0, unit="K"),
        Parameter(
            "pullup_ohm",
            Text("Pull-up of the board", "Pull-up della scheda"),
            4700.0,
            unit="Ω",
            choices=[Choice(1000.0), Choice(2200.0), Choice(4700.0), Choice(10_000.0)],
        ),
        Parameter(
            "assumed_pullup_ohm",
            Text("Pull-up in the machine file", "Pull-up nel file macchina"),
            4700.0,
            unit="Ω",
            choices=[Choice(1000.0), Choice(2200.0), Choice(4700.0), Choice(10_000.0)],
        ),
        Parameter(
            "supply_v",
            Text("Supply", "Alimentazione"),
            5.0,
            unit="V",
            choices=[Choice(3.3), Choice(5.0)],
        ),
        Parameter(
            "bits",
            Text("Bits of the ADC", "Bit dell'ADC"),
            10.0,
            choices=[Choice(each) for each in _BITS],
        ),
    ],
    _compute,
)


_HOT: dict[str, float | str] = {"celsius": 240.0}

LESSON = Lesson(
    name="thermistor-and-divider",
    chapter=Chapter.HEAT,
    place=10,
    rows=(11,),
    minutes=30,
    title=Text("Thermistor and divider", "Termistore e partitore"),
    goal=Text(
        "You follow a temperature to the number that the board reads, and see how fine that is.",
        "Segui una temperatura fino al numero che legge la scheda, e vedi quanto è fine.",
    ),
    text=[
        Text(
            "A thermistor is a resistor that falls when it warms up. At room temperature this one"
            " has {r25_ohm}, at {celsius} only {ohm}. Its law is"
            " `R = R25 · exp(β · (1/T − 1/T25))`, with temperatures in kelvin and β = {beta_k}.",
            "Un termistore è una resistenza che cala quando si scalda. A temperatura ambiente"
            " questo ha {r25_ohm}, a {celsius} solo {ohm}. La sua legge è"
            " `R = R25 · exp(β · (1/T − 1/T25))`, con temperature in kelvin e β = {beta_k}.",
        ),
        Text(
            "A board cannot measure a resistance, only a voltage. So the thermistor stands under a"
            " known resistor, the pull-up of {pullup_ohm}. The same current flows through both,"
            " hence each takes its share of {supply_v}: `U = supply · R / (R + pull-up)`, here"
            " {volt}.",
            "Una scheda non misura una resistenza, ma solo una tensione. Perciò il termistore sta"
            " sotto una resistenza nota, il pull-up di {pullup_ohm}. La stessa corrente passa in"
            " entrambe, quindi ciascuna prende la sua parte di {supply_v}:"
            " `U = alimentazione · R / (R + pull-up)`, qui {volt}.",
        ),
        Text(
            "The converter (ADC) divides the supply into equal parts and counts: {count}. Between"
            " two counts it sees nothing. At {celsius} one count is {per_count_c}; with"
            " {fine.bits} bits it is {fine.per_count_c}.",
            "Il convertitore (ADC) divide l'alimentazione in parti uguali e conta: {count}. Tra due"
            " conteggi non vede nulla. A {celsius} un conteggio vale {per_count_c}; con"
            " {fine.bits} bit vale {fine.per_count_c}.",
        ),
        Text(
            "The curve is steepest where the thermistor equals the pull-up. Far from there a count"
            " is many degrees: at {cold.celsius} it is {cold.per_count_c}.",
            "La curva è più ripida dove il termistore è uguale al pull-up. Lontano da lì un"
            " conteggio vale molti gradi: a {cold.celsius} vale {cold.per_count_c}.",
        ),
        Text(
            "If the machine file names another pull-up than the board has, every temperature is"
            " wrong. With {wrong.assumed_pullup_ohm} in the file, a hotend of {wrong.celsius} is"
            " shown as {wrong.read_c}.",
            "Se il file macchina indica un pull-up diverso da quello della scheda, ogni temperatura"
            " è sbagliata. Con {wrong.assumed_pullup_ohm} nel file, un hotend a {wrong.celsius} è"
            " mostrato come {wrong.read_c}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "fine": {"bits": 12.0},
        "cold": {"celsius": 0.0},
        "coarse": _HOT,
        "wrong": {"assumed_pullup_ohm": 2200.0},
    },
    questions=[
        Question(
            Text(
                "At {celsius} this thermistor has {ohm}, the pull-up {pullup_ohm}, the supply is"
                " {supply_v}. Which voltage is at the pin?",
                "A {celsius} questo termistore ha {ohm}, il pull-up {pullup_ohm}, l'alimentazione è"
                " {supply_v}. Quale tensione c'è sul pin?",
            ),
            "volt",
            given={"celsius": 100.0},
            mistakes=[
                Mistake(
                    lambda v: v["supply_v"] - v["volt"],
                    Text(
                        "That is the voltage across the pull-up. The pin is above the thermistor,"
                        " so it sees the other part.",
                        "Questa è la tensione sul pull-up. Il pin sta sopra il termistore, quindi"
                        " vede l'altra parte.",
                    ),
                ),
                Mistake(
                    lambda v: v["supply_v"] * v["ohm"] / v["pullup_ohm"],
                    Text(
                        "Divide by the sum of both resistors: the current passes both.",
                        "Dividi per la somma delle due resistenze: la corrente passa in entrambe.",
                    ),
                ),
            ],
            why=Text(
                "`U = supply · R / (R + pull-up)`. The ADC counts {count} of it.",
                "`U = alimentazione · R / (R + pull-up)`. L'ADC ne conta {count}.",
            ),
            hint=Text(
                "Each resistor takes its share: its own resistance, divided by the sum.",
                "Ogni resistenza prende la sua parte: la propria resistenza, divisa per la somma.",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "With {coarse.bits} bits, one count near {coarse.celsius} is {coarse.per_count_c}."
                " How many degrees is one count with {bits} bits?",
                "Con {coarse.bits} bit, un conteggio vicino a {coarse.celsius} vale"
                " {coarse.per_count_c}. Quanti gradi vale un conteggio con {bits} bit?",
            ),
            "per_count_c",
            given=_HOT | {"bits": 12.0},
            mistakes=[
                Mistake(
                    lambda v: v["per_count_c"] * 2,
                    Text(
                        "Each further bit halves the step, and there are two of them.",
                        "Ogni bit in più dimezza il passo, e qui sono due.",
                    ),
                ),
                Mistake(
                    lambda v: v["per_count_c"] * 4 * 10 / 12,
                    Text(
                        "The number of counts is a power of two of the bits, not a multiple.",
                        "Il numero dei conteggi è una potenza di due dei bit, non un multiplo.",
                    ),
                ),
                Mistake(
                    lambda v: v["per_count_c"] * 16,
                    Text(
                        "More bits make finer steps, not coarser ones.",
                        "Più bit danno passi più fini, non più grossi.",
                    ),
                ),
            ],
            why=Text(
                "Two bits more are four times as many counts: a quarter of the step.",
                "Due bit in più sono quattro volte i conteggi: un quarto del passo.",
            ),
            hint=Text(
                "How many counts has each converter? Two to the power of its bits.",
                "Quanti conteggi ha ogni convertitore? Due elevato ai suoi bit.",
            ),
            tolerance=0.05,
        ),
    ],
    source=Source("src/passo/config/thermistor.py", "Divider.share"),
    printer=OwnPrinter(
        Text(
            "M305 shows the sensor of your hotend. Compare its pull-up with the description of your"
            " board; the page fits β to a thermometer.",
            "M305 mostra il sensore del tuo hotend. Confronta il suo pull-up con la descrizione"
            " della scheda; la pagina adatta β a un termometro.",
        ),
        command="M305",
        page="calibrate/thermistor",
    ),
    links=[
        Link(Text("Heat", "Calore"), document="docs/explanation/heat.md"),
        Link(
            Text("Calibrate a thermistor", "Calibra un termistore"),
            document="docs/how-to/calibrate-a-thermistor.md",
        ),
    ],
)
