"""The reference page of all commands, made from their declarations."""

from __future__ import annotations

from passo.gcode.parameters import Form, shown
from passo.gcode.registry import Declaration, Kind, Subject, table

_HEAD = """# Commands

Made from the declarations of the commands (`passo.gcode.registry`):
[how a line is read](#how-a-line-is-read), [when a command acts](#when-a-command-acts), then the
commands by subject. Commands that do nothing are in
[a list of their own](#commands-without-an-effect).

## How a line is read

Letters may be lower case, blanks between words may be missing, `G01` is `G1`. A line may hold
several commands; they run in order. A letter comes once in a command: a second one is an error
(M116 may name several heaters of a kind).

Numbers are decimal, and `X1E5` is X1 and E5. E with one to three digits directly after a digit is
an exponent only where it cannot be a word:

- the command has another E (`E9.9e-05`, `X1E1 E2`), or the command has no parameter E
  (`M104 S2E2`);
- the digits have a plus or a minus and a zero (`X1E+1`, `X13.5E-03`);
- they have a minus, and the e is small after a capital (`X13.5e-3`), or the number has a point and
  a blank before its letter (`X13.5E-3`, but not `X10E-3` nor `G1X13.5E-3`).

Comments are in parentheses or after `;`. A line number (`N12`) is skipped. A last `*` with digits
that end such a line (`*71`) is its checksum and is checked. If it is wrong and the command takes a
text (`N5 M486 A13*10`), it belongs to the text. Lines without a number may have a checksum
[on a console](serve.md#line-numbers-and-checksums) only. A command that is not listed below is
skipped with one warning; a print does not start if
[it may move the machine](../how-to/check-a-file.md) on other firmware.

A file is text in UTF-8, with or without a byte order mark. Zero bytes at its end, as a file that
was cut off has them, and the Ctrl-Z of DOS with what follows it, are no part of the text; commands
after them are an error. Other characters that are not G-code are errors, each named for what it is:
a decimal comma (`E31,0`), a second decimal point, typographic dashes, quotes and blanks, UTF-16,
and parameters, expressions and placeholders (`#1`, `X[#1+1]`, `S{temp}`): they are not evaluated.

A letter without a number, or with a number beyond 1e9, is an error that names it. Nothing of the
command is carried out then, unless the letter is listed below as one that may stand *alone*. A text
in quotes may follow such a letter, too. Temperatures may be `S nan`: the heater goes off.

A letter that names no axis of the machine is an error in G0 to G3, G60, G61 and G92 (`G1 Q5`, and
`G1 U5` without an axis U), so that no part of a move is lost. H is the number of a tool in a line
with G43. These letters have no effect, and are noted once:

| written | by | why |
|---|---|---|
| A0, B0, C0 | CAM programs, Fusion 360 for one | the angle of a rotary axis that never turns |
| G92 E0 | slicers, for a machine without an extruder | the start of each file |

F0 in a line without a move changes nothing; Fusion 360 writes it.

## Which words belong to which command

A line is read from left to right.

- A G or M word starts a command; the words up to the next command are its parameters.
- Moves (G0 to G3, also without the G word) are more careful, because T is also the duration of a
  move in seconds, in place of F: a T after them starts a command if it is the number of a tool of
  the machine, otherwise it is the duration. An M after them starts a command (`G1 X10 M400`),
  except one that is not a whole number, and except on machines whose laser has the letter M: there
  it is a value of the move.
- A T with a whole number before all commands is a command of its own (`T1 M6`).
- Words before the first command belong to it (`S12000 M3`). If one of them names an axis, F, I or
  J, they are a move of the kind of the last one, G1 if there was none.
- G17 to G21, G53, G90 and G91 have no parameters: words after them are such a move (`G90 X10`). So
  is what names an axis, F, I or J after those that name no axes in any dialect, known here or not:
  G15, G40, G43, G49, G54 to G59.3, G61.1, G64, G69, G91.1 and G93 to G99 (`G40 G49 X10`); and after
  M3 to M9 the words that name an axis, and F (`M8 X10`).
- All other G words that are not known here (`G29`, `G52`) keep the words after them, which are
  skipped with them. Other ways to move (G5, G33, G38, G73, G76, G81 to G89) also keep words without
  a command in later lines, until G0 to G3 or G80.
- A T after a command without parameters is a command: after M3 to M9, M82 and M83 (`M6 T1`), and
  after those G words (G17, G40, …) where no move has started (`G90 T1`).
- G10 with L is not a retraction, and unknown.
- M117 and other commands whose argument is text, not words, take the rest of the line.
- A name of two letters or more (`SET_VELOCITY_LIMIT ACCEL=500`) takes the whole line.
- What is written for other programs is an unknown command: a console receives a warning, and a
  print without consoles warns once of each. These are a program number (`O1000`, with the name
  after it), words that belong to no command (`D5`, `H1`), `T?` and `T-1`, lines that start with `$`
  or `@`. Lines that start with `/` are skipped.
- Lines end with LF, CR LF or CR. A byte order mark at the start of the first line is skipped.

## Arcs

The centre (I, J, K) counts from the start of the arc. Its distances from both ends may differ a
little, as rounded coordinates make them do: by 0.5 % of the larger one, or by 0.05 mm where that is
more, but never by more than 0.5 mm. Such an arc is a spiral; beyond that the line is an error that
names both distances. P is the number of turns.

An arc of at most 0.05 mm from end to end is a straight line, with its E, Z and F, if its centre is
its start (`I0 J0`, also with one of the two left out), or if its radius (R) is smaller than half of
that distance: ArcWelder writes such arcs. Longer ones are errors. So are arcs without I, J, K and
R, and those with R that end where they start.

An arc that leaves the soft limits or the reach of the machine is refused before it moves, with
nothing extruded.

## Offsets of tools

A change of tools moves nothing. The first move after it that names an axis other than those of
filament moves all axes by the difference of the offsets (`offset_mm`, M218), also axes that it does
not name. M218 of the tool in use acts the same way.

| the first move | what the machine does |
|---|---|
| does not extrude (G0, G1) | one move to the end of the line |
| extrudes | a travel at its F to the start of the line with the new nozzle, then the line |
| is an arc | the same, also without filament |
| is filament alone (`G1 E3`, G10, G11) | the axes stay; the next move carries out the offset |
| has G53 | axes that the line does not name stay; the next move carries out their offset |

M114 and the program count with the new nozzle as if the move had been carried out. Where an axis
has no room for the offset, the move is refused as out of range, and the offset is still carried out
by a later move. After homing, the offset of the homed axes counts at once. After a stop (M410), the
program's coordinates are those of the nozzle that has stopped.

## How slow a move may be

F and T may ask for any speed, but a move of more than 1,000,000 s (11.5 days) is an error, which
names what limits its speed. M203 and VELOCITY take 0.001 mm/s at least, M201, M204 and ACCEL
0.1 mm/s²; with less they change nothing, and there is a warning.

## The hop of a retraction

The hop of G10 (M207 Z) does not belong to the program's Z: whatever the program does with G92, G60,
G61 or other tools while the filament is retracted, G11 ends at the Z of the program. A tool that is
not retracted itself ends the hop when it is selected, since no G11 of it follows. Homing Z ends the
hop, too, unless Z returns (B). Where the limit of Z leaves too little room, the hop is as high as
possible, and where the motors do not reach, there is none; G11 takes back what there is.

"""
_WHEN = """## When a command acts

| when | what that means |
|---|---|
| immediate | as soon as its line is reached, also while another source moves the machine |
| planned | in its place among the moves |
| exclusive | at standstill; no other source moves the machine until the command is done |
| ahead | before all lines that wait |

The last column says what `passo print` and `passo estimate` do with a command, which have neither
hosts nor an SD card:

| without consoles | what that means |
|---|---|
| | the command acts |
| no effect | it is accepted and has no effect |
| no wait | it waits for the user, which takes no time |
| probed | with a probe, `passo print` measures the simulated bed; else it is skipped |
| skipped | it sets up a served printer, its jobs or its heat; it is skipped with a warning |
"""
_WITHOUT_EFFECT = """## Commands without an effect

Passo accepts these commands and does nothing. A console receives the reason once. `passo print`
warns of those that are marked, since the file may rely on them. Commands that level the bed stop a
print on a machine without a probe: [check a file](../how-to/check-a-file.md).

| command | why it does nothing | warning |
|---|---|---|"""
_COLUMNS = """| command | parameters | when | what it does | without consoles |
|---|---|---|---|---|"""
_MARK = {
    Kind.USER: "no wait",
    Kind.QUIET: "no effect",
    Kind.SERVED: "skipped",
    Kind.PROBED: "probed",
}


