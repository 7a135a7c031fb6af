"""Makes the moves of the machine file, by name or around homing and probing."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.motor_roles import axis_order
from passo.config.predefined_moves import Hook, PredefinedMove, hooked
from passo.errors import CommandError, Problem
from passo.motion.axis_slots import slot_of_axis

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves


def target_of(
    move: PredefinedMove, machine: MachineConfig, position: Sequence[float]
) -> dict[int, float]:
    """The target of a move that begins at a machine position, mm by axis index."""
    order = axis_order(machine.axes)
    slots = {slot_of_axis(order.index(name)): mm for name, mm in move.position_mm.items()}
    if move.relative:
        return {slot: position[slot] + mm for slot, mm in slots.items()}
    return slots


def named(moves: Mapping[str, PredefinedMove], name: str) -> PredefinedMove:
    """The move of that name. Raises CommandError."""
    if name not in moves:
        limit = f"a name in [moves]: {', '.join(moves) or 'the machine file has none'}"
        raise CommandError.of("command.value", axis="NAME", value=name or "missing", limit=limit)
    return moves[name]


def not_made(name: str, problem: Problem) -> CommandError:
    """The error of a predefined move that failed because of this problem."""
    return CommandError.of("move.not-made", axis=name, value=problem.sentence)


class PredefinedMoves:
    """The predefined moves of one printer, with the changes by SET_MOVE. The caller must hold the
    motion lock, and the machine must be idle. Methods raise CommandError, Stopped after M108 or
    M410, and MachineError."""

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        triggered: TriggeredMoves,
        problem: Callable[[], Problem],
    ) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self._problem = problem  # the error at which the job stopped
        self.moves = dict(rig.machine.moves)

    async def run(self, name: str) -> None:
        """Makes the move of that name, even if it is not enabled."""
        await self._make(name, named(self.moves, name))

    async def run_hook(self, hook: Hook) -> None:
        """Makes the enabled moves of a hook, one after the other."""
        for name, move in hooked(self.moves, hook):
            await self._make(name, move)

    async def around_homing(self, letters: str, home: Callable[[], Awaitable[None]]) -> None:
        """Makes the moves before homing, homes by `home`, and makes the moves after homing if the
        command was to home all axes."""
        await self.run_hook("before_homing")
        locked = bool(self._rig.job.locked_axes)
        await home()
        if not letters or (letters == "O" and locked):
            await self.run_hook("after_homing")

    async def _make(self, name: str, move: PredefinedMove) -> None:
        rig, job = self._rig, self._rig.job
        target = target_of(move, rig.machine, job.machine_position)
        within = Within.LIMITS
        if move.hook == "before_homing":
            target, within = self._kept(target), Within.ANYTHING
        else:
            self._require_homed(move)
        if not rig.queue.move(target, move.speed_mm_s, within):
            raise not_made(name, self._problem())
        rig.queue.flush()
        await self._triggered.standstill()
        self._interrupts.raise_if_interrupted()

    def _kept(self, target: Mapping[int, float]) -> dict[int, float]:
        """A move before homing: homed axes stay within their limits, the others have none."""
        rig, locked = self._rig, self._rig.job.locked_axes
        kept = dict(target)
        for number, name in enumerate(axis_order(rig.machine.axes)):
            slot = slot_of_axis(number)
            if slot not in kept or number in locked:
                continue
            axis, at = rig.machine.axes[name], rig.job.machine_position[slot]
            low, high = min(axis.min_mm, at), max(axis.max_mm, at)
            kept[slot] = min(max(kept[slot], low), high)
        return kept

    def _require_homed(self, move: PredefinedMove) -> None:
        order = axis_order(self._rig.machine.axes)
        for name in move.position_mm:
            if order.index(name) in self._rig.job.locked_axes:
                raise CommandError.of("input.not-homed", axis=name.upper())
