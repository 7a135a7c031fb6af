"""Time for everything that waits. Host time is the time of the event loop: `loop.time()`, in
seconds.

There are three loops: real; scaled (a multiple of real time); and virtual, which jumps to the next
deadline whenever all tasks wait, so that hours pass in moments and each run is the same. Code that
waits uses the timers of asyncio and does not depend on the kind of loop.
"""

from __future__ import annotations

import asyncio
import math
import selectors
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, ParamSpec, TypeVar

_P = ParamSpec("_P")
_T = TypeVar("_T")


# Seconds of a scaled loop, at most, for what runs between two waits. A computer that is too busy
# slows the time down, so that the simulated boards do not find their messages late.
_MOST_BUSY_S = 0.1


class _Scaled(selectors.DefaultSelector):
    """A selector that waits a fraction of the given time. It calls `begin` with this time before
    it waits, and with 0 afterwards."""

    def __init__(self, scale: float, begin: Callable[[float], None]) -> None:
        super().__init__()
        self._scale, self._begin = scale, begin

    def select(self, timeout: float | None = None) -> Any:
        """Waits for events, at most `timeout` seconds of the loop (None: without limit), and
        returns those that are ready."""
        self._begin(math.inf if timeout is None else max(timeout, 0.0))
        ready = super().select(timeout if timeout is None else timeout / self._scale)
        self._begin(0.0)
        return ready


class ScaledLoop(asyncio.SelectorEventLoop):
    """An event loop whose seconds are `1/scale` of real ones, or longer on a busy computer."""

    def __init__(self, scale: float) -> None:
        self.scale = scale
        self._base_s, self._since, self._limit_s = 0.0, time.monotonic(), _MOST_BUSY_S
        super().__init__(_Scaled(scale, self._begin))
        if not scale > 0:
            self.close()
            raise ValueError("the scale of time must be above 0")

    def time(self) -> float:
        """Seconds of this loop since its creation."""
        return self._at(time.monotonic())

    def _at(self, real_s: float) -> float:
        return self._base_s + min((real_s - self._since) * self.scale, self._limit_s)

    def _begin(self, wait_s: float) -> None:
        """Begins a wait, or a time without one, that may take `wait_s` and what a busy computer
        adds."""
        now = time.monotonic()
        self._base_s = self._at(now)
        self._since, self._limit_s = now, wait_s + _MOST_BUSY_S


class _Jumping(selectors.DefaultSelector):
    """A selector that never waits: if no event is ready, time jumps forward."""

    def __init__(self, pass_time: Callable[[float], None]) -> None:
        super().__init__()
        self._pass_time = pass_time

    def select(self, timeout: float | None = None) -> Any:
        """The events that are ready now; if there are none, `timeout` seconds pass at once."""
        ready = super().select(0)
        if not ready and timeout is None:
            return super().select(None)  # only a signal or another thread can end this
        if not ready and timeout:
            self._pass_time(timeout)
        return ready


class _AtOnce(ThreadPoolExecutor):
    """No threads: a call is executed when it is submitted, in no virtual time."""

    def submit(self, fn: Callable[_P, _T], /, *args: _P.args, **kwargs: _P.kwargs) -> Future[_T]:
        """Calls the function; returns its result or raises its exception."""
        done: Future[_T] = Future()
        try:
            done.set_result(fn(*args, **kwargs))
        except BaseException as error:
            done.set_exception(error)
        return done


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop in virtual time, from 0 s on. Calls that asyncio would run in a thread run at
    once, so that each run is the same."""

    def __init__(self) -> None:
        self._virtual_s = 0.0
        super().__init__(_Jumping(self.pass_time))
        self.set_default_executor(_AtOnce())

    def pass_time(self, seconds: float) -> None:
        """Advances the time by `seconds` without running a task, as if the program computed for
        that time."""
        self._virtual_s += seconds

    def time(self) -> float:
        """Virtual seconds since the loop was made."""
        return self._virtual_s


def time_scale() -> float:
    """How many times faster than real time the running loop is; 1 if no loop runs or time is
    virtual."""
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        return 1.0
    return loop.scale if isinstance(loop, ScaledLoop) else 1.0


def new_loop(scale: float | None) -> asyncio.AbstractEventLoop:
    """A loop in real time (scale 1), scaled time, or virtual time (scale None)."""
    if scale is None:
        return VirtualLoop()
    return asyncio.SelectorEventLoop() if scale == 1 else ScaledLoop(scale)
