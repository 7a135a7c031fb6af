"""Line numbers and checksums of a host: which damage they find."""

from __future__ import annotations

from passo.gcode.line_protocol import Line as Accepted
from passo.gcode.line_protocol import LineProtocol
from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table, edges

_LINES = ("N4 G28", "N5 M104 S210", "N6 G1 X12.5")
_DAMAGES = {
    "none": Text("none", "nessuno"),
    "bit": Text("one bit of the last character", "un bit dell'ultimo carattere"),
    "swap": Text("two last digits swapped", "due ultime cifre scambiate"),
    "twice": Text("the same bit in two characters", "lo stesso bit in due caratteri"),
    "lost": Text("the last character is lost", "l'ultimo carattere è perso"),
    "line": Text("the whole line is lost", "l'intera riga è persa"),
}
_ACCEPTED, _RESENT, _LATE = 0.0, 1.0, 2.0
_RESULTS = {
    _ACCEPTED: Text("the board accepts the line", "la scheda accetta la riga"),
    _RESENT: Text("the board asks for the line again", "la scheda richiede la riga"),
    _LATE: Text("only the next line shows it", "lo mostra solo la riga seguente"),
}


def _sums(text: str) -> list[int]:
    """The exclusive or of all characters up to each of them."""
    found: list[int] = []
    for code in text.encode():
        found.append((found[-1] if found else 0) ^ code)
    return found


def _checksum(text: str) -> int:
    return _sums(text)[-1]


def _damaged(text: str, damage: str) -> str:
    if damage == "bit":
        return text[:-1] + chr(ord(text[-1]) ^ 1)
    if damage == "swap":
        digits = [i for i, sign in enumerate(text) if sign.isdigit()]
        signs = list(text)
        first, second = digits[-2:]
        signs[first], signs[second] = signs[second], signs[first]
        return "".join(signs)
    if damage == "twice":
        digits = [i for i, sign in enumerate(text) if sign.isdigit()][-2:]
        return "".join(chr(ord(sign) ^ (i in digits)) for i, sign in enumerate(text))
    return text[:-1] if damage == "lost" else text


