"""The G-code of the machine file that runs before and after each descent of the probe."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from passo.errors import CommandError, Problem
from passo.motion.axis_slots import X, Z
from passo.printer.all_consoles import ToAllConsoles
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo.motion.probing import Prober
    from passo.printer.control import Control
    from passo.printer.state import State


class _Reply(ToAllConsoles):
    """Sends the answers to all consoles, and collects the failures."""

    def __init__(self, state: State) -> None:
        super().__init__(state)
        self.problems: list[Problem] = []

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Adds the reason of the failure to `problems`."""
        self.problems += problems or [Problem("command.failed", values={"value": text})]


class ProbeGcode:
    """Runs `arm_gcode` and `disarm_gcode` of the probe of one printer."""

    def __init__(self, control: Control, prober: Prober) -> None:
        self._control = control
        probe = control.machine.probe
        if not isinstance(probe, SensingProbe):
            return
        if probe.arm_gcode:
            prober.before_descent.append(lambda: self._run("probe.arm_gcode", probe.arm_gcode))
        if probe.disarm_gcode:
            prober.after_descent.append(lambda: self._run("probe.disarm_gcode", probe.disarm_gcode))

    async def _run(self, name: str, text: str) -> None:
        """Raises CommandError if the G-code fails or moves the axes, Stopped, and MachineError."""
        control, reply = self._control, _Reply(self._control.state)
        before = self._position()
        await control.dispatch.run_apart(name, text, reply)
        if reply.problems:
            raise CommandError(reply.problems)
        if (now := self._position()) != before:
            raise CommandError.of("probe.gcode-moves", axis=name, position=before, value=now)

    def _position(self) -> str:
        """X, Y and Z of the machine, to a micrometre."""
        mm = self._control.rig.job.machine_position[X : Z + 1]
        return " ".join(f"{axis}{at:.3f}" for axis, at in zip("XYZ", mm, strict=True))
