"""M303: tunes a heater, and applies the result if the command asks for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from passo import _core
from passo.config.heat import HeatModel, PidControl
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import flag, ignored, integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.heat.relay_tune import RelayTune, TuneError
from passo.heat.rules import RULES, Gains
from passo.heat.step_tune import StepTune
from passo.printer.commands.heater_control import ControlCommands, heater_in, with_gains
from passo.printer.live_rig import LiveRig
from passo.printer.state import State
from passo.printer.targets import Targets
from passo.printer.wait_requests import Reply, Wait, WaitForTuning

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_STEP_RESPONSE = len(RULES)  # the R number after those of the relay rules: finds the model
_USUAL_C = {"hotend": 200.0, "bed": 70.0, "chamber": 70.0}


def _check(command: Command, machine: MachineConfig) -> None:
    """H and S of M303 on this machine. Raises CommandError."""
    config = machine.heaters[heater_in(command, machine)]
    target, least = command.value("S", _USUAL_C[config.kind]), max(config.min_c, 0.0)
    if target <= least:
        raise CommandError.bad_value("S", target, f"more than {least:g} C")


class TuneCommands:
    """Tunes the heaters of one printer; `controls` has their controllers."""

    def __init__(
        self, rig: LiveRig, state: State, targets: Targets, controls: ControlCommands
    ) -> None:
        self._rig, self._state = rig, state
        self._targets, self._controls = targets, controls
        self._machine = rig.machine

    @command(
        "M303",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Tunes heater H at temperature S: by relay oscillation in C cycles, R5 by a model. R is the"
        " rule for the gains. With U1 the result is in use until a restart; M500 stores it.",
        integer("H E", "the heater; -1 is the bed", -1, default=0),
        number("S", "the temperature", "°C"),
        integer("C", "the cycles of the relay oscillation", 1, default=5),
        integer("R", "the rule for the gains; 5: by a model", 0, _STEP_RESPONSE, default=0),
        flag("U", "uses the result"),
        ignored("F L D P"),
        kind=Kind.SERVED,
        valid=_check,
    )
    def _tune(self, command: Command, reply: Reply) -> Wait | None:
        name = heater_in(command, self._machine)
        config = self._machine.heaters[name]
        hotend = config.kind == "hotend"
        label = f"Hotend:{self._controls.number_of(name)}" if hotend else config.kind.upper()
        target = command.value("S", _USUAL_C[config.kind])
        tune: RelayTune | StepTune
        board = self._rig.connection.connection_of("heaters", name).board
        hz = float(board.clock_hz)
        try:
            cycles, rule = command.integer("C"), command.integer("R")
            if rule == _STEP_RESPONSE or config.control.kind == "model":
                tune = StepTune(
                    label, target, clock_hz=hz, limit_c=config.max_c, with_fan=bool(config.fan)
                )
                fits = config.control.kind == "model"
            else:
                step = self._controls.step_c(name, target)
                limit = config.max_c
                tune = RelayTune(
                    label, target, cycles, rule, clock_hz=hz, limit_c=limit, count_c=step
                )
                fits = config.control.kind == "pid"
        except TuneError as error:
            reply.fail(str(error))
            return None
        self._controls.take_back(name)  # after a tune that a halt has ended
        asked = command.flag("U")
        apply = asked and fits
        for line in tune.begin(" Apply result" if apply else ""):
            reply.say(line)
        use = self._use(name, asked=asked, fits=fits)
        return WaitForTuning(
            lambda: self._run(name, tune, use, reply), lambda: self._end(name, tune, apply)
        )

    def _use(self, name: str, *, asked: bool, fits: bool) -> str:
        """The line that says whether the result of a tune is in use."""
        if not asked:
            return "Not in use: the command has no U1"
        if not fits:
            kind = self._machine.heaters[name].control.kind
            return f'Not in use: the control of {name} is "{kind}", which this result is not for'
        stores = bool(self._state.stores)
        return f"In use until a restart{'. M500 stores it' if stores else ''}"

    def _run(self, name: str, tune: RelayTune | StepTune, use: str, reply: Reply) -> bool:
        """Feeds the readings of the sensor since the last call; True when the tune is over. `use`
        is the line before its result."""
        heater = self._rig.connection.heaters[name]
        if not self._controls.lent(name):
            self._controls.lend(name)
            heater.take_samples()
            heater.set_control(tune.control)
            self._targets.set_target(name, tune.target_c, at_once=True)
        if heater.target != tune.target_c:
            return True  # another command has switched it off, or changed its target
        for sample in heater.take_samples():
            for line in tune.feed(sample):
                # A failed tune must not make a host disconnect, so the reply is not an error.
                reply.say(line.removeprefix("Error:"))
        if not tune.done:
            if heater.control != tune.control:
                heater.set_control(tune.control)
            fan = self._machine.heaters[name].fan
            if fan is not None and isinstance(tune, StepTune):
                self._rig.set_fan(fan, tune.fan)
        if tune.result is not None:
            reply.say(use)
            for line in self._keys(name, tune.result):
                reply.say(line)
        return tune.done or heater.fault is not None

    def _keys(self, name: str, result: Gains | _core.HeatModel) -> Iterator[str]:
        """The lines for the machine file with the result of the tune."""
        yield f"To keep this, write in the machine file, in the table [heaters.{name}]:"
        if isinstance(result, Gains):
            old = self._machine.heaters[name].control
            kept = old.model_dump(exclude_unset=True) if isinstance(old, PidControl) else {}
            found = {"kp": result.kp, "ki": result.ki, "kd": result.kd}
            kept = {key: value for key, value in kept.items() if key not in ("kind", *found)}
            yield f"control = {_inline({'kind': 'pid'} | found | kept)}"
        else:
            keys = HeatModel.model_fields
            yield f"model = {_inline({key: getattr(result, key) for key in keys})}"

    def _end(self, name: str, tune: RelayTune | StepTune, apply: bool) -> None:
        """Switches the heater off, unless another command has changed its target, and uses the
        result if asked for."""
        self._controls.take_back(name)
        if self._state.halted:
            return  # all heaters are off already
        if self._rig.connection.heaters[name].target == tune.target_c:
            self._targets.set_target(name, 0.0, at_once=True)
        fan = self._machine.heaters[name].fan
        if fan is not None and isinstance(tune, StepTune):
            self._rig.set_fan(fan, 0.0)
        old, result = self._controls.control(name), tune.result
        if not apply or result is None:
            return
        if isinstance(result, Gains) and isinstance(old, _core.PidControl):
            self._controls.set_control(name, with_gains(old, result))
        elif isinstance(result, _core.HeatModel) and isinstance(old, _core.ModelControl):
            self._controls.set_control(name, _core.ModelControl(result, old.horizon_s))


def _inline(table: Mapping[str, str | float]) -> str:
    """An inline table of TOML, numbers to 4 significant digits."""
    rows = (
        f'{key} = "{value}"'
        if isinstance(value, str)
        else f"{key} = {numeral(float(f'{value:.4g}'))}"
        for key, value in table.items()
    )
    return f"{{ {', '.join(rows)} }}"
