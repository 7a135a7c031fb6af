"""The power supply of motors and heaters, if the board switches it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.gcode.command import Command
from passo.gcode.parameters import flag
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.rig import Rig
from passo.printer.commands.motors import Motors
from passo.printer.laser import Laser
from passo.printer.power import Power
from passo.printer.targets import Targets
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure

if TYPE_CHECKING:
    from passo.board.boards import Boards

_RISES_S = 2.5  # until the supply is stable, and every driver with registers has been configured


class PowerSupply:
    """M80 and M81 of one printer. Without a pin the power supply is always on. A board that shuts
    down switches it off."""

    def __init__(
        self, rig: Rig, power: Power, laser: Laser, motors: Motors, targets: Targets
    ) -> None:
        self._rig, self._power = rig, power
        self._laser, self._motors, self._targets = laser, motors, targets
        self._pin = rig.machine.mains

    def reset(self, boards: Boards) -> None:
        """Call this after the boards have restarted, or after their adoption, when another host may
        have left the supply on."""
        if self._pin is not None:
            self._switch(boards, self._pin.on_at_start or boards.adopted)

    def renew(self) -> None:
        """Sends the state again, because the board may not have received the last one."""
        self._switch(self._rig.connection, self._power.on)

    def _switch(self, boards: Boards, on: bool) -> None:
        self._power.on = on
        if self._pin is not None:
            boards.switch("mains", on)

    @command(
        "M80",
        Subject.OUTPUTS,
        When.EXCLUSIVE,
        "Switches the power supply on. S reports whether it is on.",
        flag("S", "reports whether it is on"),
        kind=Kind.QUIET,
    )
    def _switch_on(self, command: Command, reply: Reply) -> Wait | None:
        if command.has("S"):
            reply.say(f"PS:{int(self._power.on)}")
            return None
        return None if self._power.on else WaitForProcedure(self._rise)

    async def _rise(self) -> None:
        self._switch(self._rig.connection, True)
        await self._rig.queue.sleep(_RISES_S)

    @command(
        "M81",
        Subject.OUTPUTS,
        When.EXCLUSIVE,
        "Switches heaters and motors off, and the power supply if it has a pin.",
        kind=Kind.SERVED,
    )
    def _switch_off(self, _: Command, __: Reply) -> Wait | None:
        self._laser.off()  # before the motors
        return WaitForMoves(self._all_off)

    def _all_off(self) -> None:
        self._targets.switch_off_at_once()
        self._motors.all_off()
        if self._pin is not None:
            self._switch(self._rig.connection, False)
