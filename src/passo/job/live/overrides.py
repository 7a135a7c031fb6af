"""Overrides of a print that are not in its file: factors of speed, flow and fans."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.gcode.command import Command
from passo.job.live.journal import Change, meaning

if TYPE_CHECKING:
    from collections.abc import Callable

    from passo import _core
    from passo.job.live.runner import Runner
    from passo.printer.commands.program import Commands
    from passo.printer.control import Control
    from passo.printer.settings import Settings as PrinterSettings
    from passo.printer.wait_requests import Reply

_SET_BY = ("M42", "M106", "M107", "M220", "M221", "M355", "SET_PIN")


def overrides_of(job: _core.Job, commands: Commands) -> dict[str, float]:
    """The current factors for later lines, by name: "speed", "flow" with the number of the
    extruder, "fan" and "output" with their names."""
    flows = {f"flow {extruder}": flow for extruder, flow in enumerate(job.filament.flows)}
    fans = {
        f"fan {name}": commands.outputs.fans.get(name, 0.0)
        for name in commands.outputs.commanded_fans
    }
    outputs = {f"output {name}": value for name, value in commands.outputs.values.items()}
    return {"speed": job.limits.speed_factor, **flows, **fans, **outputs}


def override(job: _core.Job, commands: Commands, name: str, factor: float) -> None:
    """Sets a factor for later lines; does nothing if the machine does not have the part."""
    what, _, which = name.partition(" ")
    if what == "speed":
        job.limits.set_speed_factor(factor)
    elif what == "flow" and int(which) < len(job.filament.flows):
        job.filament.set_flow(int(which), factor)
    elif what == "fan" and which in commands.outputs.commanded_fans:
        commands.outputs.set_fan(which, factor)
    elif what == "output" and which in commands.outputs.values:
        commands.outputs.set_free(which, factor)


class Overrides:
    """The factors at the start of a print from the card, and those that consoles have set since,
    each with the number of bytes of the file that were read before it. Commands of the file are not
    included."""

    def __init__(self, control: Control, runner: Runner) -> None:
        self._control, self._runner = control, runner
        self._seen: dict[str, float] = {}
        self.held: dict[str, tuple[int, float]] = {}
        control.state.command_listeners.append(self._carried_out)

    def reset(self) -> None:
        """Call this when a print begins, or resumes after an interruption."""
        self._seen = self._now()
        offset = self._runner.offset
        self.held = {name: (offset, factor) for name, factor in self._seen.items()}

    def _now(self) -> dict[str, float]:
        return overrides_of(self._control.rig.job, self._control.rig.commands)

    def _carried_out(self, command: Command, reply: Reply) -> None:
        if not self._runner.active or command.code not in _SET_BY:
            return
        before, self._seen = self._seen, self._now()
        if self._runner.printing_from(reply):
            return
        offset = self._runner.offset
        changed = {n: (offset, x) for n, x in self._seen.items() if x != before.get(n)}
        self.held = self.held | changed


class Settings:
    """Detects settings and modes that consoles change during a print from the card. While
    `watched`, each change is passed to `changed` as commands for the new state."""

    def __init__(
        self,
        control: Control,
        settings: PrinterSettings,
        runner: Runner,
        watched: Callable[[], bool],
        changed: Callable[[Change], None],
    ) -> None:
        self._control, self._settings, self._runner = control, settings, runner
        self._watched, self._changed = watched, changed
        self._seen: list[str] = []
        control.state.line_listeners.append(self._line)
        control.state.command_listeners.append(self._carried_out)

    def reset(self) -> None:
        """Call this when a print begins or resumes: the current state is the reference."""
        self._seen = self._now()

    def held(self) -> Change:
        """All current settings and modes, as commands."""
        return self._change(self._now())

    def _now(self) -> list[str]:
        return meaning(self._settings) + self._control.rig.job.modes.gcode.split("\n")[1:]

    def _line(self, done: bool) -> None:
        if not self._watched():
            return
        before, self._seen = self._seen, self._now()
        # Modes that are set during a pause end with the pause.
        now = meaning(self._settings) if self._control.rig.job.stops.suspended else self._seen
        new = [line for line in now if line not in before]
        if done and new:
            self._tell(new)

    def _carried_out(self, command: Command, reply: Reply) -> None:
        """Called with each executed command; M302 takes effect before its line ends."""
        if command.code == "M302" and self._watched() and not self._runner.printing_from(reply):
            self._tell([line for line in meaning(self._settings) if line.startswith("M302 ")])

    def _tell(self, lines: list[str]) -> None:
        self._changed(self._change(lines))

    def _change(self, lines: list[str]) -> Change:
        units = self._control.rig.job.modes.gcode.split("\n")[-1]
        return self._runner.offset, ["G21", *lines, units]
