"""G-code of the machine file that no console sends, such as the G-code of a button."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Coroutine, Sequence
from typing import TYPE_CHECKING, Any

from passo.errors import PassoError, Problem
from passo.printer.all_consoles import ToAllConsoles
from passo.printer.wait_requests import Stopped

if TYPE_CHECKING:
    from passo.printer.control import Control

_log = logging.getLogger(__name__)


class _Reply(ToAllConsoles):
    """Sends the answers to such G-code to all consoles."""

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Reports a refused command."""
        problem = problems[0] if problems else None
        self._state.announce(_log, logging.WARNING, text, problem)


class BackgroundGcode:
    """Runs templates of the machine file on one printer. Each waits for the motion lock like a
    console, in the order of the calls; a halted printer runs none. Answers and failures go to all
    consoles. Create it within a running event loop."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self._reply = _Reply(control.state)
        self._tasks: set[asyncio.Task[object]] = set()
        control.lifetime.at_end(self._close)

    def start(self, name: str, text: str) -> None:
        """Runs the template `text`, which is at the key `name` of the machine file, as soon as the
        motion lock is free."""
        self.spawn(self.run(name, text))

    def spawn(self, work: Coroutine[Any, Any, object]) -> None:
        """Runs a coroutine until its end, or until the printer is closed."""
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)  # the event loop has only a weak reference
        task.add_done_callback(self._tasks.discard)

    async def run(self, name: str, text: str) -> bool:
        """Like `start`, and waits for its end. Returns whether it was carried out to its end."""
        control = self._control
        await control.motion_lock.acquire()
        try:
            hurried = await control.dispatch.room()
            if control.state.halted:
                return False
            wait = control.dispatch.take_template(name, text, self._reply)
            await control.dispatch.finish(wait, self._reply, first_ends=hurried)
        except (Stopped, PassoError) as error:
            problems = error.problems if isinstance(error, PassoError) else ()
            self._reply.fail(f"{name}: {error}", problems)
            return False
        finally:
            control.motion_lock.release()
        return True

    def _close(self) -> None:
        for task in self._tasks:
            task.cancel()
