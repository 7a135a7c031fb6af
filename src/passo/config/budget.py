"""The maximum load of a board's processor and link, for the planner."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.types import Model

# Bytes of a command on the transport, with its part of the frame and of direction changes: 8.05 to
# 8.28 on sliced files of 1.6 million commands.
COMMAND_BYTES = 8.3
BYTES_PER_BAUD = 0.095  # ten bits a byte; some are repeated or late
COMMIT_S = 0.075  # print time in a commit
COMMIT_BYTES = 20.0  # of a commit on the link, without its brake tails, which are commands
# Commands of a burst of this many seconds may be sent ahead, but at most half of the move queue.
BURST_S = 0.1
# Commands are on the board this long in advance; the second value applies if motion is sent in
# commits.
AHEAD_S = 0.15
COMMITTED_S = 0.2
# The maximum time of a link to transmit one command: commands leave 125 ms before their time and
# are late with less than 60 ms left. In commits they are needed 75 ms sooner, and leave 50 ms
# sooner.
LINK_BURST_S = 0.06
# Measured: the plan stays within this rate of commands for any file (docs/explanation/planning.md).
SURE_COMMANDS_S = 600.0
MAX_BUDGETS = 4  # as the core has it: boards whose loads are calculated apart
COMMIT_BURST_S = 0.035


_Share = Annotated[float, Field(ge=0.001, le=1)]
_Cycles = Annotated[float, Field(gt=0, le=1_000_000)]


class Budget(Model):
    """The maximum load of a board's processor and link, which the planner respects. The figures are
    fitted to measurements of steps and commands together; they are not the costs of single
    operations."""

    cpu_hz: Annotated[int, Field(ge=1_000_000, le=10_000_000_000)] | None = None
    """The clock of the processor. If not given, `clock_hz`."""
    cycles_per_step: _Cycles
    """Cycles of a step."""
    pulse_us: Annotated[float, Field(ge=0, le=100)] = 2.0
    """The length of a step pulse that is part of `cycles_per_step`."""
    cycles_per_command: _Cycles
    """Cycles of a command."""
    step_share: _Share = 0.65
    """The fraction of the time of the processor that steps may take."""
    command_share: _Share = 0.3
    """The fraction of the time of the processor that commands may take."""
    link_bytes_s: Annotated[float, Field(ge=100)] | None = None
    """The maximum bytes per second of the link. If not given, 95 % of what `baud` allows."""


# The budget of Klipper's firmware. On an ATmega2560 it was measured to need 491 ticks for a step of
# each of three motors, and 655 for four. On chips with an ARM core a step with a pulse is two
# events. Klipper's docs/Benchmarks.md has 60 to 102 cycles an event, but of its quickest kind,
# which steps are not. A command is assumed to cost the same as with Passo's firmware on an AVR.
_AVR_HZ = 20_000_000  # the fastest clock of an AVR
_AVR_CYCLES_PER_STEP = 164
_CYCLES_PER_STEP = 300
_CYCLES_PER_COMMAND = 1950
_RP2040_HZ = 12_000_000  # the clock that an RP2040 reports; no AVR that Klipper supports has it
_RP2040_CPU_HZ = 120_000_000  # and its minimum processor clock


def klippers_budget(clock_hz: float) -> dict[str, float]:
    """The budget, in the form of a machine file, of a board with Klipper's firmware for which only
    the clock is known."""
    if clock_hz == _RP2040_HZ:
        return klippers_budget(_RP2040_CPU_HZ) | {"cpu_hz": _RP2040_CPU_HZ}
    avr = clock_hz <= _AVR_HZ
    return {
        "cycles_per_step": _AVR_CYCLES_PER_STEP if avr else _CYCLES_PER_STEP,
        "cycles_per_command": _CYCLES_PER_COMMAND,
    }
