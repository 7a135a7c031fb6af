"""Observes a printer as time passes, and reports its status and changes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, TypeVar, cast

from passo.board.faults import HeaterFault
from passo.events import (
    Event,
    Fault,
    JobEnded,
    LayerChanged,
    Message,
    Outcome,
    ProgressChanged,
    RemoteCall,
    StateChanged,
    TemperatureChanged,
)
from passo.job.live.job_state import JobState

if TYPE_CHECKING:
    from passo.printer.status import Status
    from passo.services.services import Services

LOOK_S = 0.25  # host time, and print time, between two checks; listeners may need fewer
# The check of host time comes so much later, because the check of print time usually precedes it.
_GRACE_S = 0.15
_CHANGE_C = 1.0
_T = TypeVar("_T")


@dataclass(slots=True)
class _Listener:
    """A listener that receives the status at an interval. It is due at a host time, or at a print
    time if that is earlier."""

    call: Callable[[Status], object]
    every_s: float
    host_s: float = 0.0
    print_s: float = 0.0


@dataclass(frozen=True, slots=True)
class _EventListener:
    """A listener to events. Checks for changes are at most `every_s` apart."""

    call: Callable[[Event], object]
    every_s: float


class Observer:
    """Reports the status and events of one printer. Callbacks run in the event loop, never within a
    call of the printer; their exceptions go to the loop's exception handler. The printer is checked
    only as often as its listeners need, and not at all without them."""

    def __init__(self, services: Services) -> None:
        control, jobs, status = services.control, services.jobs, services.status
        self._rig, self._state = control.rig, control.state
        self._runner, self._progress, self._status = jobs.runner, jobs.progress, status
        self._loop = asyncio.get_running_loop()
        self._listeners: list[_Listener] = []
        self._event_listeners: list[_EventListener] = []
        self._last = status.read()
        self._shown_c = {name: heater.current_c for name, heater in self._last.heaters.items()}
        self._layer = self._last.job.layer if self._last.job else 0
        self._host_s = self._print_s = inf  # times of the next check
        self._beat: asyncio.TimerHandle | None = None
        control.lifetime.as_time_passes(self._time_passed)
        control.state.listeners.append(self._on_message)
        control.rig.macros.remote_listeners.append(self._on_remote_call)
        jobs.runner.watchers.append(self._job_changed)

    def on_status(self, call: Callable[[Status], object], every_s: float) -> Callable[[], None]:
        """Calls `call` with the status now, and then at intervals of at least `every_s` seconds
        (at least `LOOK_S`) of host time, or of print time if that is faster. Returns a function
        that ends this."""
        self._look()
        listener = _Listener(call, max(every_s, LOOK_S))
        self._listeners.append(listener)
        self._report(self._status.read())
        self._plan_check()
        return lambda: _remove(self._listeners, listener)

    def on_event(
        self, call: Callable[[Event], object], every_s: float = LOOK_S
    ) -> Callable[[], None]:
        """Calls `call` with the messages from the start of the printer, and then with each event.
        Changes of the status are noticed within `every_s` seconds, or earlier if another listener
        needs that. Returns a function that ends this."""
        if not (self._listeners or self._event_listeners):
            self._last = self._status.read()  # do not report earlier changes
        listener = _EventListener(call, every_s)
        self._event_listeners.append(listener)
        self._plan_check()
        for text in self._state.unreported:
            self._loop.call_soon(call, Message(text))
        return lambda: _remove(self._event_listeners, listener)

    def close(self) -> None:
        """Stops reporting."""
        self._listeners.clear()
        self._event_listeners.clear()
        self._plan_check()

    def _plan_check(self) -> None:
        """Plans the next check, for the listener that is due first."""
        host_s, print_s = self._loop.time(), self._rig.queue.now_s
        wait_s = min((listener.every_s for listener in self._event_listeners), default=inf)
        self._host_s = min([host_s + wait_s, *(one.host_s for one in self._listeners)])
        self._print_s = min([print_s + wait_s, *(one.print_s for one in self._listeners)])
        if self._beat is not None:
            self._beat.cancel()
        self._beat = None
        if self._host_s < inf:
            self._beat = self._loop.call_at(self._host_s + _GRACE_S, self._look)

    def _time_passed(self) -> None:
        if self._rig.queue.now_s >= self._print_s:
            self._look()

    def _job_changed(self, was: JobState, state: JobState) -> None:
        runner = self._runner
        if state.active and not was.active:
            self._layer = 0
        if was.active and not state.active:
            # On a busy computer the last check may be long ago.
            job, now = self._rig.job, self._rig.queue.passed
            layer = job.history.layer_near(now) if job.history.line_at(now) else 0
            for event in self._layers(runner.name, layer, self._progress.layers):
                self._emit(event)
            outcome = cast("Outcome", runner.ended)
            self._emit(JobEnded(runner.name, outcome, runner.failed))
        self._loop.call_soon(self._look)

    def _on_message(self, text: str) -> None:
        self._emit(Message(text))
        self._loop.call_soon(self._look)  # check soon: the printer may be halted

    def _on_remote_call(self, method: str, arguments: Mapping[str, Any]) -> None:
        self._emit(RemoteCall(method, dict(arguments)))

    def _emit(self, event: Event) -> None:
        for listener in self._event_listeners:
            self._loop.call_soon(listener.call, event)

    def _look(self) -> None:
        if not (self._listeners or self._event_listeners):
            self._plan_check()
            return
        status, last = self._status.read(), self._last
        self._last = status
        for event in self._changes(last, status):
            self._emit(event)
        self._report(status)
        self._plan_check()

    def _report(self, status: Status) -> None:
        host_s, print_s = self._loop.time(), self._rig.queue.now_s
        for listener in self._listeners:
            if host_s >= listener.host_s or print_s >= listener.print_s:
                listener.host_s = host_s + listener.every_s
                listener.print_s = print_s + listener.every_s
                self._loop.call_soon(listener.call, status)

    def _changes(self, last: Status, now: Status) -> Iterator[Event]:
        if now.state is not last.state:
            yield StateChanged(now.state, last.state, now.halted)
        for name, heater in now.heaters.items():
            before, shown = last.heaters[name], self._shown_c[name]
            if heater.fault and heater.fault != before.fault:
                fault = self._rig.connection.heaters[name].fault
                text = str(HeaterFault.of(name, fault)) if fault else heater.fault
                yield Fault(name, heater.fault, text)
            if heater.target_c != before.target_c or _moved(shown, heater.current_c):
                self._shown_c[name] = heater.current_c
                yield TemperatureChanged(name, heater.current_c, heater.target_c)
        job, before = now.job, last.job
        if job is None:
            return
        known = before is not None and before.file == job.file
        yield from self._layers(job.file, job.layer, job.layers)
        if not (known and before and int(100 * before.fraction) == int(100 * job.fraction)):
            yield ProgressChanged(job)

    def _layers(self, file: str, layer: int, layers: int | None) -> Iterator[LayerChanged]:
        """The layers that have begun since the last call; a file may return to a lower layer."""
        before, self._layer = self._layer, layer
        for begun in range(before + 1, layer + 1):
            yield LayerChanged(file, begun, layers)
        if 0 < layer < before:
            yield LayerChanged(file, layer, layers)


def _moved(shown_c: float | None, celsius: float | None) -> bool:
    """Whether a reading has changed by 1 °C since its last report, or has appeared or
    disappeared."""
    if shown_c is None or celsius is None:
        return shown_c is not celsius
    return abs(celsius - shown_c) >= _CHANGE_C


def _remove(items: list[_T], item: _T) -> None:
    if item in items:
        items.remove(item)
