"""Checks of pins: each is known, has the needed function, and has one owner. Timers have one owner
too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import ceil
from typing import Any, Literal

from passo.config.board import WIPER_MAX, pin_behind
from passo.config.board_files import known_pins, meant_board
from passo.config.chips import Chip, Pulse, chip, chip_names
from passo.config.findings import Finding, array, did_you_mean, key_text, number, table, tables
from passo.config.klippers_firmware import runs_klippers
from passo.config.motion import MICROSTEPS
from passo.config.pin_names import MAIN, bare, named_on, placed, section
from passo.config.sensors import CONVERTERS
from passo.config.toml_lines import Path
from passo.config.trinamic import STALL_PINS

Raw = Mapping[str, Any]
Need = Literal[
    "digital",
    "enable",
    "switch",
    "select",
    "analog",
    "pwm",
    "receive",
    "send",
    "clock",
    "to-device",
    "from-device",
    "i2c-clock",
    "i2c-data",
    "data",
]

# Drivers that are set up over SPI: each needs the chip select of its socket.
_SPI_DRIVERS = ("TMC2130", "TMC2240", "TMC2660", "TMC5160")
_MOTOR_PINS: dict[str, Need] = {"step": "digital", "direction": "digital", "enable": "enable"}
_LINES: dict[str, Need] = {"scl_pin": "i2c-clock", "sda_pin": "i2c-data"}
# Functions of pins that several drivers, sensors or lights may share.
_WIRES: dict[str, Need] = {
    "uart_pin": "receive",
    "tx_pin": "send",
    "clock_pin": "clock",
    "mosi_pin": "to-device",
    "miso_pin": "from-device",
    **_LINES,
}
_SHARED = ("enable", *_WIRES.values())
_LED_PINS = ("red_pin", "green_pin", "blue_pin", "white_pin")
# The marks with an effect, by function; pins of other functions allow none.
_MARKS: dict[Need, str] = {
    "digital": "!",
    "enable": "!",
    "pwm": "!",
    "switch": "!^",
    "receive": "^",
}
_LOADS = ("heaters", "fans", "outputs", "laser", "mains")
_NEEDS = {"analog": "an analog input", "pwm": "a pin with hardware PWM"}


@dataclass(frozen=True, slots=True)
class Claim:
    """A part of the machine, at `path`, claims `pin` for the function that it needs. `written` is
    the value in the file: the pin, or the socket that contains it."""

    path: Path
    pin: str
    need: Need
    written: str


def check_pins(data: Raw) -> Iterator[Finding]:
    """Checks that boards and sockets exist, that each part is on one board, that each pin and timer
    has one suitable owner, and that each mark has an effect. Motors may share an enable pin, and
    drivers the wires for their registers, if the shared pin has the same marks everywhere. Pins are
    not checked while the board is unknown."""
    claims = list(machine_claims(data))
    boards = {MAIN: table(data, "board"), **dict(tables(data, "boards"))}
    if any("base" in board and meant_board(board["base"]) is None for board in boards.values()):
        return
    yield from _check_boards(claims, boards)
    yield from _check_parts(data)
    yield from _check_sockets(data)
    for name, board in boards.items():
        yield from _check_fitted(board, section(name))
        own = [claim for claim in claims if placed(claim.pin)[0] == name]
        yield from _Owners(data, name, board, own).check()


def machine_claims(data: Raw) -> Iterator[Claim]:
    """The claims of the machine's parts, in the usual order of the file's sections."""
    for name, stepper in tables(data, "steppers"):
        path = ("steppers", name)
        board, word = placed(str(stepper.get("socket")))
        socket = table(_board(data, board), "sockets", word)
        for key, need in _MOTOR_PINS.items():
            if f"{key}_pin" in stepper:
                yield from _claim((*path, f"{key}_pin"), stepper[f"{key}_pin"], need)
            else:
                yield from _of_socket(path, stepper, socket.get(key), need)
        for pin in array(socket, "microstep"):
            yield from _of_socket(path, stepper, pin)
        tmc = table(stepper, "tmc")
        if "cs_pin" in tmc:
            yield from _claim((*path, "tmc", "cs_pin"), tmc["cs_pin"], "select")
        elif stepper.get("driver") in _SPI_DRIVERS and "uart_pin" not in tmc:
            yield from _of_socket(path, stepper, socket.get("select"), "select")
        yield from _wires((*path, "tmc"), tmc)
        for key in STALL_PINS:
            yield from _claim((*path, "tmc", key), tmc.get(key), "switch")
    for part in ("heaters", "fans", "outputs", "servos", "sensors"):
        for name, content in tables(data, part):
            hardware: Need = "pwm" if content.get("pwm") == "hardware" else "digital"
            yield from _claim((part, name, "pin"), content.get("pin"), hardware)
            for i, pin in enumerate(array(content, "further_pins")):
                yield from _claim((part, name, "further_pins", i), pin, hardware)
            sensor = table(content, "sensor")
            need: Need = "select" if sensor.get("kind") in CONVERTERS else "analog"
            yield from _claim((part, name, "sensor_pin"), content.get("sensor_pin"), need)
            yield from _wires((part, name, "sensor"), sensor)
            counted = table(content, "tachometer").get("pin")
            yield from _claim((part, name, "tachometer", "pin"), counted, "switch")
    for name, content in tables(data, "lights"):
        hardware = "pwm" if content.get("pwm") == "hardware" else "digital"
        for key in _LED_PINS:
            yield from _claim(("lights", name, key), content.get(key), hardware)
        for key in ("pin", "data_pin", "clock_pin"):
            yield from _claim(("lights", name, key), content.get(key), "data")
        for key, need in _LINES.items():
            yield from _claim(("lights", name, key), content.get(key), need)
    for name, content in tables(data, "homing"):
        yield from _claim(("homing", name, "pin"), content.get("pin"), "switch")
        for stepper, pin in table(content, "stepper_pins").items():
            yield from _claim(("homing", name, "stepper_pins", stepper), pin, "switch")
    yield from _claim(("probe", "pin"), table(data, "probe").get("pin"), "switch")
    yield from _claim(("probe", "control_pin"), table(data, "probe").get("control_pin"))
    probe = table(data, "probe")
    for key, need in _LINES.items():
        yield from _claim(("probe", key), probe.get(key), need)
    yield from _claim(("probe", "intb_pin"), probe.get("intb_pin"), "switch")
    accelerometer = table(data, "accelerometer")
    yield from _claim(("accelerometer", "cs_pin"), accelerometer.get("cs_pin"), "select")
    yield from _wires(("accelerometer",), accelerometer)
    yield from _claim(("laser", "pin"), table(data, "laser").get("pin"), "pwm")
    for part in ("mains", "beeper"):
        yield from _claim((part, "pin"), table(data, part).get("pin"))
    for part in ("filament_sensors", "buttons"):
        for name, content in tables(data, part):
            analog = "resistance_ohm" in content or content.get("kind") == "width"
            need = "analog" if analog else "switch"
            yield from _claim((part, name, "pin"), content.get("pin"), need)
            second = table(content, "width").get("second_pin")
            yield from _claim((part, name, "width", "second_pin"), second, "analog")


def _board(data: Raw, name: str) -> Raw:
    return table(data, *section(name))


def _of_socket(path: Path, stepper: Raw, pin: object, need: Need = "digital") -> Iterator[Claim]:
    """The claim of a motor for a pin of its socket."""
    written = str(stepper.get("socket"))
    if isinstance(pin, str):
        yield Claim((*path, "socket"), named_on(placed(written)[0], pin), need, written)


def _check_boards(claims: list[Claim], boards: Mapping[str, Raw]) -> Iterator[Finding]:
    for name, board in boards.items():
        led = board.get("status_led")
        if isinstance(led, str) and placed(led)[0]:
            limit = "a pin of the board itself, without the name of one"
            yield Finding("config.value", (*section(name), "status_led"), led, limit)
    for claim in claims:
        name = placed(claim.pin)[0]
        if name not in boards:
            limit = "the name of one of the boards before the colon"
            hint = did_you_mean(name, [known for known in boards if known])
            yield Finding("config.value", claim.path, claim.written, limit, hint)


def _check_parts(data: Raw) -> Iterator[Finding]:
    """Checks that a motor has all its pins on one board, and that the sensor and the fan of a
    heater are on the heater's board, and that all of the accelerometer is on one board."""
    for name, stepper in tables(data, "steppers"):
        keys = ("step_pin", "socket", "direction_pin", "enable_pin")
        yield from _check_together(("steppers", name), stepper, keys)
        tmc = table(stepper, "tmc")
        first = stepper.get("step_pin", stepper.get("socket"))
        keys = ("socket", "cs_pin", "spi_bus", *_WIRES, *STALL_PINS)
        yield from _check_together(("steppers", name, "tmc"), {**tmc, "socket": first}, keys)
    keys = ("cs_pin", "spi_bus", *_WIRES, "i2c_bus")
    yield from _check_together(("accelerometer",), table(data, "accelerometer"), keys)
    keys = ("scl_pin", "sda_pin", "i2c_bus", "intb_pin")
    yield from _check_together(("probe",), table(data, "probe"), keys)
    for kind in ("heaters", "fans", "outputs"):
        for name, part in tables(data, kind):
            board = placed(str(part.get("pin")))[0]
            for i, pin in enumerate(array(part, "further_pins")):
                if "pin" in part and isinstance(pin, str) and placed(pin)[0] != board:
                    limit = f"a pin of the board of {kind}.{name}.pin, {board or 'the main one'}"
                    path = (kind, name, "further_pins", i)
                    yield Finding("config.conflict", path, pin, limit)
    for name, light in tables(data, "lights"):
        for keys in (("data_pin", "clock_pin"), tuple(_LINES)):
            yield from _check_together(("lights", name), light, keys)
    for name, shown in tables(data, "sensors"):
        sensor = table(shown, "sensor")
        yield from _check_together(("sensors", name, "sensor"), sensor, ("scl_pin", "sda_pin"))
    fans = dict(tables(data, "fans"))
    for name, content in fans.items():
        both = {"pin": content.get("pin"), "tachometer": table(content, "tachometer").get("pin")}
        yield from _check_together(("fans", name), both, ("pin", "tachometer"))
    for name, heater in tables(data, "heaters"):
        path = ("heaters", name)
        yield from _check_together(path, heater, ("pin", "sensor_pin"))
        fan = fans.get(str(heater.get("fan")))
        both = {"pin": heater.get("pin"), "fan": fan.get("pin")} if fan else {}
        yield from _check_together(path, both, ("pin", "fan"))


