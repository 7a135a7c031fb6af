"""M300: tones of a beeper that the board pulses in software."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from passo.board.exchange import LEAD_S
from passo.config.pin_names import MAIN, placed
from passo.gcode.command import Command
from passo.gcode.parameters import anything, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.config.board import Board
    from passo.motion.rig import Rig

LONGEST_S = 5.0  # maximum length of a tone
_HZ, _MS = 260, 1000  # unless given: Marlin's
_LOWEST_HZ = 20
# A tone needs two timer interrupts per cycle. Steps use a faster interrupt, but an 8-bit chip has
# little time left for others; 1000 Hz is also the limit of heaters and fans.
_HIGHEST_HZ, _HIGHEST_HZ_OF_8_BITS = 5000, 1000
_8_BITS = ("atmega", "at90", "attiny")  # names of 8-bit chips begin with these
_MAX_TONES = 64  # planned or waiting, before M300 waits
_APART_S = 0.01  # from the end of a tone until the board may receive the next
_CALL = (1000, 300)  # Hz and ms, to call the user
_MARK, _ERAS = 1 << 13, 1 << 6  # a mark of 32 bits contains an era, Hz and ms
_SOON_S = 1.0  # after a pause, a tone is sent to the board this long before it starts
_MAX_TICKS = 2**31 - 1  # of a duration, on the board


def longest_tone_s(board: Board) -> float:
    """The maximum length of a tone, seconds, that the board's clock can count."""
    return min(LONGEST_S, _MAX_TICKS / board.clock_hz - _APART_S)


def most_ticks(board: Board) -> int:
    """The duration, in ticks, after which the board ends a tone even if the host stops."""
    return min(_MAX_TICKS, round((longest_tone_s(board) + _APART_S) * board.clock_hz))


def highest_hz(board: Board) -> int:
    """The highest tone of a beeper on this board, Hz."""
    return _HIGHEST_HZ_OF_8_BITS if board.mcu.startswith(_8_BITS) else _HIGHEST_HZ


class Beeper:
    """M300 of one printer, if it has a beeper. A tone is due when the moves before it are done;
    later moves do not wait for it. Due tones sound one after the other with pauses of at least
    LEAD_S, because a board accepts another pitch only while it is silent."""

    def __init__(self, rig: Rig, state: State) -> None:
        self._rig, self._state = rig, state
        machine = rig.machine
        self._there = machine.beeper is not None
        board = machine.all_boards[placed(machine.beeper.pin)[0] if machine.beeper else MAIN]
        self._highest_hz, self._longest_s = highest_hz(board), longest_tone_s(board)
        self._era = 0  # marks of an earlier era are ignored
        # Clocks of the main board: the end of the last tone including its pause, and the end of its
        # sound.
        self._next = self._silent = 0

    def reset(self, boards: Boards) -> None:
        """Call this after the boards have restarted, or after their adoption, when a tone of
        another host may still sound."""
        self._silent = 0
        if boards.adopted:
            self._silent = boards.now + int((LONGEST_S + LEAD_S) * boards.board.clock_hz)
        self.forget()

    def forget(self) -> None:
        """Discards tones that have not started."""
        self._era = (self._era + 1) % _ERAS
        self._planned = 0  # tones that are not due yet
        self._due: deque[tuple[int, int]] = deque()
        self._next = self._silent  # drop pauses

    def call(self) -> None:
        """Beeps once to call the user."""
        if self._there:
            self._plan(*_CALL)

    def mark_reached(self, value: int) -> None:
        """Call this when print time reaches the mark of a tone: the moves before it are done or
        discarded. `value` is the content of the mark."""
        value, ms = divmod(value, _MARK)
        era, hz = divmod(value, _MARK)
        if era == self._era:
            self._planned -= 1
            self._due.append((hz, ms))

    def time_passed(self) -> None:
        """Call this as time passes: sends the next tone when the last one has ended."""
        boards = self._rig.connection
        if self._state.halted or self._rig.queue.interrupted:
            self._due.clear()
        now, per_s = boards.now, boards.board.clock_hz
        while self._due:
            hz, ms = self._due[0]
            ticks = ms * per_s // 1000
            if hz == 0:
                self._next = max(self._next, now) + ticks
            elif now < self._silent or self._next > now + _SOON_S * per_s:
                return
            else:
                begin = max(self._next, now + int(LEAD_S * per_s))
                boards.tone("beeper", hz, ms / 1000, (begin - now) / per_s)
                self._next = begin + ticks
                self._silent = self._next + int(_APART_S * per_s)
            self._due.popleft()

    @command(
        "M300",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sounds the [beeper] of the machine file; S0 is a pause.",
        number("S", "the pitch; 0: a pause", "Hz", 0, default=_HZ),
        number("P", "the length", "ms", 0, default=_MS),
        anything(),
        kind=Kind.QUIET,
        lacks="The machine file has no [beeper].",
    )
    def _beep(self, command: Command, reply: Reply) -> Wait | None:
        hz, ms = command.value("S"), command.value("P")
        longest_ms = self._longest_s * 1000
        if hz > self._highest_hz or ms > longest_ms:
            limits = f"{self._highest_hz} Hz and {longest_ms:g} ms"
            reply.note("M300", f"M300: a tone has at most {limits} here")
        hz = min(max(hz, _LOWEST_HZ), self._highest_hz) if hz > 0 else 0
        if ms >= 1:
            self._plan(round(hz), int(min(ms, longest_ms)))
        full = self._planned + len(self._due) >= _MAX_TONES
        return WaitForProcedure(self._room) if full else None

    def _plan(self, hz: int, ms: int) -> None:
        rig = self._rig
        self._planned += 1
        rig.queue.before_moves()
        rig.job.outputs.mark(len(rig.machine.heaters), (self._era * _MARK + hz) * _MARK + ms)
        rig.queue.after_moves()

    async def _room(self) -> None:
        await self._rig.queue.until(
            lambda: len(self._due) < _MAX_TONES // 2 or self._state.interrupted
        )