def reference() -> str:
    """The page as Markdown."""
    lines = [_HEAD.rstrip("\n") + "\n", _WHEN]
    rows = list(table().values())
    for subject in Subject:
        if subject is not Subject.NO_EFFECT:
            lines += [f"## {subject.value}\n", _COLUMNS]
            lines += [_row(row) for row in rows if row.subject is subject]
            lines.append("")
    lines.append(_WITHOUT_EFFECT)
    for row in rows:
        if row.subject is Subject.NO_EFFECT:
            lines.append(
                f"| {row.code} | {row.text} | {'yes' if row.kind is Kind.NOT_BUILT else ''} |"
            )
    return "\n".join([*lines, ""])


def _row(row: Declaration) -> str:
    mark = _MARK.get(row.kind, "")
    return f"| {row.code} | {_parameters(row)} | {row.when.value} | {row.text} | {mark} |"


def _parameters(row: Declaration) -> str:
    lines = [f"`{p.usage}` {p.text}".replace("|", "\\|") for p in shown(row.parameters)]
    for form, says in ((Form.REFUSED, "refused"), (Form.IGNORED, "no effect")):
        names = " ".join(name for p in row.parameters if p.form is form for name in p.names)
        lines += [f"{says}: {names}"] if names else []
    return "<br>".join([*lines, *(["any other letter"] if row.takes_anything else [])])
