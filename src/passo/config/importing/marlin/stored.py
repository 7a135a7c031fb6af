"""The values that Marlin has stored in its EEPROM since it was built, from the commands in the
answer to M503."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import Draft, Place, bad
from passo.config.importing.marlin.conversion import TABLE
from passo.config.importing.marlin.stored_delta import put_delta, put_trims
from passo.config.importing.numbers import NUMBER, Read, number_of, plain
from passo.config.importing.table import Source

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.importing.draft import KeyPath, Value

_COMMAND = re.compile(r"(?:echo:|Config:)?\s*([GM]\d+)((?: +[A-Z]-?[\d.]*)*) *(?:;.*)?")
_WORD = re.compile(r"([A-Z])(-?[\d.]*)")
_AXES = {"X": "x", "Y": "y", "Z": "z"}
_OWN = ("M281", "M906")  # they change a key only if the draft has it
# These commands set nothing in a machine, or a value that Passo has by default.
_OTHERS = (
    "M21",
    "M82",
    "M83",
    "G20",
    "G21",
    "M145",
    "M149",
    "M155",
    "M200",
    "M217",
    "M413",
    "M420",
)
_ABOVE_MM = 3.0  # where a descent starts at least, above where the probe triggers


def put_stored(draft: Draft, text: str, name: str, motors: Mapping[str, str]) -> None:
    """Replaces the values of the draft by those of an answer to M503. `motors` are the first motors
    of X, Y and Z. Values that the draft does not have are reported. Raises ConfigError."""
    for number, line in enumerate(text.splitlines(), 1):
        found = _COMMAND.fullmatch(line.strip())
        if found is None:
            continue
        place = Place(name, number)
        words: dict[str, float] = {}
        for letter, value in _WORD.findall(found[2]):
            try:
                words[letter] = number_of(value or "0")
            except ValueError:
                raise bad(place, f"{found[1]} {letter}", value, NUMBER) from None
        _Line(draft, found[1], words, place, motors).put()


class _Line(Source):
    """A command with its words."""

    def __init__(
        self,
        draft: Draft,
        code: str,
        words: Mapping[str, float],
        place: Place,
        motors: Mapping[str, str],
    ) -> None:
        self._draft, self._code, self._words = draft, code, words
        self._place, self._motors = place, motors

    def put(self) -> None:
        """Sets the values of the command in the draft."""
        match self._code:
            case "M92":
                self._put_steps()
            case "M201" | "M203" | "M900":
                self._rows(self._code, extruder=self._extruder())
            case "M204" | "M281":
                self._rows(self._code)
            case "M205":
                self._rows("M205")
                if self._has(("limits", "junction")) == "jerk":
                    self._rows("M205_jerk", extruder=self._extruder())
            case "M301" | "M304":
                number = self._index("E")
                heater = "bed" if self._code == "M304" else f"hotend{number or ''}"
                if self._has(("heaters", heater, "control", "kind")) == "pid":
                    self._rows("M301", heater=heater)
            case "M851":
                self._put_probe()
            case "M593":
                for axis in "xyz":
                    if axis.upper() in self._words:
                        self._rows("M593", axis=axis)
            case "M425":
                self._put_backlash()
            case "M206":
                self._put_home_offsets()
            case "M218":
                self._put_nozzle()
            case "M665" if self._is_delta():
                put_delta(self._draft, self._words, self._place)
            case "M666" if self._is_delta():
                put_trims(self._draft, self._words, self._place)
            case "M906":
                self._put_currents()
            case code:
                if code not in _OTHERS:
                    self._drop(self._words)

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of a word, which is the last letter of the option; None without it."""
        found = self._words.get(option[-1])
        return None if found is None else (found, self._place)

    def _rows(self, group: str, **names: str) -> None:
        """Sets the keys of a group of the table whose own table the draft has."""
        found = Draft()
        TABLE.put(found, group, self, names)
        for path, (value, _) in found.keys.items():
            if self._code not in _OWN or path in self._draft.keys:
                self._set(path, value)

    def _drop(self, words: Mapping[str, float]) -> None:
        written = " ".join(f"{word}{value:g}" for word, value in words.items())
        text = "not taken over: send it to Passo, and M500, if Passo has the command"
        self._draft.dropped(self._place, f"{self._code} {written}".rstrip(), text)

    def _is_delta(self) -> bool:
        """Whether the draft is a delta whose carriages have endstops."""
        ends = [self._has(("homing", tower, "position")) for tower in "abc"]
        return self._has(("geometry", "kind")) == "delta" and None not in ends

    def _has(self, path: KeyPath) -> Value | None:
        return self._draft.keys.get(path, (None, None))[0]

    def _set(self, path: KeyPath, value: Value | None) -> None:
        """Sets a key of a table that the draft has."""
        if value is not None and any(key[:-1] == path[:-1] for key in self._draft.keys):
            self._draft.put(path, value, self._place)

    def _extruder(self) -> str:
        tool = self._index("T")
        return f"e{tool}" if tool else "e"

    def _index(self, letter: str) -> int:
        """The number of a tool or a hotend; 0 if the command does not give one."""
        name = f"{self._code} {letter}"
        return Read(self._words.get(letter, 0.0), name, self._place).whole(0, 99)

    def _put_steps(self) -> None:
        steppers = {key[1] for key in self._draft.keys if key[0] == "steppers"}
        for letter, axis in _AXES.items():
            for name in steppers:
                if re.fullmatch(rf"{self._motors[axis]}\d*", name):
                    self._rows("M92", letter=letter, name=name)
        self._rows("M92", letter="E", name=self._extruder())

    def _put_probe(self) -> None:
        """Sets the trigger height from the Z offset, which is below 0, and shifts the descent with
        it."""
        path, offset = ("probe",), self._has(("probe", "offset_mm"))
        if isinstance(offset, list):
            at = [self._words.get(axis, own) for axis, own in zip("XY", offset, strict=True)]
            self._draft.put((*path, "offset_mm"), [*at], self._place)
        keys = ("trigger_height_mm", "low_mm", "start_mm")
        old, low, start = (self._has((*path, key)) for key in keys)
        if "Z" not in self._words or not isinstance(old, int | float):
            return
        height = -self._words["Z"]
        self._set((*path, "trigger_height_mm"), height)
        if isinstance(low, int | float):
            self._set((*path, "low_mm"), round(low + height - old, 4))
        if isinstance(start, int | float) and start < height + _ABOVE_MM:
            self._set((*path, "start_mm"), round(height + _ABOVE_MM, 4))

    def _put_home_offsets(self) -> None:
        """Adds the offsets to the home positions, as M206 of Passo does."""
        left: dict[str, float] = {}
        for letter, offset in self._words.items():
            path = ("homing", letter.lower(), "position")
            if path in self._draft.keys:
                at = round(self._draft.number(path) + offset, 4)
                self._draft.put(path, at, self._place if offset else self._draft.keys[path][1])
            elif offset:
                left[letter] = offset
        if left:
            self._drop(left)

    def _put_nozzle(self) -> None:
        """Sets the offset of a tool."""
        tools, place = self._draft.keys.get(("tools",), ([], None))
        number = self._index("T")
        assert isinstance(tools, list)
        if number >= len(tools):
            self._drop(self._words)
            return
        tool = tools[number]
        assert isinstance(tool, dict)
        own = tool.get("offset_mm", [0.0, 0.0, 0.0])
        assert isinstance(own, list)
        at = [self._words.get(axis, old) for axis, old in zip("XYZ", own, strict=True)]
        new: list[Value] = [*tools]
        new[number] = {**tool, "offset_mm": [*at]}
        self._draft.put(("tools",), new, self._place if any(at) else place)

    def _put_currents(self) -> None:
        """Sets the currents of the drivers. I 1 is the second motor of an axis."""
        suffix = f"{self._index('I')}" if self._words.get("I", 0.0) > 0 else ""
        motors = {axis: f"{motor}{suffix}" for axis, motor in self._motors.items()}
        self._rows("M906", extruder=self._extruder(), **motors)

    def _put_backlash(self) -> None:
        fraction = self._words.get("F", 1.0)
        for letter, axis in _AXES.items():
            gap = self._words.get(letter)
            self._set(("backlash", f"{axis}_mm"), None if gap is None else plain(gap * fraction))
        self._rows("M425")
