"""SIMULATE_FAULT, and faults at a given print time, on boards that support fault injection."""

from __future__ import annotations

import asyncio
import logging

from passo.board.fault_injection import NO_FAULT, FaultInjector, FaultOrder
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.rig import Rig
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait

_log = logging.getLogger(__name__)

_WORDS = ("NAME", "VALUE", "AFTER", "DURATION")


class SimulatedFaultCommands:
    """Injects faults into the boards of one printer. Their times are print time, which passes even
    while the printer is halted, or, if it is `free` (--clock fast), only while the printer
    works."""

    def __init__(self, rig: Rig, state: State, *, free: bool) -> None:
        self._rig, self._state, self._free = rig, state, free
        self._loop = asyncio.get_running_loop()
        self._passed_s = self._seen_s = 0.0  # free print time
        self._due: list[tuple[float, FaultOrder]] = []  # free print times
        self._timers: set[asyncio.TimerHandle] = set()

    @property
    def injector(self) -> FaultInjector:
        """The fault injector of the boards. Raises CommandError if the boards are real."""
        if self._rig.connection.injector is None:
            raise CommandError.of("command.real-board")
        return self._rig.connection.injector

    def order(self, order: FaultOrder) -> None:
        """Injects a fault now or later, and ends it if it has a duration. Raises CommandError at
        once for an unknown fault, even if it is due later."""
        injector = self.injector
        if order.after_s > 0:
            injector.check(order.part, order.value)
            self._later(order)
            return
        injector.inject(order.part, order.value)
        fault = f"Simulated fault: {order.part}={order.value}"
        self._state.announce(_log, logging.INFO, fault)
        if order.for_s is not None:
            self._later(FaultOrder(order.part, NO_FAULT, order.for_s))

    def _later(self, order: FaultOrder) -> None:
        now = FaultOrder(order.part, order.value, 0.0, order.for_s)
        if self._free:
            self._due.append((self._passed_s + order.after_s, now))
            return

        def act() -> None:
            self._timers.discard(timer)
            self.order(now)

        timer = self._loop.call_later(order.after_s, act)
        self._timers.add(timer)

    def time_passed(self) -> None:
        """Call this as time passes: counts print time, also across restarts of the boards."""
        if not self._free:
            return
        now_s = self._rig.queue.now_s
        self._passed_s += max(now_s - self._seen_s, 0.0)
        self._seen_s = now_s
        due = [order for at_s, order in self._due if at_s <= self._passed_s]
        self._due = [(at_s, order) for at_s, order in self._due if at_s > self._passed_s]
        for order in due:
            self.order(order)

    def close(self) -> None:
        """Cancels faults that are not due yet."""
        for timer in self._timers:
            timer.cancel()

    @command(
        "SIMULATE_FAULT",
        Subject.SIMULATION,
        When.IMMEDIATE,
        "Gives a part of the simulated printer a fault, or ends it. Without parameters it lists"
        " all.",
        text("NAME", "the part"),
        text("VALUE", "the fault; none ends it"),
        text("AFTER", "the seconds before it begins"),
        text("DURATION", "the seconds after which it ends"),
        kind=Kind.SERVED,
    )
    def _simulate(self, command: Command, reply: Reply) -> Wait | None:
        injector, pairs = self.injector, command.pairs()
        if not pairs:
            for part, values in injector.values.items():
                now = injector.active.get(part, NO_FAULT)
                reply.say(f"echo:{part}={now} (of {', '.join(values)})")
            return None
        for word in pairs:
            if word not in _WORDS:
                raise CommandError.of(
                    "command.fault-order", value=word, limit="NAME= VALUE= AFTER= DURATION="
                )
        after_s, for_s = (_seconds(pairs, word) for word in ("AFTER", "DURATION"))
        name, value = pairs.get("NAME", ""), pairs.get("VALUE", "").lower()
        part = found_name(injector.values, name) or name
        self.order(FaultOrder(part, value, after_s or 0.0, for_s))
        return None


def _seconds(pairs: dict[str, str], word: str) -> float | None:
    """The parameter in seconds. Raises CommandError."""
    if word not in pairs:
        return None
    try:
        seconds = float(pairs[word].removesuffix("s"))
    except ValueError:
        seconds = -1.0
    if not 0 <= seconds <= 1e9:
        raise CommandError.of("command.fault-order", value=f"{word}={pairs[word]}", limit="seconds")
    return seconds