def _check_together(path: Path, part: Raw, keys: tuple[str, ...]) -> Iterator[Finding]:
    """Checks that all given keys are on the board of the first of them."""
    pins = {key: pin for key in keys if isinstance(pin := part.get(key), str)}
    for key, pin in pins.items():
        first, board = next((k, placed(p)[0]) for k, p in pins.items())
        if placed(pin)[0] != board:
            limit = f"a pin of the board of {key_text((*path, first))}, {board or 'the main one'}"
            yield Finding("config.conflict", (*path, key), pin, limit)


def _wires(path: Path, content: Raw) -> Iterator[Claim]:
    for key, need in _WIRES.items():
        yield from _claim((*path, key), content.get(key), need)


def board_claims(board: Raw, place: Path) -> Iterator[Claim]:
    """The claims of a board itself: its console, its reserved pins, and the parts plugged in."""
    for pin in array(table(board, "console"), "pins"):
        yield from _claim((*place, "console"), pin)
    for what in table(board, "reserved"):
        for pin in array(table(board, "reserved"), what):
            yield from _claim((*place, "reserved", what), pin)
    led = board.get("status_led")
    if isinstance(led, str) and not placed(led)[0]:
        yield from _claim((*place, "status_led"), led)
    for word in dict.fromkeys(map(str, array(board, "fitted"))):
        if word == "card":
            path, pins = (*place, "card"), table(board, "card")
        else:
            path, pins = (*place, "displays", word), table(board, "displays", word)
        for key, pin in pins.items():
            yield from _claim((*path, key), pin)


