"""A board that brakes without the host when its link is lost (docs/decisions/0013-survive.md)."""

from __future__ import annotations

from collections.abc import Mapping

from passo.board.description import inverted
from passo.board.exchange import LEAD_S, Exchange, Values

BRAKING_S = 10.0  # the longest braking of any machine
LOOK_S = 0.05  # between two checks whether it is at standstill
_MAX_STEPS = 0xFFFF  # in one command


def stopped(exchange: Exchange) -> Values | None:
    """Asks a board whose link was lost until its motors are at standstill, and returns its report
    `survive_state`."""
    states = exchange.dictionary.enumerations["survive"]
    state = exchange.ask("survive_query", "survive_state")
    return None if state["state"] in (states["moving"], states["braking"]) else state


def has_survived(exchange: Exchange) -> bool:
    """Whether the board has survived the loss of its host, and its motors are at standstill."""
    states = exchange.dictionary.enumerations["survive"]
    for _ in range(int(BRAKING_S / LOOK_S)):
        if (state := stopped(exchange)) is not None:
            return state["state"] in (states["resting"], states["held"])
        exchange.pass_time(exchange.now + exchange.ticks(LOOK_S))
    return False


def move_evenly(exchange: Exchange, steps: Mapping[str, int], seconds: float, serial: int) -> None:
    """Moves motors from standstill by `steps` each (forward if positive), evenly over `seconds`,
    and stops them at the end of the commit `serial`. The board executes all of it or nothing. The
    board must be armed, and no job may run."""
    clock = exchange.clock_after(2 * LEAD_S) & 0xFFFFFFFF
    for entry in exchange.board.steppers:
        left = abs(net := steps.get(entry.name, 0))
        if left == 0:
            continue
        oid = exchange.oids.steppers[entry.name]
        turned = entry.invert != inverted(entry.dir_pin)
        interval = int(seconds * exchange.board.clock_hz / left)
        exchange.command(f"reset_step_clock oid={oid} clock={clock}")
        exchange.command(f"set_next_step_dir oid={oid} dir={int((net > 0) != turned)}")
        while left > 0:
            count = min(left, _MAX_STEPS)
            exchange.command(f"queue_step oid={oid} interval={interval} count={count} add=0")
            left -= count
    exchange.command(f"survive_commit serial={serial} clock={clock} rest=1")
