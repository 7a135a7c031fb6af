"""The reference page of all commands, made from the dialect table."""

from __future__ import annotations

from passo.gcode.dialect import ANY, TABLE, Kind, Row

_HEAD = """# Commands

Made from the dialect table (`passo.gcode.reference`). Letters may be lower case, blanks between
words may be missing, `G01` is `G1`. A line may hold several commands; they run in order. A letter
comes once in a command: a second one is an error (M116 may name several heaters of a kind).

Numbers are decimal, and `X1E5` is X1 and E5. E with one to three digits directly after a digit is
an exponent only where it cannot be meant as a word:

- the command has another E (`E9.9e-05`, `X1E1 E2`), or E is no word of it (`M104 S2E2`);
- the digits have a plus or a minus and a zero (`X1E+1`, `X13.5E-03`);
- they have a minus, and the e is small after a capital (`X13.5e-3`), or the number has a point and
  a blank before its letter (`X13.5E-3`, but not `X10E-3` nor `G1X13.5E-3`).

Comments stand in parentheses or behind `;`. A line number (`N12`) is skipped. A last `*` with
digits that end such a line (`*71`) is its checksum and is checked. Where it is wrong and the
command takes a text (`N5 M486 A13*10`), it belongs to the text. Lines without a number may have a
checksum [on a console](serve.md#line-numbers-and-checksums) only. Anything that is not listed
below is skipped with one warning; a print does not begin if
[it may move the machine](../how-to/check-a-file.md) elsewhere.

A letter without a number, or with one beyond 1e9, is an error that names it, and nothing of the
command is carried out, unless the letter is listed below as one that may stand *alone*. Behind it
may stand a text in quotes, too. Temperatures may be `S nan`: the heater goes off.

## Which words belong to which command

A line is read from left to right.

- A G or M word begins a command; the words up to the next command are its own.
- Moves are more careful, with G0 to G3 and without, because T is also a move's duration in seconds,
  for which F does not count then: a T behind them begins a command if it is the number of a tool of
  the machine, otherwise it is the duration. An M behind them begins a command (`G1 X10 M400`),
  except one that is no whole number, and except on machines whose laser has the letter M: there it
  is a value of the move.
- A T with a whole number that stands before all commands is a command of its own (`T1 M6`).
- Words before the first command belong to it (`S12000 M3`). If one of them names an axis, F, I or
  J, they are a move of the kind of the last one, G1 if there was none.
- G17 to G21, G53, G90 and G91 have no words of their own: what stands behind them is such a move
  (`G90 X10`). So is what names an axis, F, I or J behind those that name no axes in any dialect,
  known here or not: G15, G40, G43, G49, G54 to G59.3, G61.1, G64, G69, G91.1 and G93 to G99
  (`G40 G49 X10`); and behind M3 to M9 the words that name an axis, and F (`M8 X10`).
- All other G words that are not known here (`G29`, `G52`) keep the words behind them, which are
  skipped with them. Other ways to move (G5, G33, G38, G73, G76, G81 to G89) also keep what stands
  without a command in later lines, as long as no G0 to G3 nor G80 comes.
- A T behind what has no words of its own is a command: behind M3 to M9, M82 and M83 (`M6 T1`), and
  behind those G words (G17, G40, …) where no move has begun (`G90 T1`).
- G10 with L is no retraction, and unknown.
- M117 and other commands whose argument is text, not words, take the rest of the line.
- A name of two letters or more (`SET_VELOCITY_LIMIT ACCEL=500`) takes the whole line.
- What is written for others is an unknown command, which a console hears of and a print without
  consoles is warned of once for each: a program number (`O1000`, with the name behind it), words
  that belong to no command (`D5`, `H1`), `T?` and `T-1`, lines that begin with `$` or `@`. So are
  lines that begin with `/`, which are skipped.
- Lines end with LF, CR LF or CR. A byte order mark in front of the first one means nothing.

## Arcs

The centre (I, J, K) counts from where the arc begins. Its distances from both ends may differ a
little, as rounded coordinates make them do: by 0.5 % of the larger one, or by 0.05 mm where that is
more, but never by more than 0.5 mm. Such an arc is a spiral; beyond that the line is an error that
names both distances. P is the number of turns.

An arc of at most 0.05 mm from end to end whose centre is its start (`I0 J0`, also with one of the
two left out), or whose radius (R) is smaller than half of that way, is a straight line, with its E,
Z and F: ArcWelder writes such arcs. Longer ones are errors, and so are arcs without I, J, K and R,
and those with R that end where they begin.

An arc that leaves the soft limits or the reach of the machine on its way is refused before it
moves, with nothing extruded.

## Offsets of tools

A change of tools moves nothing. The first move after it that names an axis other than those of
filament moves all axes by the difference of the offsets (`offset_mm`, M218), also axes that it does
not name. M218 of the tool in use acts the same way.

| the first move | what the machine does |
|---|---|
| lays no filament (G0, G1) | one move to the end of the line |
| lays filament | a travel at its F to where the line begins with the new nozzle, then the line |
| is an arc | the same, also without filament |
| is filament alone (`G1 E3`, G10, G11) | the axes stay; the next move carries out the offset |
| has G53 | axes that the line does not name stay; the next move carries out their offset |

M114 and the program count with the new nozzle as if the move had been carried out. Where an axis
has no room for the offset, the move is refused as out of range, and the offset stays to be carried
out. After homing, the offset of the homed axes counts at once. After a stop (M410), the program's
coordinates are those of the nozzle that has stopped.

## How slow a move may be

F and T may ask for any speed, but a move of more than 1,000,000 s (11.5 days) is an error, which
names what bounds its speed. M203 and VELOCITY take 0.001 mm/s at least, M201, M204 and ACCEL
0.1 mm/s²; with less they change nothing, and a warning tells so.

## The hop of a retraction

The hop of G10 (M207 Z) is no part of the program's Z: whatever the program does with G92, G60, G61
or other tools while the filament is drawn back, G11 ends where it means Z to be. A tool that
comes without being drawn back itself ends the hop, since it has no G11 to come. Homing Z ends it,
too, unless it goes back there (B). Where the limit of Z leaves no room for it, it is as high as
there is room, and where the motors do not reach, it is left out; G11 takes back what is left of it.

"""
_WHEN = """## When a command acts

- **immediate**: as soon as its line is reached, whoever moves the machine.
- **planned**: in its place among the moves.
- **exclusive**: when the machine stands; nobody else moves it meanwhile.
- **ahead**: before all lines that wait.

A print without consoles (`passo print`, `passo estimate`) knows nothing of hosts and cards: what
has a dot in the last column has no effect there, and what has a *p* waits for a person, which
takes no time. What has an *s* sets up a printer that is served, or its jobs and heat: a print
without consoles skips it with a warning. What has a dash does nothing anywhere; like all that
nobody carries out, it is accepted: a console hears why, once, and a print without consoles is
warned.

| command | parameters | when | what it does | |
|---|---|---|---|---|"""
_MARK = {
    Kind.MOTION: "",
    Kind.PRINTER: "",
    Kind.PERSON: "*p*",
    Kind.QUIET: "·",
    Kind.SERVED: "*s*",
    Kind.NOT_BUILT: "–",
}


def reference() -> str:
    """The page as Markdown."""
    rows = [
        f"| {r.code} | {_parameters(r)} | {r.when.value} | {r.text} | {_MARK[r.kind]} |"
        for r in TABLE
    ]
    return "\n".join([_HEAD.rstrip("\n") + "\n", _WHEN, *rows, ""])


def _parameters(row: Row) -> str:
    letters = "any letter" if row.bare == ANY else " ".join(row.bare or "")
    return "; ".join(filter(None, (row.parameters, letters and f"alone: {letters}")))
