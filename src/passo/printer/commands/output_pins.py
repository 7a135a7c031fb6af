"""SET_PIN, M42, M240 and M355: outputs that the machine file names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.parameters import ignored, integer, number, rest, text
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.lacking import NamedParts, report_lack
from passo.printer.commands.ranges import beyond
from passo.printer.stand_ins import PINS

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.commands.outputs import Outputs
    from passo.printer.skipped_commands import SkippedCommands
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply

_FULL = 255  # S of M42, P of M355
_PULSE_MS = 100  # an output that changes twice at one place has its first value for this time
_LACKS = "The machine file has no output for it ([outputs])."


class OutputPins:
    """The commands of one job that set outputs of the machine file. SET_PIN also sets the state of
    a pin that the file only keeps for macros, which is counted in `omitted`."""

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        outputs: Outputs,
        stand_ins: StandIns,
        omitted: SkippedCommands,
    ) -> None:
        self._all = {n: o for n, o in machine.outputs.items() if not o.fixed}
        self._job, self._outputs = job, outputs
        self._stand_ins = stand_ins
        self._named = NamedParts(self._all, _LACKS, PINS, job, stand_ins, omitted)
        self._light = next((n for n, o in self._all.items() if o.use == "light"), None)
        self._camera = next((n for n, o in self._all.items() if o.use == "camera"), None)
        self._brightness = 1.0  # of the light while it is on
        self._waited = set[str]()  # outputs whose first value has held

    @command(
        "SET_PIN",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets an output by its name; VALUE is from 0 to the `scale` of the output. If an output"
        " without pwm changes twice without a move in between, its first value holds for 0.1 s.",
        text("PIN", "the name of the output"),
        number("VALUE", "from 0 to the scale of the output"),
        lacks=_LACKS,
    )
    def _set_pin(self, command: Command, reply: Reply) -> None:
        name = self._named.find(command, "PIN", reply)
        if name is None:
            if (state := self._stand_ins.named(PINS, command.string("PIN"))) is not None:
                state["value"] = command.value("VALUE", 0.0)
            return
        for word in command.unknown():
            note = f"SET_PIN {word} does nothing here; the machine file has pwm_hz of {name}"
            reply.note(f"SET_PIN {word}", note)
        output = self._all[name]
        value = command.value("VALUE")
        if not 0 <= value <= output.scale or (output.pwm == "none" and 0 < value < output.scale):
            limit = f"0 to {output.scale:g}"
            if output.pwm == "none":
                limit = f"0 or {output.scale:g}: outputs.{name} has no pwm"
            raise CommandError.of("command.value", axis="VALUE", value=f"{value:g}", limit=limit)
        self._set(name, value / output.scale)

    @command(
        "M42",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the output with the `number` P. An output without pwm is on from S1.",
        integer("P", "the number of the output", 0, required=True),
        number("S", "the value", low=0, high=_FULL, clamped=True),
        ignored("I M T"),
        lacks=_LACKS,
    )
    def _set_number(self, command: Command, reply: Reply) -> None:
        numbers = {o.number: name for name, o in self._all.items() if o.number is not None}
        wanted, value = command.integer("P"), command.value("S", None)
        if wanted not in numbers:
            limit = ", ".join(map(str, numbers)) or "no output with a number"
            raise CommandError.bad_value("P", wanted, limit)
        if value is None:
            reply.note("M42", "M42 sets outputs, by S; the machine file has the settings")
            return
        if note := beyond("M42 S", value, (0, _FULL)):
            reply.note(note, note)
        self._set_share(numbers[wanted], value / _FULL)

    @command(
        "M355",
        Subject.OUTPUTS,
        When.PLANNED,
        "Switches the light of the machine on or off, and sets its brightness P. Without"
        " parameters it reports them.",
        number("S", "1: on, 0: off"),
        number("P", "the brightness", low=0, high=_FULL, clamped=True),
        lacks=_LACKS,
    )
    def _set_light(self, command: Command, reply: Reply) -> None:
        words = command.words()
        if self._light is None:
            report_lack(self._job, command, reply, _LACKS)
            return
        if "P" in words:
            self._brightness = min(max(words["P"] / _FULL, 0.0), 1.0)
        on = words.get("S", float(self._outputs.values[self._light] > 0)) > 0
        if words:
            self._set_share(self._light, self._brightness if on else 0.0)
        level = f"{round(self._brightness * _FULL)}" if on else "OFF"
        reply.say(f"echo:Case light: {level}")

    def _set_share(self, name: str, share: float) -> None:
        """Sets an output to a fraction of fully on. One without pwm is on above 0."""
        if self._all[name].pwm == "none":
            share = float(share > 0)
        self._set(name, share)

    def _set(self, name: str, share: float) -> None:
        """Sets an output to a fraction of fully on. If one without pwm changes twice without a move
        in between, the first value would have no effect: it holds for `_PULSE_MS`."""
        changes = self._all[name].pwm == "none" and share != self._outputs.values[name]
        if changes and name not in self._waited and self._outputs.set_here(name):
            self._waited.add(name)
            value = share * self._all[name].scale
            lines = f"G4 P{_PULSE_MS}\nSET_PIN PIN={name} VALUE={value:g}\n"
            self._job.program.insert(lines.encode())
            return
        self._waited.discard(name)
        self._outputs.set_free(name, share)

    @command(
        "M240",
        Subject.OUTPUTS,
        When.PLANNED,
        "Triggers the camera: its output is on for 0.1 s, at standstill.",
        rest(),
        lacks=_LACKS,
    )
    def _trigger(self, command: Command, reply: Reply) -> None:
        if self._camera is None:
            report_lack(self._job, command, reply, _LACKS)
            return
        full = self._all[self._camera].scale
        lines = [
            f"SET_PIN PIN={self._camera} VALUE={full:g}",
            f"G4 P{_PULSE_MS}",
            f"SET_PIN PIN={self._camera} VALUE=0",
        ]
        self._job.program.insert("".join(f"{line}\n" for line in lines).encode())
