"""M105, and the line of temperatures that other commands send too."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from passo.board.reading import ABSOLUTE_ZERO_C
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import flag, ignored
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply, Wait

if TYPE_CHECKING:
    from passo.printer.commands.heater_control import ControlCommands
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State
    from passo.printer.watch.sensors import SensorWatch

_LETTERS = {"hotend": "T", "bed": "B", "chamber": "C"}


class TemperatureReport:
    """Reports the temperatures of one printer's heaters, and of its sensors with a letter."""

    def __init__(
        self, rig: LiveRig, state: State, controls: ControlCommands, sensors: SensorWatch
    ) -> None:
        self._rig, self._state, self._controls = rig, state, controls
        self._sensors = sensors

    def line(self) -> str:
        """`T:21.5 /0.0 B:21.0 /0.0 @:0 B@:0`: measured (-273.15 while the board reports nothing),
        target, power of 127."""
        rig = self._rig
        parts: list[str] = []
        powers: list[str] = []
        hotends = [n for n, h in rig.machine.heaters.items() if h.kind == "hotend"]
        at_work = hotends[-1] if hotends else ""  # if the tool has no hotend
        with suppress(CommandError):
            at_work = rig.commands.set_points.heater("hotend")
        for name, config in rig.machine.heaters.items():
            heater = rig.connection.heaters[name]
            # The board's last report of a heater is older than the halt.
            power = 0 if self._state.halted else round(heater.power * 127)
            letter = _LETTERS[config.kind]
            seen = rig.connection.reading(name, rig.queue.board_now)
            reading = f":{seen.number_c:.2f} /{heater.target:.2f}"
            if config.kind == "hotend":
                number = self._controls.number_of(name)
                if name == at_work:
                    parts.insert(0, f"T{reading}")
                    powers.insert(0, f"@:{power}")
                if len(hotends) > 1 and number is not None:
                    parts.append(f"T{number}{reading}")
                    powers.append(f"@{number}:{power}")
            else:
                parts.append(f"{letter}{reading}")
                powers.append(f"{letter}@:{power}")
        for name, shown in rig.machine.sensors.items():
            if shown.letter:
                celsius = self._sensors.celsius(name)
                parts.append(
                    f"{shown.letter}:{ABSOLUTE_ZERO_C if celsius is None else celsius:.2f}"
                )
        return " ".join(parts + powers)

    def _fractions(self) -> str:
        """`T0A:0.5120 BA:0.6100`: the readings of the sensors as fractions of full scale."""
        words: list[str] = []
        for name, config in self._rig.machine.heaters.items():
            number = self._controls.number_of(name) if config.kind == "hotend" else None
            letter = f"T{number or 0}" if config.kind == "hotend" else _LETTERS[config.kind]
            words.append(f"{letter}A:{self._rig.connection.heaters[name].fraction:.4f}")
        return " ".join(words)

    @command(
        "M105",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Reports the temperatures. With X also the raw readings of the sensors, as fractions of the"
        " ADC's full scale: T0A, BA, CA.",
        flag("X", "also the raw readings"),
        ignored("R T P S"),
        kind=Kind.QUIET,
    )
    def _temperatures(self, command: Command, reply: Reply) -> Wait | None:
        raw = any(word.startswith("X") for word in command.text.upper().split())
        reply.with_ok(self.line() + (f" {self._fractions()}" if raw else ""))
        return None
