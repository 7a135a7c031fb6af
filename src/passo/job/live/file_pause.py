"""The pause of a print from a file: suspends its rest, parks the nozzle, and returns it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.errors import CommandError, PassoError
from passo.job.live.job_state import PAUSES, PauseState, States
from passo.job.live.park import Park

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts
    from passo.printer.wait_requests import Reply

_log = logging.getLogger(__name__)


class FilePause:
    """The pause of one printer's print from a file. `words` are those of `Park.leave`. Call the
    methods with the motion lock held, except for those that the user's commands call: `ask`,
    `withdraw` and `take`."""

    def __init__(self, control: Control, parts: MachineParts, reply: Reply) -> None:
        self._control, self._parts, self._reply = control, parts, reply
        self.park = Park(control, parts)
        self.states = States(PauseState.NONE, PAUSES)
        self.words: Mapping[str, float] = MappingProxyType({})
        self._macro_parks = False  # the macro that has paused the print parks the nozzle
        # the rest of the macro that asked for the pause has to run during it
        self._macro_left = False
        self._locked = set[int]()  # axes that were not homed when the pause began
        self.resumed = asyncio.Event()  # set when the pause has to end

    @property
    def suspended(self) -> bool:
        """Whether the rest of the print is suspended, in a pause or until its end."""
        return self.states.now in (PauseState.SUSPENDED, PauseState.PARKED)

    @property
    def asked(self) -> bool:
        """Whether the print will pause as soon as it resumes."""
        return self.states.now is PauseState.ASKED

    def reset(self) -> None:
        """Call this when a print begins or is stopped: nothing is suspended."""
        self._macro_left = False
        self.states.enter(PauseState.NONE)

    def ask(self, words: Mapping[str, float]) -> None:
        """Lets a print that approaches its resume position pause when it has reached it."""
        self.words = words
        self.states.enter(PauseState.ASKED)

    def withdraw(self) -> None:
        """Ends `ask`."""
        if self.asked:
            self.states.enter(PauseState.NONE)

    def take(self, words: Mapping[str, float], *, by_file: bool, by_macro: bool) -> None:
        """Brakes to a stop on the path, and suspends the rest of the print. A homing is not
        interrupted, because its moves are not those of the program; after it, call `suspend`.
        `by_file`: if the command of the file is in a macro, the rest of the macro runs during the
        pause. `by_macro`: see `Park.leave`."""
        self.words, self._macro_parks = words, by_macro
        if not self._parts.motion.homer.active:
            self.suspend(hand_over_macro=by_file)
            self._macro_left = by_file

    def suspend(self, *, hand_over_macro: bool = False) -> None:
        """Brakes and suspends the rest of the print, unless it is still suspended from the last
        pause."""
        if self.suspended:
            return
        self.states.enter(PauseState.SUSPENDED)
        job = self._control.rig.job
        self.park.owed_mm = 0.0
        self._locked = set(job.locked_axes)
        if self._control.dispatch.in_console_line:
            job.abandon()  # the suspended rest does not belong to the print
        self._parts.suspension.suspend(hand_over_macro=hand_over_macro)

    async def leave(self) -> None:
        """Parks the nozzle, unless it is parked already."""
        self.suspend()
        if self.states.now is PauseState.SUSPENDED:
            self.states.enter(PauseState.PARKED)
            await self.park.leave(self.words, by_macro=self._macro_parks)

    async def come_back(self) -> None:
        """Returns the nozzle to the print. Raises CommandError if it cannot return; then it stays
        parked."""
        self.require_places()
        await self.park.come_back()
        if self.suspended:  # else the machine was stopped
            self.states.enter(PauseState.SUSPENDED)

    def resume(self) -> None:
        """Resumes the suspended print. Call `come_back` first."""
        self.states.enter(PauseState.NONE)
        self._parts.suspension.resume()

    def require_places(self) -> None:
        """Raises CommandError if an axis that was homed when the pause began is not homed any
        more."""
        if lost := set(self._control.rig.job.locked_axes) - self._locked:
            axis = axis_order(self._control.machine.axes)[min(lost)].upper()
            raise CommandError.of("input.not-homed", axis=axis)

    async def finish_macro(self, name: str) -> None:
        """Executes the rest of the macro that has requested the pause. `name` is the file."""
        left, self._macro_left = self._macro_left, False
        if not left:
            return
        try:
            await self._control.dispatch.finish_macro(self._reply)
        except PassoError as error:
            text = f"{name} is paused, but its macro is not carried out to its end: {error}"
            self._control.state.announce(_log, logging.WARNING, text, error.problems[0])
