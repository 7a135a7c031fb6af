"""The repeated actions of a console."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.motion.motion_queue import Alarm, MotionQueue
    from passo.motion.rig import Rig

MIN_S = 0.1  # minimum interval, so that answers stay readable


@dataclass(slots=True)
class _Timer:
    seconds: float
    action: Callable[[], None]
    report: bool
    handle: asyncio.TimerHandle
    alarm: tuple[MotionQueue, Alarm] | None = None


class Timers:
    """Named actions, each with an interval of host time. For reports, the interval is print time if
    that passes faster."""

    def __init__(self, rig: Rig) -> None:
        self._rig, self._loop = rig, asyncio.get_running_loop()
        self._timers: dict[str, _Timer] = {}

    def set(
        self,
        name: str,
        seconds: float,
        action: Callable[[], None] | None,
        *,
        report: bool = False,
    ) -> None:
        """Sets the action of this name, at an interval of at least MIN_S; 0 or None removes it."""
        self._drop(name)
        if seconds <= 0 or action is None:
            return
        seconds = max(seconds, MIN_S)
        handle = self._loop.call_later(seconds, self._act, name)
        timer = self._timers[name] = _Timer(seconds, action, report, handle)
        if report:
            queue = self._rig.queue
            alarm = queue.call_after(seconds, lambda: self._act(name))
            timer.alarm = (queue, alarm) if alarm is not None else None

    def _drop(self, name: str) -> None:
        timer = self._timers.pop(name, None)
        if timer is not None:
            timer.handle.cancel()
            if timer.alarm is not None:
                queue, alarm = timer.alarm
                queue.cancel(alarm)

    def restart(self, name: str) -> None:
        """Restarts the interval of the action of this name, if there is one."""
        timer = self._timers.get(name)
        if timer is not None:
            self.set(name, timer.seconds, timer.action, report=timer.report)

    def runs(self, name: str) -> bool:
        """Whether there is an action of this name."""
        return name in self._timers

    def stop(self) -> None:
        """Removes all actions."""
        for name in list(self._timers):
            self._drop(name)

    def _act(self, name: str) -> None:
        timer = self._timers[name]
        self.restart(name)
        timer.action()
