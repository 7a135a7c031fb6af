"""After a lost link: the board has stopped by itself, and the print goes on from there."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from passo.board.connection import BRAKING_S, LOOK_S, BoardAloneError, Values
from passo.board.ports import LinkLostError
from passo.errors import MachineError
from passo.printer.drive import TICK_S

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_AGAIN_S = 0.5  # between two tries to open the port


async def reconnect(printer: Printer, lost: LinkLostError) -> None:
    """Waits for the board, proves that it stands where its brake tails end, and goes on with what
    was held as soon as what was warm is so again. Raises `lost` when the printer is halted
    meanwhile, and MachineError when the board's place cannot be proved."""
    held = printer.job.holds
    printer.drive.interrupted = True
    printer.connection.stop_job()
    reopen = not isinstance(lost, BoardAloneError)
    plug = ": plug it in again, or give up with M112" if reopen else ""
    problem = str(lost).partition(".")[0]
    printer.tell(
        f"echo:The machine waits: {problem}. The board stops by itself and keeps warm for a minute"
        + plug
    )
    while not printer.halted:
        try:
            await _take_over(printer, reopen=reopen)
            break
        except BoardAloneError:
            reopen = False
        except LinkLostError:
            reopen = True
            await asyncio.sleep(_AGAIN_S)
    if printer.halted:
        raise lost
    printer.drive.interrupted = False
    if not held:
        printer.drive.release()


async def _take_over(printer: Printer, *, reopen: bool) -> None:
    """Raises LinkLostError while the board cannot be reached, and again when it is lost again."""
    connection = printer.connection.main
    if reopen:
        await connection.reopen()
    _prove(printer, await _standing(printer))
    connection.command("survive_arm")
    connection.renew()
    printer.motors.renew()
    await printer.drivers.reconnected()
    if printer.halted:
        return
    connection.link.go_on()
    printer.endstops.begin()
    printer.tell("echo:The board is back, and stands where it was told to stop")
    heaters = [h for h in connection.heaters.values() if h.target > 0]
    while not printer.halted and not all(h.reached or h.fault for h in heaters):
        await asyncio.sleep(TICK_S)
        printer.drive.look()


async def _standing(printer: Printer) -> Values:
    """The state of the board once its motors stand."""
    for _ in range(int(BRAKING_S / LOOK_S)):
        if (state := printer.connection.main.stopped()) is not None:
            return state
        await asyncio.sleep(LOOK_S)
        printer.drive.look()
    raise MachineError.of("machine.place-unknown")


def _prove(printer: Printer, state: Values) -> None:
    """Plans anew from where the board has stopped; every motor must be there."""
    # One that was not armed yet has not moved yet; while axes home the plan has no commits.
    if not printer.drive.recover_from(int(state["serial"])):
        raise MachineError.of("machine.place-unknown")
    found = printer.positions.counts()
    for row in printer.job.steppers():
        at, wanted = found[row["name"]], row["count"]
        if at != wanted:
            raise MachineError.of("machine.displaced", axis=row["name"], value=at, limit=wanted)
