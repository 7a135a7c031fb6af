"""The values that Marlin has stored in its EEPROM since it was built, from the commands in the
answer to M503."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place, bad
from passo.config.importing.marlin.stored_delta import put_delta, put_trims
from passo.config.importing.numbers import NUMBER, Read, number_of, plain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.importing.draft import Draft, KeyPath, Value

_COMMAND = re.compile(r"(?:echo:|Config:)?\s*([GM]\d+)((?: +[A-Z]-?[\d.]*)*) *(?:;.*)?")
_WORD = re.compile(r"([A-Z])(-?[\d.]*)")
_AXES = {"X": "x", "Y": "y", "Z": "z"}
_LIMITS = {"P": "print_accel_mm_s2", "R": "retract_accel_mm_s2", "T": "travel_accel_mm_s2"}
_GAINS = {"P": "kp", "I": "ki", "D": "kd"}
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


class _Line:
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
            case "M201" | "M203":
                self._put_each("accel_mm_s2" if self._code == "M201" else "speed_mm_s")
            case "M204":
                for letter, key in _LIMITS.items():
                    self._set(("limits", key), self._words.get(letter))
            case "M205":
                self._set(("limits", "junction_deviation_mm"), self._words.get("J"))
                if self._has(("limits", "junction")) == "jerk":
                    self._put_each("jerk_mm_s")
            case "M301" | "M304":
                self._put_gains()
            case "M851":
                self._put_probe()
            case "M900":
                self._set(("extruders", self._extruder(), "advance_s"), self._words.get("K"))
            case "M593":
                self._put_shaper()
            case "M425":
                self._put_backlash()
            case "M206":
                self._put_home_offsets()
            case "M218":
                self._put_nozzle()
            case "M281":
                self._set_own(("probe", "deploy_deg"), self._words.get("L"))
                self._set_own(("probe", "stow_deg"), self._words.get("U"))
            case "M665" if self._is_delta():
                put_delta(self._draft, self._words, self._place)
            case "M666" if self._is_delta():
                put_trims(self._draft, self._words, self._place)
            case "M906":
                self._put_currents()
            case code:
                if code not in _OTHERS:
                    self._drop(self._words)

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

    def _set(self, path: KeyPath, value: float | None) -> None:
        """Sets a key of a table that the draft has."""
        if value is not None and any(key[:-1] == path[:-1] for key in self._draft.keys):
            self._draft.put(path, value, self._place)

    def _set_own(self, path: KeyPath, value: float | None) -> None:
        """Sets a key that the draft has."""
        if value is not None and path in self._draft.keys:
            self._draft.put(path, value, self._place)

    def _extruder(self) -> str:
        tool = self._index("T")
        return f"e{tool}" if tool else "e"

    def _index(self, letter: str) -> int:
        """The number of a tool or a hotend; 0 if the command does not give one."""
        name = f"{self._code} {letter}"
        return Read(self._words.get(letter, 0.0), name, self._place).whole(0, 99)

    def _put_steps(self) -> None:
        for letter, axis in _AXES.items():
            motor = self._motors[axis]
            names = {key[1] for key in self._draft.keys if key[0] == "steppers"}
            for name in names:
                if re.fullmatch(rf"{motor}\d*", name):
                    self._set(("steppers", name, "steps_per_mm"), self._words.get(letter))
        self._set(("steppers", self._extruder(), "steps_per_mm"), self._words.get("E"))

    def _put_each(self, key: str) -> None:
        for letter, axis in _AXES.items():
            self._set(("axes", axis, key), self._words.get(letter))
        self._set(("extruders", self._extruder(), key), self._words.get("E"))

    def _put_gains(self) -> None:
        number = self._index("E")
        heater = "bed" if self._code == "M304" else f"hotend{number or ''}"
        path = ("heaters", heater, "control")
        if self._has((*path, "kind")) == "pid":
            for letter, gain in _GAINS.items():
                self._set((*path, gain), self._words.get(letter))

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
        """Sets the currents of the drivers, which Marlin counts in mA. I 1 is the second motor of
        an axis."""
        further = self._words.get("I", 0.0)
        suffix = f"{self._index('I')}" if further > 0 else ""
        for letter, axis in _AXES.items():
            path = ("steppers", f"{self._motors[axis]}{suffix}", "tmc", "run_current_a")
            self._set_current(path, self._words.get(letter))
        path = ("steppers", self._extruder(), "tmc", "run_current_a")
        self._set_current(path, self._words.get("E"))

    def _set_current(self, path: KeyPath, milliampere: float | None) -> None:
        if milliampere is not None:
            self._set_own(path, plain(milliampere / 1000))

    def _put_backlash(self) -> None:
        share = self._words.get("F", 1.0)
        for letter in "xyz":
            gap = self._words.get(letter.upper())
            if gap is not None:
                self._set(("backlash", f"{letter}_mm"), plain(gap * share))
        self._set(("backlash", "smooth_mm"), self._words.get("S"))

    def _put_shaper(self) -> None:
        for letter in "xyz":
            if letter.upper() in self._words:
                self._set(("shaping", letter, "frequency_hz"), self._words.get("F"))
                self._set(("shaping", letter, "damping"), self._words.get("D"))
