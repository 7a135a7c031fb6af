"""Converts a config.g to a draft of a machine file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.config.board_files import load_board
from passo.config.geometry_kinds import KINDS
from passo.config.importing.draft import Draft, bad
from passo.config.importing.rrf.config_g import ConfigG
from passo.config.importing.sources import Sources
from passo.config.importing.table import report, table_of
from passo.errors import ConfigError
from passo.geometry.delta import ANGLES, rise_mm

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.importing.draft import Value

TABLE = table_of(Path(__file__).with_name("table.toml"))
_KINDS = {0: "cartesian", 1: "corexy", 2: "corexz", 3: "delta"}
_LARGE = "octopus"  # a board with many sockets, for boards without a file
_PROBES = {9: "bltouch", 5: "fixed", 8: "fixed", 1: "fixed", 0: "manual"}
_MAX_C = {"bed": 125.0, "hotend": 285.0}  # of RepRapFirmware without M143
_START_MM, _ABOVE_MM = 10.0, 3.0
_MOST_PER_AXIS = 41
_IN_PLACE = "the commands of the file say no speed: give homing.NAME.fast and slow, from homeall.g"


def imported(path: Path, *, board: str | None = None) -> Draft:
    """The machine file for a config.g, with remarks, on simulated boards: RepRapFirmware's names of
    pins are not those of a board file. `board` is the name of a board file. Raises ConfigError for
    a file that cannot be read, and for values without which the machine cannot move."""
    source, draft = ConfigG(Sources().read(path), path.name), Draft()
    name = source.text("M550/P") or path.stem
    draft.put_head(path, name)
    _Conversion(source, draft, load_board(board or _LARGE)).put(board or _LARGE)
    return draft


class _Conversion:
    """One conversion to a machine on the sockets and outputs of a board."""

    def __init__(self, source: ConfigG, draft: Draft, board: Board) -> None:
        self._source, self._draft, self._board = source, draft, board
        kind = int(source.number("M669/K", source.number("M667/S", 0)))
        if kind not in _KINDS:
            place, limit = source.at("M669/K"), ", ".join(_KINDS.values())
            value = f"M669 K{kind}"
            raise ConfigError.of(
                "import.kinematics", place.file, place.line, value=value, limit=limit
            )
        self._kind = "delta" if source.words.keys() & {"M665/L"} else _KINDS[kind]
        self._heaters: dict[int, str] = {}

    def put(self, base: str) -> None:
        """Converts everything."""
        source, draft = self._source, self._draft
        place = source.at("M669/K")
        draft.put(("geometry", "kind"), self._kind, place)
        self._put("limits")
        if any(key.startswith("M566/") for key in source.words):
            draft.put(("limits", "junction"), "jerk", None)
        self._put_axes()
        for number in range(self._extruders()):
            name = f"e{number}" if number else "e"
            self._put_motor("E", name, number)
            self._put("extruder", letter=f"E#{number}", name=name, number=str(number))
        self._put_heaters()
        for number in dict.fromkeys((*source.named("M950", "F"), *source.named("M106", "P"))):
            self._part(f"M106 P{number}", lambda number=number: self._put_fan(number))
        self._part("M558", self._put_probe)
        self._part("M557", self._put_mesh)
        self._put_tools()
        draft.put(("board", "base"), base, None)
        text = f"the machine is simulated on the sockets and pins of {base}, which are not yours:"
        text += " import again with --board NAME if `passo firmware list` has your board, and check"
        draft.decide(source.at("M584/X"), "pins", f"{text} each pin")
        self._remark()

    def _put(self, group: str, **names: str) -> None:
        TABLE.put(self._draft, group, self._source, names)

    def _part(self, what: str, convert: Any) -> None:
        code = what.split()[0]
        place = next((c.place for c in self._source.commands if c.code == code), None)
        self._draft.attempt(place or self._source.at(code), what, convert, "the part")

    def _put_axes(self) -> None:
        source, draft = self._source, self._draft
        if self._kind == "delta":
            self._put_delta()
        for axis, motor in zip("xyz", KINDS[self._kind].motors, strict=True):
            letter = axis.upper()
            self._put("axis", axis=axis, letter=letter)
            if self._kind != "delta":
                self._put("travel", axis=axis, letter=letter)
            self._put_motor(letter, motor, 0)
            end = int(source.number(f"M574/{letter}", 0))
            name = motor if self._kind == "delta" else axis
            if end and not source.text(f"M574/{letter}/P"):
                end = 2 if self._kind == "delta" else end
            place = source.at(f"M574/{letter}")
            if end not in (1, 2):
                why = "M574 gives it no endstop"
                if self._kind != "delta":
                    draft.put_no_homing(axis, None, place, f"M574 {letter}", why)
                continue
            top = "max" if end == 2 else "min"
            at = self._carriage_mm if self._kind == "delta" else None
            draft.put(("homing", name, "direction"), top, place)
            position = at() if at else draft.number(("axes", axis, f"{top}_mm"))
            draft.put(("homing", name, "position"), position, place)
            stops = [*self._board.endstops]
            mark = "!" if source.text(f"M574/{letter}/P").startswith("!") else ""
            draft.put(("homing", name, "pin"), f"{mark}{stops['xyz'.index(axis)]}", place)
            draft.decide(place, f"M574 {letter}", _IN_PLACE)

    def _put_delta(self) -> None:
        source, draft = self._source, self._draft
        radius, reach = source.number("M665/R", 0.0), source.number("M665/B", 80.0)
        rods = (source.numbers("M665/L") * 3)[:3]
        if radius <= 0 or min(rods) <= radius:
            limit = f"more than the radius of {radius:g} mm"
            raise bad(source.at("M665/L"), "M665 L", source.text("M665/L"), limit)
        turns = [source.number(f"M665/{letter}", 0.0) for letter in "XYZ"]
        angles = [angle + turn for angle, turn in zip(ANGLES, turns, strict=True)]
        shape: tuple[tuple[str, Value, str], ...] = (
            ("radius", radius, "R"),
            ("rods", [*rods], "L"),
            ("angles", [*angles], "X"),
            ("limit_radius", reach, "B"),
        )
        for key, value, word in shape:
            draft.put(("geometry", key), value, source.at(f"M665/{word}"))
        top = source.number("M665/H", 0.0)
        ends = {"x": (-reach, reach, 0.0), "y": (-reach, reach, 0.0), "z": (0.0, top, top)}
        for axis, values in ends.items():
            for key, value in zip(("min_mm", "max_mm", "home_mm"), values, strict=True):
                draft.put(("axes", axis, key), value, source.at("M665/H"))

    def _carriage_mm(self) -> float:
        radius, rod = self._draft.number(("geometry", "radius")), self._source.numbers("M665/L")[0]
        return round(self._draft.number(("axes", "z", "max_mm")) + rise_mm(rod, radius), 6)

    def _drivers(self, letter: str) -> list[int]:
        """The numbers of the drivers of a letter; those on further boards count after the first."""
        found = self._source.text(f"M584/{letter}")
        if found:
            return [int(float(part.rpartition(".")[2])) for part in found.split(":")]
        return ["XYZ".index(letter)] if letter in "XYZ" else [3 + n for n in range(self._tools())]

    def _tools(self) -> int:
        return len([*self._source.named("M563", "P")])

    def _extruders(self) -> int:
        return min(len(self._drivers("E")), len(self._board.sockets) - 3)

    def _put_motor(self, letter: str, name: str, number: int) -> None:
        drivers = self._drivers(letter)
        drivers = drivers[number : number + 1] if letter == "E" else drivers
        taken = [value for key, (value, _) in self._draft.keys.items() if key[-1] == "socket"]
        for index, driver in enumerate(drivers):
            free = [socket for socket in self._board.sockets if socket not in taken]
            if not free:
                place, limit = self._source.at(f"M584/{letter}"), "a socket of the board"
                raise bad(place, f"M584 {letter}", str(driver), limit)
            every = [*self._board.sockets]
            wanted = every[driver] if driver < len(every) else free[0]
            socket = wanted if wanted in free else free[0]
            taken.append(socket)
            motor = f"{name}{index}" if index else name
            at = f"{letter}#{number}" if letter == "E" else letter
            self._put("stepper", name=motor, letter=at, driver=str(driver))
            place = self._source.at(f"M584/{letter}")
            self._draft.put(("steppers", motor, "socket"), socket, place)

    def _put_heaters(self) -> None:
        source = self._source
        bed = int(source.number("M140/H", 0))
        found = [*source.named("M950", "H")] or [*source.named("M305", "P")]
        nozzles = [number for number in sorted(set(found)) if number != bed]
        names = ({bed: "bed"} if bed in found else {}) | {
            n: f"hotend{i or ''}" for i, n in enumerate(nozzles)
        }
        for number, name in names.items():
            done = self._draft.attempt(
                source.at(f"M143/H{number}/S"),
                f"heater H{number}",
                lambda number=number, name=name: self._put_heater(number, name),
                "the heater",
            )
            if done:
                self._heaters[number] = name

    def _put_heater(self, number: int, name: str) -> None:
        source, path = self._source, ("heaters", name)
        place = source.at(f"M143/H{number}/S")
        self._draft.put((*path, "kind"), "bed" if name == "bed" else "hotend", place)
        self._put("heater", name=name, heater=str(number))
        most = source.number(f"M143/H{number}/S", _MAX_C["bed" if name == "bed" else "hotend"])
        self._draft.put((*path, "min_c"), 0.0, None)
        self._draft.put((*path, "max_c"), most, place)
        sensor = int(source.number(f"M950/H{number}/T", number))
        kind = source.text(f"M308/S{sensor}/Y").lower() or "thermistor"
        if kind == "pt1000":
            self._draft.put((*path, "sensor", "kind"), kind, source.at(f"M308/S{sensor}/Y"))
        elif kind == "thermistor":
            self._draft.put((*path, "sensor", "kind"), kind, source.at(f"M308/S{sensor}/P"))
            self._put("sensor", name=name, sensor=str(sensor))
        else:
            limit = "thermistor or pt1000: give the sensor of this heater by hand"
            raise bad(source.at(f"M308/S{sensor}/Y"), f"M308 S{sensor} Y", kind, limit)
        bang = source.number(f"M307/H{number}/B", 0.0) == 1
        self._draft.put((*path, "control", "kind"), "bang-bang" if bang else "pid", place)
        if not bang:
            self._draft.decide(place, f"heater H{number}", "tune it with M303, and send M500")

    def _put_fan(self, number: int) -> None:
        outputs = [name for name in self._board.outputs if "FAN" in name]
        source, name = self._source, "part" if number == 0 else f"fan{number}"
        place = source.at(f"M950/F{number}/C")
        if number >= len(outputs):
            raise bad(place, f"M950 F{number}", str(number), f"at most {len(outputs)} fans")
        path = ("fans", name)
        self._draft.put((*path, "pin"), outputs[number], place)
        self._put("fan", name=name, number=str(number))
        heated = [int(n) for n in source.numbers(f"M106/P{number}/H") if n >= 0]
        follows = [self._heaters[n] for n in heated if n in self._heaters]
        if follows:
            self._draft.put((*path, "follows"), follows[0], source.at(f"M106/P{number}/H"))
            self._put("fan_follows", name=name, number=str(number))
        elif number:
            self._draft.put((*path, "number"), number, place)

    def _put_probe(self) -> None:
        source, path = self._source, ("probe",)
        kind = _PROBES.get(int(source.number("M558/P", -1)))
        if kind is None:
            return
        place = source.at("M558/P")
        self._draft.put((*path, "kind"), kind, place)
        height = source.number("G31/Z", 0.7) if kind != "manual" else 0.0
        start = max(source.number("M558/H", _START_MM), height + _ABOVE_MM)
        self._draft.put((*path, "start_mm"), round(start, 3), source.at("M558/H"))
        if kind == "manual":
            return
        self._put("probe")
        offset = [source.number(f"G31/{letter}", 0.0) for letter in "XY"]
        self._draft.put((*path, "offset_mm"), [*offset], source.at("G31/X"))
        stops = [*self._board.endstops]
        self._draft.put((*path, "pin"), stops[3] if len(stops) > 3 else stops[2], place)
        if kind == "bltouch":
            self._draft.put((*path, "control_pin"), [*self._board.outputs][-1], place)

    def _put_mesh(self) -> None:
        source = self._source
        x, y = source.numbers("M557/X"), source.numbers("M557/Y")
        if len(x) < 2 or len(y) < 2 or ("probe", "kind") not in self._draft.keys:
            return
        spacing = (source.numbers("M557/S") * 2)[:2] or [20.0, 20.0]
        spans = (x[1] - x[0], y[1] - y[0])
        counts = [int(n) for n in source.numbers("M557/P") * 2][:2]
        counts = counts or [int(s / d) + 1 for s, d in zip(spans, spacing, strict=True)]
        counts = [min(max(count, 2), _MOST_PER_AXIS) for count in counts]
        place = source.at("M557/X")
        self._draft.put(("levelling", "method"), "mesh", place)
        self._draft.put(("levelling", "area"), [x[0], y[0], x[1], y[1]], place)
        self._draft.put(("levelling", "count"), [*counts], place)
        self._put("levelling")

    def _put_tools(self) -> None:
        """Makes a tool for each M563, if there are several, or if one has other fans than fan 0."""
        source, tools = self._source, list[Any]()
        for number in source.named("M563", "P"):
            drive = int(source.number(f"M563/P{number}/D", number))
            heater = self._heaters.get(int(source.number(f"M563/P{number}/H", -1)))
            offset = [source.number(f"G10/P{number}/{letter}", 0.0) for letter in "XYZ"]
            if drive < self._extruders():
                tools.append(
                    {"extruder": f"e{drive or ''}", "offset_mm": [*offset]}
                    | ({"heater": heater} if heater else {})
                    | ({"fans": fans} if (fans := self._fans_of(number)) else {})
                )
        if len(tools) > 1 or any("fans" in tool for tool in tools):
            self._draft.put(("tools",), tools, source.at("M563/P0/D"))

    def _fans_of(self, tool: int) -> list[str]:
        """The fans of a tool, unless it is fan 0 alone, which is what a tool has anyway. A fan that
        follows a heater is not one of them."""
        numbers = [int(number) for number in self._source.numbers(f"M563/P{tool}/F")]
        names = ["part" if number == 0 else f"fan{number}" for number in numbers]
        keys = self._draft.keys
        fans = [
            name
            for name in names
            if ("fans", name, "pin") in keys and ("fans", name, "follows") not in keys
        ]
        return [] if fans == ["part"] else fans

    def _remark(self) -> None:
        """Reports the commands that have no key, and lines that are not commands."""
        source, draft, known = self._source, self._draft, TABLE.notes("commands")
        for command in source.commands:
            row = known.get(command.code)
            if row is not None:
                report(draft, row, command.place, command.code)
        rest = [c for c in source.commands if c.code not in known and c.code not in source.used]
        quiet = ("G90", "G91", "G21", "M83", "M82", "T0")
        for command in [one for one in rest if one.code not in quiet]:
            draft.dropped(command.place, command.code, "it is not taken over")
        for place in source.skipped[:1]:
            text = "conditions, variables and indented lines are not read: set their keys by hand"
            draft.decide(place, f"{len(source.skipped)} lines", text)
