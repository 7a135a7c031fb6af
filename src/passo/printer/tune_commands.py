"""Controllers and sensors of heaters: gains, tunes, traces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo import _core
from passo.config.sensors import Thermistor
from passo.errors import CommandError
from passo.heat.relay_tune import RelayTune, TuneError
from passo.heat.rules import M301_FULL_POWER, Gains
from passo.heat.step_tune import StepTune
from passo.printer.waits import Handler, Reply, Tuning, Wait
from passo.printer.wiring import sensor_of
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_KINDS = {-1: "bed", -2: "chamber"}  # H of M301 to M306; 0 and up: hotends
_USUAL_C = {"hotend": 200.0, "bed": 70.0, "chamber": 70.0}


class TuneCommands:
    """M301, M303 to M306 of one printer."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._machine = printer.machine
        self.sensors = {name: h.sensor for name, h in self._machine.heaters.items()}
        self.immediate: dict[str, Handler] = {
            "M301": self._gains,
            "M304": self._bed_gains,
            "M305": self._sensor,
            "M306": self._limits,
        }
        self.planned: dict[str, Handler] = {"M303": self._tune}

    def _named(self, words: dict[str, float], otherwise: int = 0) -> str:
        number = int(words.get("H", words.get("E", otherwise)))
        kind = _KINDS.get(number, "hotend")
        return self._printer.commands.heater(kind, max(number, 0))

    def number_of(self, name: str) -> int:
        """H of a heater: hotends from 0, the bed -1, a chamber -2."""
        kind = self._machine.heaters[name].kind
        for number, k in _KINDS.items():
            if k == kind:
                return number
        return [n for n, h in self._machine.heaters.items() if h.kind == kind].index(name)

    # -- gains ------------------------------------------------------------------------------------

    def _gains(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        return self._set_gains(self._named(words), words, reply)

    def _bed_gains(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        return self._set_gains(self._named({}, -1), words, reply)

    def _set_gains(self, name: str, words: dict[str, float], reply: Reply) -> Wait | None:
        given = {k: v / M301_FULL_POWER for k, v in words.items() if k in "PID"}
        heater = self._printer.connection.heaters[name]
        old = heater.control
        if not given:
            for line in self.gain_lines(name):
                reply.say(line)
            return None
        if min(given.values()) < 0:
            raise CommandError.bad_value("P, I and D", min(words.values()), "numbers of at least 0")
        if not isinstance(old, _core.PidControl):
            raise CommandError.of("heat.no-pid", axis=name)
        kp, ki, kd = given.get("P", old.kp), given.get("I", old.ki), given.get("D", old.kd)
        heater.set_control(_with_gains(old, kp, ki, kd))
        return None

    def gain_lines(self, *names: str) -> Iterator[str]:
        """M301 for each of these heaters that has gains, all if none is named."""
        for name in names or self._machine.heaters:
            control = self._printer.connection.heaters[name].control
            if isinstance(control, _core.PidControl):
                p, i, d = (g * M301_FULL_POWER for g in (control.kp, control.ki, control.kd))
                yield f"M301 H{self.number_of(name)} P{p:.10g} I{i:.10g} D{d:.10g}"

    # -- sensors and limits -----------------------------------------------------------------------

    def _sensor(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = self._named(words)
        sensor = self.sensors[name]
        given = {k: v for k, v in words.items() if k in "ABCRLO"}
        if not isinstance(sensor, Thermistor):
            raise CommandError.of("heat.no-thermistor", axis=name)
        if not given:
            for line in self.sensor_lines(name):
                reply.say(line)
            return None
        keys = {
            "A": "r25_ohm",
            "B": "beta_k",
            "C": "c_per_k",
            "R": "pullup_ohm",
            "L": "adc_offset_low",
            "O": "adc_offset_high",
        }
        changed = sensor.model_dump() | {keys[k]: v for k, v in given.items()}
        try:
            new = Thermistor.model_validate(changed)
        except ValueError:
            raise CommandError.bad_value(
                "A, B, C, R, L or O", 0.0, "values of a thermistor"
            ) from None
        self.sensors[name] = new
        config = self._machine.heaters[name].model_copy(update={"sensor": new})
        self._printer.connection.set_sensor(name, sensor_of(self._machine, name, config))
        return None

    def sensor_lines(self, *names: str) -> Iterator[str]:
        """M305 for each of these heaters with a thermistor, all if none is named."""
        for name in names or self._machine.heaters:
            s = self.sensors[name]
            if isinstance(s, Thermistor):
                yield (
                    f"M305 H{self.number_of(name)} A{s.r25_ohm:.10g} B{s.beta_k:.10g}"
                    f" C{s.c_per_k:.10f} R{s.pullup_ohm:.10g} L{s.adc_offset_low:.10g}"
                    f" O{s.adc_offset_high:.10g}"
                )

    def _limits(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = self._named(words)
        if set(words) - {"H", "E"}:
            raise CommandError.of("command.fixed", value=f"heaters.{name}")
        h = self._machine.heaters[name]
        reply.say(
            f"M306 H{self.number_of(name)} L{h.min_c:g} O{h.max_c:g}"
            f" C{h.max_power * M301_FULL_POWER:g} U{int(h.control.kind == 'pid')} T1"
        )
        return None

    # -- tunes ------------------------------------------------------------------------------------

    def _tune(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = self._named(words)
        config = self._machine.heaters[name]
        number = self.number_of(name)
        label = f"Hotend:{number}" if number >= 0 else config.kind.upper()
        target = words.get("S", _USUAL_C[config.kind])
        apply = "U" in command.text.upper()
        note = " (applied and stored)" if apply else ""
        tune: RelayTune | StepTune
        board = self._printer.connection.connection_of("heaters", name).board
        hz = float(board.clock_hz)
        try:
            if words.get("M", 0) or config.control.kind == "model":
                tune = StepTune(
                    label, target, clock_hz=hz, limit_c=config.max_c, with_fan=bool(config.fan)
                )
            else:
                cycles, rule = int(words.get("C", 5)), int(words.get("R", 0))
                tune = RelayTune(label, target, cycles, rule, clock_hz=hz, limit_c=config.max_c)
        except TuneError as error:
            reply.fail(str(error))
            return None
        for line in tune.begin(note):
            reply.say(line)
        self._before = self._printer.connection.heaters[name].control
        return Tuning(lambda: self._run(name, tune, reply), lambda: self._end(name, tune, apply))

    def _run(self, name: str, tune: RelayTune | StepTune, reply: Reply) -> bool:
        """Feeds what the sensor has said since the last call; True when the tune is over."""
        heater = self._printer.connection.heaters[name]
        if heater.target != tune.target_c:
            self._before = heater.control
            heater.take_samples()
            heater.set_control(tune.control)
            self._printer.set_target(name, tune.target_c, at_once=True)
        for sample in heater.take_samples():
            for line in tune.feed(sample):
                # A failed tune is no reason for a host to disconnect.
                reply.say(line.removeprefix("Error:"))
        if not tune.done:
            if heater.control != tune.control:
                heater.set_control(tune.control)
            fan = self._machine.heaters[name].fan
            if fan is not None and isinstance(tune, StepTune):
                self._printer.set_fan(fan, tune.fan)
        return tune.done or heater.fault is not None

    def _end(self, name: str, tune: RelayTune | StepTune, apply: bool) -> None:
        """The heater off and, where asked for, with what the tune has found."""
        printer = self._printer
        heater = printer.connection.heaters[name]
        printer.set_target(name, 0.0, at_once=True)
        fan = self._machine.heaters[name].fan
        if fan is not None and isinstance(tune, StepTune):
            printer.set_fan(fan, 0.0)
        heater.set_control(self._before)
        result = tune.result
        if not apply or result is None:
            return
        old = self._before
        if isinstance(result, Gains) and isinstance(old, _core.PidControl):
            heater.set_control(_with_gains(old, result.kp, result.ki, result.kd))
        elif isinstance(result, _core.HeatModel) and isinstance(old, _core.ModelControl):
            heater.set_control(_core.ModelControl(result, old.horizon_s))
        printer.store_settings()


def _with_gains(old: _core.PidControl, kp: float, ki: float, kd: float) -> _core.PidControl:
    return _core.PidControl(kp, ki, kd, old.filter_s, old.drive_min, old.drive_max, old.range_c)