def _claim(path: Path, pin: object, need: Need = "digital") -> Iterator[Claim]:
    if isinstance(pin, str):
        yield Claim(path, pin, need, pin)


def _check_sockets(data: Raw) -> Iterator[Finding]:
    for name, stepper in tables(data, "steppers"):
        path = ("steppers", name)
        socket = stepper.get("socket")
        board, word = placed(str(socket))
        sockets = table(_board(data, board), "sockets")
        if isinstance(socket, str) and word not in sockets:
            hint, limit = did_you_mean(word, sockets), "a socket of the board"
            yield Finding("config.value", (*path, "socket"), socket, limit, hint)
        yield from _check_microsteps(stepper, path, _board(data, board), word)
        yield from _check_current(stepper, path, _board(data, board), word)
        for key in ("step_pin", "direction_pin"):
            if "socket" not in stepper and key not in stepper:
                limit = "a pin, or the key socket"
                yield Finding("config.missing-key", (*path, key), None, limit)


def _check_microsteps(stepper: Raw, path: Path, board: Raw, socket: str) -> Iterator[Finding]:
    """Checks that the pins of a socket can set the microsteps of the motor."""
    pins, levels = array(table(board, "sockets", socket), "microstep"), "microstep_levels"
    known = [
        key for key in table(board, levels) if len(array(table(board, levels), key)) == len(pins)
    ]
    microsteps = stepper.get("microsteps", MICROSTEPS)
    if pins and levels in board and str(microsteps) not in known:
        limit = f"what the pins of its socket can choose: {', '.join(known)}"
        yield Finding("config.value", (*path, "microsteps"), microsteps, limit)


