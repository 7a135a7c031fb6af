"""M3 to M5, M106 and M107: laser, spindle and fans of a program."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from passo.config.outputs import timed_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import AT_ONCE, ignored, number
from passo.gcode.registry import Subject, When, command, in_program
from passo.printer.commands.ranges import beyond
from passo.printer.commands.tool_fans import ToolFans

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.commands.plan import Plan
    from passo.printer.wait_requests import Reply

_SETTINGS = "UIHLXT"  # of M106
_FULL_FAN = 255  # S of M106


class Outputs:
    """The outputs that the program of one job sets. `full_scale` has the value for fully on of each
    timed output of the machine, in their order."""

    def __init__(
        self, machine: MachineConfig, job: _core.Job, full_scale: list[int], plan: Plan
    ) -> None:
        self._machine, self._job, self._plan = machine, job, plan
        names = machine.timed_outputs
        self._outputs = {name: (i, full_scale[i]) for i, name in enumerate(names)}
        self._further = {
            name: [self._outputs[pin][0] for pin, _ in pins]
            for name, pins in machine.further_pins.items()
        }
        self.fans: dict[str, float] = {}  # the last commanded speeds, 0 to 1
        self._tool_fans = ToolFans(machine)
        # the last commanded values of the outputs that are not fixed, 0 to 1
        self.values = {n: o.start for n, o in machine.outputs.items() if not o.fixed}
        # the clock at which the planned value of each output takes effect
        self._acts_at: dict[str, float] = {}
        self._spindle = 0.0
        self._spindle_mode = ""  # M3: constant power, M4: power proportional to the speed, or off
        if machine.laser:
            job.outputs.set_laser(*self._outputs["laser"])

    def plan_forgotten(self) -> None:
        """Call this when the plan is discarded, and its output values with it."""
        self._acts_at.clear()

    def set_output(self, output: str, share: float, *, at_once: bool = False) -> bool:
        """Sets an output, 0 to 1, when the moves so far are done. With `at_once` it is set now,
        until the next planned value takes effect. Returns whether the value stays: no planned one
        follows."""
        index, full = self._outputs[output]
        value, stays = round(min(max(share, 0.0), 1.0) * full), True
        if not at_once:
            self._acts_at[output] = self._job.clock + self._job.plan.queued_ticks
        for pin in (index, *self._further.get(output, ())):
            if at_once:
                stays = self._acts_at.get(output, -inf) <= self._plan.record_at_once(pin, value)
            else:
                self._job.outputs.record(pin, value)
        return stays

    def set_here(self, name: str) -> bool:
        """Whether the last planned value of one of the machine's `outputs` takes effect at the end
        of the moves so far, so that another one would replace it."""
        end = self._job.clock + self._job.plan.queued_ticks
        return self._acts_at.get(timed_name(name), -inf) >= end

    def set_fan(self, name: str, share: float, *, at_once: bool = False) -> None:
        """Like `set_output`, for a fan by its name."""
        if self.set_output(self._machine.fan_output(name), share, at_once=at_once):
            self.fans[name] = share

    def set_free(self, name: str, share: float, *, at_once: bool = False) -> None:
        """Like `set_output`, for one of the machine's `outputs`, by its name there."""
        if self.set_output(timed_name(name), share, at_once=at_once):
            self.values[name] = share

    def reset(self, *, adopted: bool) -> None:
        """Call this after the boards have started: sets the values that boards cannot start with.
        If the boards are `adopted`, all outputs take their values of the start."""
        for name, output in self._machine.outputs.items():
            if adopted or (output.pwm == "software" and 0 < output.start < 1):
                self.set_output(timed_name(name), output.start, at_once=True)

    # -- laser and spindle ------------------------------------------------------------------------

    @command(
        "M3",
        Subject.OUTPUTS,
        When.PLANNED,
        "Switches the laser or spindle on.",
        number("S", "the power or the speed"),
        ignored("I"),
    )
    @command(
        "M4",
        Subject.OUTPUTS,
        When.PLANNED,
        "Switches the laser on, with power in proportion to the speed; it is off at standstill and"
        " in G0.",
        number("S", "the power or the speed"),
        ignored("I"),
    )
    def _spindle_start(self, command: Command, _: Reply) -> None:
        self._spindle = command.value("S", self._spindle)
        self._spindle_mode = command.code
        self._laser()

    @command(
        "M5",
        Subject.OUTPUTS,
        When.PLANNED,
        "Switches the laser or spindle off.",
        ignored("I"),
    )
    def _spindle_stop(self, _: Command, __: Reply) -> None:
        self.laser_off()

    @in_program("S")
    def _spindle_power(self, command: Command, _: Reply) -> None:
        self._spindle = command.value("S", self._spindle)
        self._laser()

    def laser_off(self) -> None:
        """Switches laser or spindle off when the moves so far are done, until a command switches it
        on again."""
        self._spindle_mode = ""
        self._laser()

    @property
    def laser_stays_on(self) -> bool:
        """Whether the laser stays on at standstill."""
        return bool(self._machine.laser) and self._spindle_mode == "M3" and self._spindle > 0

    def blank_laser(self, *, blanked: bool) -> None:
        """Blanks the laser when the moves so far are done, or restores it."""
        if blanked:
            self.set_output("laser", 0.0)
        else:
            self._laser()

    def _laser(self) -> None:
        if self._machine.laser:
            share = max(0.0, self._spindle / self._machine.laser.full_scale)
            self._job.outputs.follow_speed(share if self._spindle_mode == "M4" else 0.0)
            self.set_output("laser", share if self._spindle_mode == "M3" else 0.0)

    # -- fans -------------------------------------------------------------------------------------

    @property
    def commanded_fans(self) -> list[str]:
        """The fans that commands control, not a heater or motors."""
        return [name for name, fan in self._machine.fans.items() if fan.commanded]

    def fans_off(self) -> None:
        """Switches all fans off, as soon as the moves so far are done."""
        for fan in self.commanded_fans:
            self.set_fan(fan, 0.0)

    def tool_changed(self, tool: int) -> None:
        """Sets the fans of this tool to the speed of the program, and switches those of other tools
        off."""
        for fan, share in self._tool_fans.change(tool, self.fans).items():
            self.set_fan(fan, self._power(fan, share))

    def follow_tool(self) -> None:
        """Call this when the active tool has changed without a command."""
        self._tool_fans.tool = self._job.tool

    @command(
        "M106",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the speed of fan P, without S to full speed; without P, of the fans of the tool, by"
        " its factor. F: at once. Settings without S (U I H L X T, F with a number) have no effect:"
        " the machine file has them.",
        number("S", "the speed", low=0, high=_FULL_FAN, clamped=True),
        number("P", "the fan; without it, those of the tool"),
        AT_ONCE,
        ignored("U I H L X T C B"),
        forced=True,
    )
    def _fan_on(self, command: Command, reply: Reply) -> None:
        words = command.words()
        share, given = None, words.get("S", _FULL_FAN)
        if "S" in words or not ("F" in words or command.has(*_SETTINGS)):
            share = min(max(given / _FULL_FAN, 0.0), 1.0)
        self._set_fan(command, share, reply)
        if "F" in words:
            reply.note("M106 F", "M106 sets no frequency; the machine file has it")
        elif share is None:
            reply.note("M106", "M106 sets speeds, by S; the machine file has the settings")
        if share is not None and (note := beyond("M106 S", given, (0, _FULL_FAN))):
            reply.note(note, note)

    @command(
        "M107",
        Subject.OUTPUTS,
        When.PLANNED,
        "Switches fan P off; without P, the fans of the tool. F: at once.",
        number("P", "the fan; without it, those of the tool"),
        AT_ONCE,
        forced=True,
    )
    def _fan_off(self, command: Command, reply: Reply) -> None:
        self._set_fan(command, 0.0, reply)

    def _set_fan(self, command: Command, share: float | None, reply: Reply) -> None:
        """Sets a fan to the fraction `share`; None changes only its settings. If P does not name a
        fan, it raises CommandError; but macros, which are written for other printers, go on. A
        machine without fans ignores a command without P."""
        fans = self._machine.fans
        number = command.value("P", None)
        at_once = command.has("F") and command.value("F", None) is None
        numbers = [fans[name].number for name in self.commanded_fans]
        if number is not None and number not in numbers:
            limit = ", ".join(map(str, numbers)) or "no fan"
            if self._job.program.macro_depth:
                text = f"{command.code} P{number:g} does nothing here. The fans are {limit}."
                reply.note(f"{command.code} P{number:g}", text)
                return
            raise CommandError.bad_value("P", number, limit)
        if share is None:
            return
        if number is None:
            shares = self._tool_fans.set_speed(share)
        else:
            named = (name for name in self.commanded_fans if fans[name].number == number)
            shares = dict.fromkeys(named, share)
        for fan, speed in shares.items():
            self.set_fan(fan, self._power(fan, speed), at_once=at_once)

    def _power(self, fan: str, share: float) -> float:
        """The power of a fan at this fraction of its full speed."""
        config = self._machine.fans[fan]
        share = share if share >= config.off_below else 0.0
        return max(share * config.max_power, config.min_power if share > 0 else 0.0)
