"""Monitors endstops while the machine moves: M120 reports them, M540 lets them stop the machine."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from passo.board.endstops import Endstops
from passo.gcode.command import Command
from passo.gcode.parameters import integer
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.endstops import switches
from passo.printer.wait_requests import Reply, Wait

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import TriggeredMoves
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_REST_S = 0.001  # sampling interval of the board
_AHEAD_S = 0.02  # from the command to the first sample
_PRESSED_S = 0.25  # interval of checks for a triggered endstop that opens


class EndstopWatch:
    """M120, M121 and M540 of one printer. An endstop that is triggered at first, for example
    because its axis is at home, is monitored only after it has opened."""

    def __init__(
        self,
        rig: Rig,
        state: State,
        triggered: TriggeredMoves,
        stop: Callable[[Sequence[str]], None],
    ) -> None:
        self._rig, self._state, self._triggered = rig, state, triggered
        self._stop = stop  # stops the machine; receives the triggered endstops
        self._switches = [s for s in switches(rig.machine) if not s.watched]
        self._on = False
        self.stops = False  # M540: a trigger stops the machine
        self.reset()

    def reset(self) -> None:
        """Call this after the board has restarted."""
        self._endstops = Endstops(self._rig.connection)
        self._watched: list[str] = []
        self._next_look = 0  # clock

    def pause(self) -> None:
        """Suspends the monitoring, because homing uses the endstops."""
        self._arm([])
        self._next_look = 0

    def time_passed(self) -> None:
        """Checks for triggers, and for endstops that have opened."""
        rig = self._rig
        if not self._on or self._state.halted or self._triggered.active or rig.queue.interrupted:
            return
        if self._watched:
            self._endstops.all_hit()
            if self._endstops.hit:
                self._report(sorted(self._endstops.hit))
                return
        if len(self._watched) < len(self._switches) and rig.connection.now >= self._next_look:
            self._look()

    def _look(self) -> None:
        """Starts to monitor all endstops that are open now."""
        connection = self._rig.connection
        self._next_look = connection.now + int(_PRESSED_S * connection.board.clock_hz)
        others = [s.name for s in self._switches if s.name not in self._watched]
        let_go = [name for name in others if not self._endstops.pressed(name)]
        if let_go:
            self._arm([*self._watched, *let_go])

    def _arm(self, names: list[str]) -> None:
        """Arms these endstops."""
        if self._watched:
            self._endstops.disarm()
        self._watched = names
        if not names:
            return
        # The board must not stop motors itself, because the plan would continue.
        connection = self._rig.connection
        clock = connection.now + int(_AHEAD_S * connection.board.clock_hz)
        self._endstops.arm(dict.fromkeys(names, ()), clock, _REST_S)

    def _report(self, names: list[str]) -> None:
        """Reports the position that the machine had when the endstops triggered."""
        base = self._rig.queue.base
        clocks = {name: self._endstops.hit_clock(name) - base for name in names}
        self._arm([name for name in self._watched if name not in clocks])
        for name, clock in clocks.items():
            places = self._rig.positions.at(clock)
            where = " ".join(f"{k}:{at:.3f}" for k, at in places.items() if k != "E")
            hit = f"endstops hit: {name.upper()} at {where}"
            self._state.announce(_log, logging.WARNING, hit)
        if self.stops:
            self._stop(names)

    @command(
        "M120",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Enables the endstops while the machine moves.",
        kind=Kind.SERVED,
    )
    def _enable(self, _: Command, __: Reply) -> None:
        self._watch(True)

    @command(
        "M121",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Disables the endstops except for homing.",
        kind=Kind.SERVED,
    )
    def _disable(self, _: Command, __: Reply) -> None:
        self._watch(False)

    def _watch(self, on: bool) -> None:
        self.pause()
        self._on = on

    @command(
        "M540",
        Subject.MOTORS,
        When.IMMEDIATE,
        "S1: an endstop that is triggered during a move stops the machine. Without S it reports"
        " the setting.",
        integer("S", "1: on, 0: off", 0, 1, alone=True),
        kind=Kind.SERVED,
    )
    def _stop_on_hit(self, command: Command, reply: Reply) -> Wait | None:
        if (stops := command.integer("S", None)) is not None:
            self.stops = stops != 0
            self._watch(self.stops or self._on)
        else:
            reply.say(self.stop_line())
        return None

    def stop_line(self) -> str:
        """M540 with the current setting."""
        return f"M540 S{int(self.stops)}"
