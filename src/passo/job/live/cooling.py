"""Heaters and fans of a print from the card that ends early."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.control import Control


_log = logging.getLogger(__name__)


class Cooling:
    """Switches the heaters and fans of one printer's print off, when the print is cancelled or has
    failed. A print that continues after its failed line has them on again."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self._targets_c: dict[str, float] = {}
        self._fans: dict[str, float] = {}
        self._warms_up = False

    def switch_off(self) -> None:
        """Switches heaters and fans off."""
        control = self._control
        control.targets.switch_off(control.machine.heaters)
        control.rig.queue.before_moves()
        control.rig.commands.outputs.fans_off()
        control.rig.queue.after_moves()

    def until_resumed(self) -> None:
        """Switches heaters and fans off, and keeps their values for `switch_on`."""
        control = self._control
        fans = control.rig.commands.outputs.fans
        self._targets_c = self._targets_c | control.targets.wanted_c()
        self._fans = self._fans | {name: share for name, share in fans.items() if share > 0}
        self.switch_off()
        if self._targets_c:
            text = "Heaters and fans are off; M24 sets them again before the print continues"
            control.state.announce(_log, logging.INFO, text)

    def forget(self) -> None:
        """Discards the kept values: the print does not continue."""
        self._targets_c, self._fans, self._warms_up = {}, {}, False

    def switch_on(self) -> None:
        """Sets the kept values again at once, except for heaters and fans that are on: they were
        switched on in the meantime."""
        control, outputs = self._control, self._control.rig.commands.outputs
        is_set = control.targets.wanted_c()
        off = {name: c for name, c in self._targets_c.items() if name not in is_set}
        control.targets.heat_again(off)
        control.rig.queue.before_moves()
        for fan, share in self._fans.items():
            if not outputs.fans.get(fan):
                outputs.set_fan(fan, share)
        control.rig.queue.after_moves()
        self.forget()
        self._warms_up = bool(off)

    async def warm_up(self) -> None:
        """Waits for the heaters that `switch_on` has set. Raises Stopped, and CommandError if a
        hotend fails."""
        control = self._control
        waits, self._warms_up = self._warms_up, False
        if not waits:
            return
        control.state.announce(_log, logging.INFO, "The print warms up before it continues")
        await control.motion_lock.acquire()
        try:
            await control.waits.warm_again()
        finally:
            control.motion_lock.release()
