"""Bits on a wire: a baud rate that the clock does not give, and a wrong one."""

from __future__ import annotations

from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table, edges

_RATES = (57_600, 115_200, 250_000, 500_000)
_STOP = 9.5  # bits from the start of a byte to the middle of its stop bit
_BITS = 10  # start, eight data bits, stop
_TICK = -0.3  # the foot of a mark of the graph
_RIGHT, _WRONG, _FRAMING = 0.0, 1.0, 2.0
_RESULTS = {
    _RIGHT: Text("the right byte", "il byte giusto"),
    _WRONG: Text("a wrong byte, without a warning", "un byte sbagliato, senza avviso"),
    _FRAMING: Text("a framing error: no stop bit", "un errore di frame: manca lo stop"),
}


def _divisor(clock_hz: float, baud: float) -> float:
    """As the firmware rounds it."""
    return float((int(clock_hz) + 4 * int(baud)) // (8 * int(baud)))


def _level(byte: int, bit: int) -> int:
    """The level of the line during a bit: start bit, eight data bits, then high."""
    if bit == 0:
        return 0
    return byte >> (bit - 1) & 1 if bit < _BITS - 1 else 1


def _compute(clock_mhz: float, board_baud: float, host_baud: float, character: str) -> Outcome:
    clock_hz = clock_mhz * 1e6
    divisor = _divisor(clock_hz, board_baud)
    real_baud = clock_hz / (8 * divisor)
    byte = ord(character)
    samples_s = [(bit + 0.5) / real_baud for bit in range(_BITS)]
    seen = [_level(byte, int(at * host_baud)) for at in samples_s]
    received = sum(level << bit for bit, level in enumerate(seen[1:9]))
    result = _FRAMING if not seen[9] else _RIGHT if received == byte else _WRONG
    name = chr(received) if 32 <= received < 127 else f"0x{received:02X}"
    return Outcome(
        numbers=[
            Number("divisor", Text("Divisor", "Divisore"), divisor, decimals=0),
            Number("real_baud", Text("Real baud rate", "Baud rate reale"), real_baud, "bit/s", 0),
            Number(
                "error_percent",
                Text("Its error", "Il suo errore"),
                100 * (real_baud / board_baud - 1),
                "%",
            ),
            Number(
                "drift_percent",
                Text("Offset at the stop bit", "Scarto al bit di stop"),
                100 * abs(_STOP * host_baud / real_baud - _STOP),
                Text("% of a bit", "% di un bit"),
                decimals=1,
            ),
            Number("received", Text("Received", "Ricevuto"), float(received), words=name),
            Number("result", Text("Result", "Risultato"), result, words=_RESULTS[result]),
            Number(
                "bytes_s",
                Text("Bytes per second", "Byte al secondo"),
                host_baud / _BITS,
                decimals=0,
            ),
        ],
        graphs=[_line(byte, host_baud, samples_s, seen)],
        tables=[_rates(clock_hz)],
    )


def _line(byte: int, host_baud: float, samples_s: list[float], seen: list[int]) -> Graph:
    bits = range(-1, _BITS + 1)
    starts_us = [1e6 * bit / host_baud for bit in bits]
    levels = [1.0 if bit < 0 else float(_level(byte, bit)) for bit in bits]
    end_us = max(starts_us[-1], 1e6 * samples_s[-1] * 1.05)
    marks_x: list[float] = []
    marks_y: list[float] = []
    for at, level in zip(samples_s, seen, strict=True):
        marks_x += [1e6 * at] * 3
        marks_y += [_TICK, float(level), _TICK]
    return Graph(
        Text("The wire, and when the board reads it", "Il filo, e quando la scheda lo legge"),
        Text("time, µs", "tempo, µs"),
        Text("level", "livello"),
        [
            Line(Text("host", "host"), *edges([*starts_us, end_us], [*levels, 1.0])),
            Line(Text("reading of the board", "lettura della scheda"), marks_x, marks_y, 1),
        ],
        values=(_TICK, 1.0),
    )


def _rates(clock_hz: float) -> Table:
    rows: list[list[Words]] = []
    for baud in _RATES:
        divisor = _divisor(clock_hz, baud)
        error = 100 * (clock_hz / (8 * divisor) / baud - 1)
        rows.append([str(baud), f"{divisor:.0f}", f"{error:+.2f}"])
    return Table(
        Text("Errors of this clock", "Errori di questo clock"),
        ["baud", Text("divisor", "divisore"), Text("error, %", "errore, %")],
        rows,
    )


EXPERIMENT = Experiment(
    "serial-baud",
    Text("One byte on a serial line", "Un byte su una linea seriale"),
    Text(
        "The host sends a character; the board reads the wire with a clock of its own.",
        "L'host manda un carattere; la scheda legge il filo con un clock proprio.",
    ),
    [
        Parameter(
            "clock_mhz",
            Text("Clock of the board", "Clock della scheda"),
            16.0,
            unit="MHz",
            choices=[Choice(16.0), Choice(20.0)],
        ),
        Parameter(
            "board_baud",
            Text("Baud rate of the board", "Baud rate della scheda"),
            115_200.0,
            unit="bit/s",
            choices=[Choice(float(each)) for each in _RATES],
        ),
        Parameter(
            "host_baud",
            Text("Baud rate of the host", "Baud rate dell'host"),
            115_200.0,
            unit="bit/s",
            choices=[Choice(float(each)) for each in _RATES],
        ),
        Parameter(
            "character",
            Text("Character", "Carattere"),
            "G",
            choices=[Choice(each) for each in "GMTU"],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="serial-baud",
    chapter=Chapter.ELECTRICITY,
    place=80,
    rows=(20,),
    minutes=25,
    title=Text("Baud rate", "Baud rate"),
    goal=Text(
        "You compute the error of a baud rate, and recognise a wrong one by what arrives.",
        "Calcoli l'errore di un baud rate, e ne riconosci uno sbagliato da ciò che arriva.",
    ),
    text=[
        Text(
            "A serial line has no clock wire. A byte is a start bit (low), eight data bits, the"
            " lowest first, and a stop bit (high). The board sees the start, and then reads the"
            " wire in the middle of each bit, by its own clock. Ten bits are one byte, so"
            " {host_baud} carry {bytes_s} bytes per second.",
            "Una linea seriale non ha un filo di clock. Un byte è un bit di start (basso), otto bit"
            " di dati, il meno significativo per primo, e un bit di stop (alto). La scheda vede lo"
            " start, poi legge il filo a metà di ogni bit con il proprio clock. Dieci bit sono un"
            " byte, quindi {host_baud} portano {bytes_s} byte al secondo.",
        ),
        Text(
            "An AVR divides its clock by eight times a whole number. For {board_baud} at"
            " {clock_mhz} the nearest divisor is {divisor}, which gives {real_baud}: an error of"
            " {error_percent}. For {exact.board_baud} the divisor {exact.divisor} is exact. That is"
            " the reason for this odd rate.",
            "Un AVR divide il suo clock per otto volte un numero intero. Per {board_baud} a"
            " {clock_mhz} il divisore più vicino è {divisor}, che dà {real_baud}: un errore di"
            " {error_percent}. Per {exact.board_baud} il divisore {exact.divisor} è esatto. Ecco il"
            " perché di questa velocità insolita.",
        ),
        Text(
            "The error adds up from bit to bit. At the middle of the stop bit, nine and a half bits"
            " after the start, the board is off by {drift_percent}. Up to half a bit it still reads"
            " the right one, but the other side has an error, too, and edges are not sharp.",
            "L'errore si somma da bit a bit. A metà del bit di stop, nove bit e mezzo dopo lo"
            " start, la scheda è fuori di {drift_percent}. Fino a mezzo bit legge ancora quello"
            " giusto, ma anche l'altro lato ha un errore, e i fronti non sono netti.",
        ),
        Text(
            "If the two rates are different ones, the board reads the wrong places. Host at"
            " {fast.host_baud}, board at {fast.board_baud}: the character {fast.character} arrives"
            " as `{fast.received}`, {fast.result}. The other way round: {slow.result}. So text that"
            " looks like noise is a wrong baud rate; silence is a wrong port or a cable.",
            "Se le due velocità sono diverse, la scheda legge nei punti sbagliati. Host a"
            " {fast.host_baud}, scheda a {fast.board_baud}: il carattere {fast.character} arriva"
            " come `{fast.received}`, {fast.result}. Al contrario: {slow.result}. Quindi un testo"
            " che sembra rumore è un baud rate sbagliato; il silenzio è una porta o un cavo.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "exact": {"board_baud": 250_000.0, "host_baud": 250_000.0},
        "fast": {"host_baud": 250_000.0},
        "slow": {"board_baud": 250_000.0},
    },
    questions=[
        Question(
            Text(
                "A board with {clock_mhz} uses the divisor {divisor} for {board_baud}. Its rate is"
                " `clock / (8 · divisor)`. By how many percent is it off? Mind the sign.",
                "Una scheda a {clock_mhz} usa il divisore {divisor} per {board_baud}. La sua"
                " velocità è `clock / (8 · divisore)`. Di quanti percento sbaglia? Attento al"
                " segno.",
            ),
            "error_percent",
            given={"board_baud": 57_600.0, "host_baud": 57_600.0},
            mistakes=[
                Mistake(
                    lambda v: -v["error_percent"],
                    Text(
                        "The sign: is the real rate above or below the nominal one?",
                        "Il segno: la velocità reale è sopra o sotto quella nominale?",
                    ),
                ),
                Mistake(
                    lambda v: 100 * (v["real_baud"] / 2 / v["board_baud"] - 1),
                    Text(
                        "You divided by sixteen times the divisor. This mode uses eight.",
                        "Hai diviso per sedici volte il divisore. Questa modalità usa otto.",
                    ),
                ),
            ],
            why=Text("The real rate is {real_baud}.", "La velocità reale è {real_baud}."),
            hint=Text(
                "Compute the real rate, divide it by the nominal one, subtract one.",
                "Calcola la velocità reale, dividila per quella nominale, togli uno.",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "Board at {real_baud}, host at exactly {host_baud}. By how much of a bit, in"
                " percent, is the reading of the stop bit off its middle?",
                "Scheda a {real_baud}, host esattamente a {host_baud}. Di quanta parte di bit, in"
                " percento, la lettura del bit di stop è fuori dal centro?",
            ),
            "drift_percent",
            given={"clock_mhz": 20.0},
            mistakes=[
                Mistake(
                    lambda v: v["drift_percent"] / 9.5,
                    Text(
                        "That is the error after one bit. It adds up until the stop bit.",
                        "Questo è l'errore dopo un bit. Si somma fino al bit di stop.",
                    ),
                ),
                Mistake(
                    lambda v: v["drift_percent"] / 9.5 * 8,
                    Text(
                        "The byte is longer: start bit, eight data bits, half of the stop bit.",
                        "Il byte è più lungo: start, otto bit di dati, metà dello stop.",
                    ),
                ),
            ],
            why=Text(
                "Nine and a half bits, each with the same small error: still below half a bit.",
                "Nove bit e mezzo, ognuno con lo stesso piccolo errore: ancora sotto mezzo bit.",
            ),
            hint=Text(
                "How long after the start is the middle of the stop bit, in bits?",
                "Quanto dopo lo start è il centro del bit di stop, in bit?",
            ),
            tolerance=0.03,
        ),
        Question(
            Text(
                "The host sends {character} with {host_baud}, the board expects {board_baud}. What"
                " does the board get?",
                "L'host manda {character} a {host_baud}, la scheda si aspetta {board_baud}. Che"
                " cosa riceve la scheda?",
            ),
            "result",
            given={"host_baud": 250_000.0, "character": "M"},
            options=list(_RESULTS.items()),
            mistakes=[
                Mistake(
                    lambda _: _RIGHT,
                    Text(
                        "The board reads every second bit only. Look at its marks in the picture.",
                        "La scheda legge solo un bit su due. Guarda i suoi segni nella figura.",
                    ),
                ),
                Mistake(
                    lambda _: _FRAMING,
                    Text(
                        "When the board looks for the stop bit, the host has long finished, and a"
                        " line at rest is high.",
                        "Quando la scheda cerca il bit di stop, l'host ha finito da tempo, e una"
                        " linea a riposo è alta.",
                    ),
                ),
            ],
            why=Text(
                "It reads `{received}`. Only a checksum can show that.",
                "Legge `{received}`. Solo una somma di controllo può mostrarlo.",
            ),
            hint=Text(
                "Draw the bits of the host, and read them at the times of the board.",
                "Disegna i bit dell'host, e leggili negli istanti della scheda.",
            ),
        ),
    ],
    source=Source("firmware/hal/avr/console.c", "console_start"),
    printer=OwnPrinter(
        Text(
            "`baud` of the board in the machine file must be the rate that its firmware was built"
            " with. If they differ, Passo reports that the board does not answer.",
            "`baud` della scheda nel file macchina deve essere la velocità con cui è stato"
            " compilato il suo firmware. Se non concordano, Passo riporta che la scheda non"
            " risponde.",
        ),
        page="machine",
    ),
    links=[
        Link(Text("Set up a board", "Prepara una scheda"), document="docs/how-to/set-up-a-board.md")
    ],
)