def _check_current(stepper: Raw, path: Path, board: Raw, socket: str) -> Iterator[Finding]:
    """Checks that the board can set the current of the motor."""
    ampere = stepper.get("peak_current_a")
    if ampere is None:
        return
    path = (*path, "peak_current_a")
    steps = number(table(board, "current_setter"), "steps_per_ma")
    if "current" not in table(board, "sockets", socket) or not steps:
        limit = "no such key: the board does not set the current of this socket"
        yield Finding("config.conflict", path, ampere, limit)
    elif isinstance(ampere, int | float) and not 1 <= ampere * 1000 * steps <= WIPER_MAX:
        limit = f"{ceil(1 / steps) / 1000:g} to {WIPER_MAX / steps / 1000:.2f} A"
        yield Finding("config.value", path, ampere, limit)


def _check_fitted(board: Raw, place: Path) -> Iterator[Finding]:
    known = [*(["card"] if "card" in board else []), *table(board, "displays")]
    words = array(board, "fitted")
    for index, word in enumerate(words):
        if word in words[:index]:
            yield Finding("config.value", (*place, "fitted", index), word, "each thing once")
        elif word not in known:
            hint, limit = did_you_mean(word, known), "what has a place on this board"
            yield Finding("config.value", (*place, "fitted", index), word, limit, hint)


