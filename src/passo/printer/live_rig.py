"""The rig of a printer that executes commands."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.errors import Problem
from passo.motion.rig import Rig
from passo.printer.commands.lights import LightSink
from passo.printer.commands.plan import LivePlan
from passo.printer.commands.program import Commands
from passo.printer.commands.set_points import Heat
from passo.printer.macros import Macros
from passo.printer.wait_requests import Reply

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.saved_variables import SavedVariables
    from passo.printer.status import Status


class LiveRig(Rig):
    """A rig plus the commands of its job, which a restart replaces as well."""

    commands: Commands

    def __init__(self, machine: MachineConfig, saved: SavedVariables, *, free: bool) -> None:
        super().__init__(machine, free=free)
        self.macros = Macros(machine, saved)  # their variables survive a restart

    def plan_commands(
        self,
        heat: Heat,
        on_mark: Callable[[int, int], None],
        during_print: Callable[[Reply], bool],
        status: Callable[[], Status],
        lights: LightSink,
    ) -> None:
        """Like `plan`, with commands. They set temperatures in `heat`, and `lights`. Commands for
        which `during_print` is True also change planned moves. Macros see `status`."""
        self.plan(on_mark)
        boards = self.connection
        full = [boards.full_scale(output.name) for output in boards.board.outputs]
        plan = LivePlan(self.queue, during_print)
        self.commands = Commands(
            *(self.machine, self.job, heat, full, plan),
            macros=self.macros,
            status=status,
            lights=lights,
        )

    def problem(self) -> Problem:
        """The problem at which the job stopped."""
        return self.commands.problem()

    def use_geometry(self, machine: MachineConfig) -> None:
        """Like `Rig.use_geometry`, also for the commands of the job."""
        super().use_geometry(machine)
        self.commands.use_geometry(machine)

    def set_fan(self, fan: str, share: float) -> None:
        """Sets a fan's speed, 0 to 1, when the moves so far are done."""
        self.queue.before_moves()
        self.commands.outputs.set_fan(fan, share)
        self.queue.after_moves()

    def set_free(self, output: str, share: float) -> None:
        """Sets one of the machine's `outputs`, 0 to 1, when the moves so far are done."""
        self.queue.before_moves()
        self.commands.outputs.set_free(output, share)
        self.queue.after_moves()