def _compute(line: str, damage: str) -> Outcome:
    sent = _checksum(line)
    arrived = _damaged(line, damage)
    protocol = LineProtocol()
    number = int(line[1 : line.index(" ")])
    protocol.last = number - 1
    wire = f"{arrived}*{sent}\n"
    if damage == "line":
        following = f"N{number + 1} G4 P0"
        wire = f"{following}*{_checksum(following)}\n"
    (found,) = protocol.feed(wire.encode())
    if isinstance(found, Accepted):
        result, reply = _ACCEPTED, "ok"
    else:
        result = _LATE if damage == "line" else _RESENT
        reply = f"Error:{found.reason}, Resend: {found.resend}"
    sums = _sums(line)
    places = [float(k) for k in range(len(line) + 1)]
    rows: list[list[Words]] = [
        [
            sign if sign != " " else Text("blank", "spazio"),
            str(ord(sign)),
            f"{ord(sign):08b}",
            total,
        ]
        for sign, total in zip(line, [f"{total:08b} = {total}" for total in sums], strict=True)
    ]
    return Outcome(
        numbers=[
            Number(
                "sent", Text("Checksum of the host", "Somma dell'host"), float(sent), decimals=0
            ),
            Number(
                "counted",
                Text("Exclusive or of what arrives", "Or esclusivo di ciò che arriva"),
                float(_checksum(arrived)),
                decimals=0,
            ),
            Number(
                "arrives", Text("Line that arrives", "Riga che arriva"), 0.0, words=wire.strip()
            ),
            Number("reply", Text("Reply", "Risposta"), 0.0, words=reply),
            Number("result", Text("Result", "Risultato"), result, words=_RESULTS[result]),
        ],
        graphs=[
            Graph(
                Text("Checksum after each character", "Somma dopo ogni carattere"),
                Text("characters", "caratteri"),
                Text("sum", "somma"),
                [
                    Line(
                        Text("host", "host"), *edges(places, [0.0, *(float(each) for each in sums)])
                    )
                ],
            )
        ],
        tables=[
            Table(
                Text(
                    "Exclusive or, character by character", "Or esclusivo, carattere per carattere"
                ),
                [
                    Text("character", "carattere"),
                    Text("code", "codice"),
                    Text("bits", "bit"),
                    Text("checksum so far", "somma finora"),
                ],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "checksum-and-resend",
    Text("A line with a checksum", "Una riga con somma di controllo"),
    Text(
        "A host sends a numbered line. Damage it, and see what Passo replies.",
        "Un host manda una riga numerata. Danneggiala, e guarda che cosa risponde Passo.",
    ),
    [
        Parameter(
            "line", Text("Line", "Riga"), _LINES[0], choices=[Choice(each) for each in _LINES]
        ),
        Parameter(
            "damage",
            Text("Damage", "Danno"),
            "none",
            choices=[Choice(key, words) for key, words in _DAMAGES.items()],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="checksum-and-resend",
    chapter=Chapter.ELECTRICITY,
    place=85,
    rows=(20,),
    minutes=20,
    title=Text("Checksums and resends", "Somme di controllo e reinvii"),
    goal=Text(
        "You compute the checksum of a line, and know which damage it does not find.",
        "Calcoli la somma di controllo di una riga, e sai quale danno non trova.",
    ),
    text=[
        Text(
            "A cable beside motors picks up noise. So a host numbers its lines and adds a checksum"
            " after `*`: the exclusive or (XOR) of all characters before it. For `{line}` it is"
            " {sent}.",
            "Un cavo accanto ai motori raccoglie disturbi. Perciò un host numera le righe e"
            " aggiunge una somma dopo `*`: l'or esclusivo (XOR) di tutti i caratteri precedenti."
            " Per `{line}` è {sent}.",
        ),
        Text(
            "The board computes the same. If a bit of the last character flips, it gets"
            " {bit.counted}, and replies `{bit.reply}`. The host sends the line again.",
            "La scheda calcola lo stesso. Se si inverte un bit dell'ultimo carattere, ottiene"
            " {bit.counted}, e risponde `{bit.reply}`. L'host rimanda la riga.",
        ),
        Text(
            "XOR counts for each bit only whether the number of ones is odd. The same bit wrong in"
            " two characters cancels itself, and the order of characters does not matter at all:"
            " with `{swap.arrives}` {swap.result}.",
            "XOR conta per ogni bit solo se il numero di uni è dispari. Lo stesso bit sbagliato in"
            " due caratteri si annulla, e l'ordine dei caratteri non conta affatto: con"
            " `{swap.arrives}` {swap.result}.",
        ),
        Text(
            "The line number finds what a checksum cannot: a line that is lost as a whole. The next"
            " line has a number that the board does not expect: `{gone.reply}`.",
            "Il numero di riga trova ciò che una somma non può: una riga persa per intero. La riga"
            " seguente ha un numero che la scheda non aspetta: `{gone.reply}`.",
        ),
        Text(
            "Between Passo and its boards frames carry a CRC of sixteen bits in place of XOR. It"
            " finds swapped characters and nearly all other damage.",
            "Tra Passo e le sue schede i pacchetti portano un CRC di sedici bit al posto dello XOR."
            " Trova i caratteri scambiati e quasi ogni altro danno.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "bit": {"damage": "bit"},
        "swap": {"line": "N5 M104 S210", "damage": "swap"},
        "gone": {"damage": "line"},
    },
    questions=[
        Question(
            Text(
                "Compute the checksum of `{line}`. The codes of its characters are in the table; do"
                " not forget the blank, `32`.",
                "Calcola la somma di `{line}`. I codici dei caratteri sono nella tabella; non"
                " dimenticare lo spazio, `32`.",
            ),
            "sent",
            given={"line": "N4 G28"},
            mistakes=[
                Mistake(
                    lambda v: float(int(v["sent"]) ^ 32),
                    Text(
                        "You left out the blank. All characters before `*` count.",
                        "Hai saltato lo spazio. Contano tutti i caratteri prima di `*`.",
                    ),
                ),
                Mistake(
                    lambda _: float(sum(b"N4 G28") % 256),
                    Text(
                        "You added the codes. Exclusive or has no carry: equal bits give zero.",
                        "Hai sommato i codici. L'or esclusivo non ha riporto: bit uguali danno"
                        " zero.",
                    ),
                ),
                Mistake(
                    lambda v: float(int(v["sent"]) ^ ord("*")),
                    Text(
                        "The `*` itself does not count any more.",
                        "Lo stesso `*` non conta più.",
                    ),
                ),
            ],
            why=Text(
                "Every character changes the bits that it has, and no others.",
                "Ogni carattere cambia i bit che ha, e nessun altro.",
            ),
            hint=Text(
                "Write the codes in binary, one below the other. A column with an odd number of"
                " ones gives one.",
                "Scrivi i codici in binario, uno sotto l'altro. Una colonna con un numero dispari"
                " di uni dà uno.",
            ),
            tolerance=0.0,
        ),
        Question(
            Text(
                "Of `{line}` the last two digits arrive swapped. What happens?",
                "Di `{line}` le ultime due cifre arrivano scambiate. Che cosa succede?",
            ),
            "result",
            given={"line": "N6 G1 X12.5", "damage": "swap"},
            options=list(_RESULTS.items()),
            mistakes=[
                Mistake(
                    lambda _: _RESENT,
                    Text(
                        "Compute it: `a XOR b` equals `b XOR a`. The sum stays right.",
                        "Calcola: `a XOR b` è uguale a `b XOR a`. La somma resta giusta.",
                    ),
                ),
                Mistake(
                    lambda _: _LATE,
                    Text(
                        "The next line has the expected number. It shows nothing.",
                        "La riga seguente ha il numero atteso. Non mostra nulla.",
                    ),
                ),
            ],
            why=Text(
                "XOR does not see the order. The axis moves to a wrong place without an error.",
                "XOR non vede l'ordine. L'asse va in un punto sbagliato senza errori.",
            ),
            hint=Text(
                "Does the exclusive or depend on the order of the characters?",
                "L'or esclusivo dipende dall'ordine dei caratteri?",
            ),
        ),
        Question(
            Text(
                "The host sends `{line}`, but the whole line is lost. Which part of the protocol"
                " shows it?",
                "L'host manda `{line}`, ma l'intera riga si perde. Quando si scopre?",
            ),
            "result",
            given={"line": "N6 G1 X12.5", "damage": "line"},
            options=[
                (_ACCEPTED, Text("Nothing shows it", "Non si scopre")),
                (_RESENT, Text("The checksum of that line", "Dalla somma di quella riga")),
                (_LATE, Text("The number of the next line", "Dal numero della riga seguente")),
            ],
            mistakes=[
                Mistake(
                    lambda _: _ACCEPTED,
                    Text(
                        "The lines are numbered. Which number does the board expect next?",
                        "Le righe sono numerate. Quale numero aspetta la scheda?",
                    ),
                ),
                Mistake(
                    lambda _: _RESENT,
                    Text(
                        "Its checksum is lost with it.",
                        "La sua somma si è persa con lei.",
                    ),
                ),
            ],
            why=Text(
                "The board replies `{reply}` and the host goes back to that line.",
                "La scheda risponde `{reply}` e l'host torna a quella riga.",
            ),
            hint=Text(
                "What does the board have, if nothing of the line arrives?",
                "Che cosa ha la scheda, se della riga non arriva nulla?",
            ),
        ),
    ],
    source=Source("src/passo/gcode/line_protocol.py", "LineProtocol.feed"),
    printer=OwnPrinter(
        Text(
            "Send a line with a wrong checksum from a terminal, and read the reply. A host that"
            " reports many resends has a bad cable, or a wrong baud rate.",
            "Manda da un terminale una riga con una somma sbagliata, e leggi la risposta. Un host"
            " che riporta molti reinvii ha un cavo cattivo, o un baud rate sbagliato.",
        ),
        command="N4 G28*24",
    ),
    links=[Link(Text("Serve hosts", "Servire gli host"), document="docs/reference/serve.md")],
)