class _Owners:
    """The owner of each pin and each timer of one board, filled in while the claims are checked in
    order."""

    def __init__(self, data: Raw, name: str, board: Raw, claims: list[Claim]) -> None:
        self.data = data
        self.name = name
        self.board = board
        self.claims = claims
        self.names: Mapping[str, object] = table(self.board, "pins")
        self.known = known_pins(self.board)
        mcu = self.board.get("mcu")
        self.chip: Chip | None = chip(mcu) if mcu in chip_names() else None
        # Klipper's firmware uses the chip in another way, and reports conflicts itself.
        self.klippers = runs_klippers(self.board)
        self.pins: dict[str, Claim] = {}
        self.units: dict[str, Path] = {}

    def check(self) -> Iterator[Finding]:
        """The findings for claims that the board cannot fulfil, in the order of the claims."""
        owned: list[Claim] = []
        for claim in (*board_claims(self.board, section(self.name)), *self.claims):
            pin = bare(self._pin(claim))
            if self.known and pin not in self.known:
                yield self._unknown(claim)
                continue
            owner = self.pins.setdefault(pin, claim)
            if owner is claim:
                owned.append(claim)
            elif not _may_share(owner, claim):
                limit = f"a pin of its own: {pin} belongs to"
                yield Finding("config.conflict", claim.path, claim.written, limit, owner=owner.path)
            elif claim.need in _SHARED and self._marks(owner) != self._marks(claim):
                limit = f"{placed(owner.pin)[1]}, as it stands at"
                yield Finding("config.conflict", claim.path, claim.written, limit, owner=owner.path)
        for claim in (*self._status_led(), *self.claims):
            yield from self._check_marks(claim)
        for claim in self.claims:
            yield from self._check_level(claim)
        if not self.klippers:
            yield from self._check_steps()
        if self.chip:
            for claim in owned:
                yield from self._check_need(claim, self.chip)

    def _pin(self, claim: Claim) -> str:
        """The microcontroller's pin, with all marks."""
        return pin_behind(self.names, placed(claim.pin)[1])

    def _marks(self, claim: Claim) -> set[str]:
        """The marks that have an effect."""
        return set(self._pin(claim)) & set(_MARKS.get(claim.need, ""))

    def _check_marks(self, claim: Claim) -> Iterator[Finding]:
        pin, name = self._pin(claim), bare(claim.pin)
        for mark in "!^~":
            if claim.pin.removesuffix(name).count(mark) > 1:
                limit = f"at most one {mark} before {name}"
                yield Finding("config.conflict", claim.path, claim.written, limit)
            elif mark in pin and mark not in self._marks(claim):
                limit = f"no {mark} before {bare(pin)}: it does nothing here"
                yield Finding("config.conflict", claim.path, claim.written, limit)

    def _status_led(self) -> Iterator[Claim]:
        place = (*section(self.name), "status_led")
        return _claim(place, self.board.get("status_led"))

    def _check_level(self, claim: Claim) -> Iterator[Finding]:
        """Checks that an active-low output is not used as active high: a heater would heat while it
        is off. The name or a mark of the output shows its level."""
        pin = self._pin(claim)
        if claim.path[0] not in _LOADS or claim.need not in ("digital", "pwm") or "!" in pin:
            return
        outputs = table(self.board, "outputs")
        own = next((n for n in outputs if pin_behind(self.names, n) == f"!{pin}"), None)
        if own and "!" not in claim.pin:
            limit = f"{own} or !{pin}, since here it is on when low; !{own} is on when high"
            yield Finding("config.conflict", claim.path, claim.written, limit)

    def _unknown(self, claim: Claim) -> Finding:
        mcu = self.chip.name if self.chip else "the board's dictionary"
        hint = did_you_mean(bare(placed(claim.pin)[1]), {*self.known, *self.names})
        limit = f"a pin of {mcu} or a name on the board"
        if claim.written != claim.pin:
            limit = f"a socket with pins of {mcu}, not with {placed(claim.pin)[1]}"
        return Finding("config.value", claim.path, claim.written, limit, hint)

    def _check_steps(self) -> Iterator[Finding]:
        """Checks the number of motors: each compare unit times the steps of one motor, if the chip
        has such units."""
        sockets = table(self.board, "sockets")
        units = self.chip.compare_units if self.chip else ()
        motors = 0
        for name, stepper in tables(self.data, "steppers"):
            key = "socket" if "socket" in stepper else "step_pin"
            if placed(str(stepper.get(key)))[0] != self.name:
                continue
            motors += 1
            if self.chip and units and motors == len(units) + 1:
                limit = f"at most {len(units)} motors on one {self.chip.name}"
                yield Finding("config.conflict", ("steppers", name, key), stepper.get(key), limit)
            word = placed(str(stepper.get("socket")))[1]
            unit = table(sockets, word).get("compare")
            if not isinstance(unit, str):
                continue
            path = ("steppers", name, "socket")
            if unit not in units:
                hint, limit = did_you_mean(unit, units), "a compare unit of the chip"
                place = (*section(self.name), "sockets", word, "compare")
                yield Finding("config.value", place, unit, limit, hint)
                continue
            owner = self.units.setdefault(unit, path)
            if owner != path:
                limit = f"a compare unit of its own: {unit} belongs to"
                yield Finding("config.conflict", path, word, limit, owner=owner)

    def _check_need(self, claim: Claim, chip: Chip) -> Iterator[Finding]:
        pin = bare(self._pin(claim))
        if claim.need == "analog" and pin not in chip.adc:
            yield self._unsuited(claim, list(chip.adc))
        elif claim.need == "pwm":
            free = [p for p, ways in chip.pwm.items() if self.klippers or _free(ways, chip)]
            if pin not in chip.pwm:
                yield self._unsuited(claim, free)
            elif pin not in free:
                timer = chip.pwm[pin][0].timer
                why = f"{timer} {chip.timers[timer].firmware}"
                limit = f"a pin whose timer is free: {why}; {self._offer(free)}"
                yield Finding("config.conflict", claim.path, claim.written, limit)

    def _unsuited(self, claim: Claim, able: list[str]) -> Finding:
        limit = f"{_NEEDS[claim.need]}; {self._offer(able)}"
        return Finding("config.conflict", claim.path, claim.written, limit)

    def _offer(self, able: list[str]) -> str:
        """The free pins among `able`, by their names on the board."""
        printed: dict[str, str] = {}
        for name, pin in self.names.items():
            printed.setdefault(bare(str(pin)), name)
        free = [pin for pin in able if pin not in self.pins]
        words = [f"{printed[p]} ({p})" if p in printed and printed[p] != p else p for p in free]
        return f"free here: {', '.join(words)}" if words else "none is free here"


def _may_share(owner: Claim, claim: Claim) -> bool:
    """Whether two parts may share the pin: parts on a bus may, buttons on an analog input may, and
    the machine's beeper may be that of a display."""
    if claim.path == ("beeper", "pin") and owner.path[-1:] == ("beeper",):
        return True
    if owner.need == claim.need == "analog":
        return owner.path[0] == claim.path[0] == "buttons"
    return owner.need == claim.need and claim.need in _SHARED


def _free(ways: tuple[Pulse, ...], chip: Chip) -> bool:
    """Whether one of these timers is not used by the firmware."""
    return any(not chip.timers[pulse.timer].firmware for pulse in ways)
