"""Recovery after a lost link: the boards have braked without the host, and the print continues from
there."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from passo.board.boards import SETTLING_S
from passo.board.connection import Connection
from passo.board.faults import BoardAloneError, BoardResetError, PlaceLostError
from passo.board.ports import LinkLostError
from passo.board.survive import BRAKING_S, LOOK_S, move_evenly, stopped
from passo.motion.motion_queue import TICK_S

if TYPE_CHECKING:
    from passo.motion.rig import Rig
    from passo.printer.setup.outputs import Outputs
    from passo.printer.state import State
    from passo.printer.watch.driver_status import DriverWatch
    from passo.printer.watch.endstops import EndstopWatch

_log = logging.getLogger(__name__)

_AGAIN_S = 0.5  # between two attempts to open the port
# The time in which the steps of one commit are reversed: about 40 times slower than they were made.
_BACK_S = 3.0


class Reconnection:
    """Recovers the lost links of one printer; the given parts are set up again afterwards."""

    def __init__(
        self,
        rig: Rig,
        state: State,
        outputs: Outputs,
        drivers: DriverWatch,
        endstops: EndstopWatch,
    ) -> None:
        self.rig, self.state = rig, state
        self.motors, self.power_supply = outputs.motors, outputs.power_supply
        self.drivers, self.endstops = drivers, endstops

    async def reconnect(self, lost: LinkLostError) -> None:
        """Waits for the boards, verifies that they have stopped at the end of their brake tails,
        and resumes the suspended plan as soon as the heaters are warm again. Raises `lost` if the
        printer is halted in the meantime, PlaceLostError if a board's position cannot be verified,
        and MachineError if one has shut down."""
        held = self.rig.job.stops.holds
        self.rig.queue.interrupted = True
        attempt = _Attempt(self)
        plug = ": plug it in again, or give up with M112" if attempt.silent else ""
        problem = str(lost).partition(".")[0]
        waits = f"The machine waits: {problem}. {attempt.outlook}{plug}"
        self.state.announce(_log, logging.WARNING, waits, lost.problems[0])
        while not self.state.halted:
            self.rig.connection.stop_job()
            try:
                await attempt.take_over()
                break
            except BoardAloneError:
                continue
            except BoardResetError:
                raise
            except LinkLostError:
                attempt.look_for_silent()
                await asyncio.sleep(_AGAIN_S)
        if self.state.halted:
            raise lost
        self.rig.queue.interrupted = False
        if not held:
            self.rig.queue.release()


class _Attempt:
    """The recovery from one lost link, until all boards are back. The boards in `silent` must be
    reopened."""

    def __init__(self, parts: Reconnection) -> None:
        self._parts, self._rig, self._state = parts, parts.rig, parts.state
        self._connections = parts.rig.connection.connections
        self.silent: set[Connection] = set()
        self.look_for_silent()
        # The serials of two commits, and the steps of each motor between them.
        self._apart: tuple[int, int, list[int]] | None = None

    @property
    def outlook(self) -> str:
        """A sentence that describes what the boards do in the meantime."""
        who = "The board" if len(self._connections) == 1 else "Each board"
        if not self._rig.queue.commits:
            return f"Axes were homing: their positions are lost. {who} keeps warm for a minute"
        return f"{who} stops by itself and keeps warm for a minute"

    def look_for_silent(self) -> None:
        """Finds the boards whose links are lost."""
        self.silent |= {c for c in self._connections if c.lost}

    async def take_over(self) -> None:
        """Reopens the silent boards and verifies all positions. Raises LinkLostError while a board
        cannot be reached, or if a link is lost again."""
        rig, state, parts = self._rig, self._state, self._parts
        rig.queue.wait()  # raises if a board has shut down
        for connection in [c for c in self._connections if c in self.silent]:
            await connection.reopen()
            self.silent.discard(connection)
            if len(self._connections) > 1:
                await self._passes(SETTLING_S)
        serials = {c: await self._last_commit(c) for c in self._connections}
        rig.queue.wait()  # raises if a board has shut down
        serial = min(serials.values())
        ahead = [c for c in self._connections if serials[c] != serial]
        further = self._further(serial, {serials[c] for c in ahead})
        # A board that was not armed has not moved; during homing the plan has no commits.
        if not rig.queue.recover_from(serial):
            raise PlaceLostError.of("machine.place-unknown")
        self._prove(dict.fromkeys(ahead, further))
        for connection in self._connections:
            connection.command("survive_arm")
            connection.renew()
        parts.motors.renew()
        parts.power_supply.renew()
        for connection in ahead:
            move_evenly(connection, {name: -n for name, n in further.items()}, _BACK_S, serial)
        for connection in ahead:
            await self._passes(TICK_S)
            if await self._last_commit(connection) != serial:
                raise BoardAloneError.of("machine.alone")
        if ahead:
            self._prove({})
        await rig.queue.catch_up()
        for connection in self._connections:
            connection.link.resume()
        await parts.drivers.reconnected()
        if state.halted:
            return
        parts.endstops.reset()
        both = len(self._connections) > 1
        state.announce(
            _log,
            logging.INFO,
            "The boards are back, at the positions where they stopped"
            if both
            else "The board is back, at the position where it stopped",
        )
        heaters = rig.connection.heaters.values()
        # A heater may have been switched off in the meantime.
        while any(h.target > 0 and not (h.reached or h.fault) for h in heaters):
            if state.halted:
                return
            await asyncio.sleep(TICK_S)
            rig.queue.look()

    async def _last_commit(self, connection: Connection) -> int:
        """The last commit that a board has executed before its motors stopped."""
        states = connection.dictionary.enumerations["survive"]
        with self._silence_of(connection):
            # An answer to an earlier question of the link may be older than a commit that is still
            # being transmitted. After this answer, no commit is.
            connection.ask("get_config", "config")
            # Use the board's own clock: repeated questions advance a simulated board beyond the
            # time of the machine.
            end = connection.now + int(BRAKING_S * connection.wire.hz)
            while connection.now < end:
                if (state := stopped(connection)) is not None:
                    behind = state["state"] in (states["resting"], states["held"])
                    return int(state["serial"]) if behind else 0
                await self._passes(LOOK_S)
        raise PlaceLostError.of("machine.place-unknown")

    def _further(self, serial: int, others: set[int]) -> dict[str, int]:
        """The additional steps of motors on boards that have stopped one commit after `serial`.
        Raises PlaceLostError if they have stopped at any other commit."""
        job = self._rig.job
        if not others:
            return {}
        following = others.pop()
        if self._apart is None or self._apart[:2] != (serial, following):
            steps = job.commits.between_stops(serial, following)
            if steps is None or others:
                raise PlaceLostError.of("machine.place-unknown")
            self._apart = serial, following, steps
        names = (row["name"] for row in job.motors.statistics())
        return dict(zip(names, self._apart[2], strict=True))

    def _prove(self, ahead: dict[Connection, dict[str, int]]) -> None:
        """Verifies that every motor is at the plan's position plus its steps in `ahead`."""
        found: dict[str, int] = {}
        for connection in self._connections:
            with self._silence_of(connection):
                found |= self._rig.positions.counts(connection)
        for row in self._rig.job.motors.statistics():
            name = row["name"]
            connection = self._rig.connection.connection_of("steppers", name)
            wanted = row["count"] + ahead.get(connection, {}).get(name, 0)
            if found[name] != wanted:
                raise PlaceLostError.of(
                    "machine.displaced", axis=name, value=found[name], limit=wanted
                )

    async def _passes(self, seconds: float) -> None:
        await asyncio.sleep(seconds)
        self._rig.queue.wait()

    @contextmanager
    def _silence_of(self, connection: Connection) -> Generator[None]:
        """Marks a board that does not answer as silent within the block, so that it is reopened."""
        try:
            yield
        except LinkLostError:
            self.silent.add(connection)
            raise
