"""What a board's processor and its link can take, for the planner."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.base import Model, Positive

# Bytes on the wire of a command, with its share of the frame and of changes of direction: 8.05 to
# 8.28 on sliced files of 1.6 million commands.
COMMAND_BYTES = 8.3
BYTES_PER_BAUD = 0.095  # ten bits a byte; some are repeated or come late
# What commits with their brake tails take of a link, bytes/s, one in 75 ms: 1180 were measured with
# four motors at 60 mm/s. Longer brakes are taken to need about as many commands, at 50 µs each.
COMMIT_BYTES_S = 1200.0
# The pulses with which steps were measured.
PULSE_US = 2.0
# A burst of so many seconds of commands may come ahead, but never more than half of the slots.
BURST_S = 0.1
# A link needs so long at most to carry one away: commands leave 125 ms before their time and are
# late with less than 60 ms left. In commits they are needed 75 ms sooner, and leave 50 ms sooner.
LINK_BURST_S = 0.06
COMMIT_BURST_S = 0.035


class Budget(Model):
    """What a board's processor and its link take; the planner keeps to it.

    Steps may take `step_share` of the processor's time at `cycles_per_step`, and what a pulse takes
    beyond 2 µs, commands
    `command_share` at `cycles_per_command`, frames and all. `cpu_hz` is the board's clock unless
    given. `link_bytes_s` is what the link carries in bytes/s; without it, a serial link carries 95
    of 100 bytes that fit its `baud`, and others bound nothing. On a board that can stop by itself a
    part of it is kept for the ways on which it would.
    """

    cpu_hz: Annotated[int, Field(ge=1_000_000, le=10_000_000_000)] | None = None
    cycles_per_step: Positive
    cycles_per_command: Positive
    step_share: Annotated[float, Field(gt=0, le=1)] = 0.65
    command_share: Annotated[float, Field(gt=0, le=1)] = 0.3
    link_bytes_s: Annotated[float, Field(ge=100)] | None = None
