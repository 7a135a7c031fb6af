"""The parts that carry out commands, for consoles, prints and other sources."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.commands.user_prompts import UserPrompts
    from passo.printer.dispatch import Dispatch
    from passo.printer.lifetime import Lifetime
    from passo.printer.live_rig import LiveRig
    from passo.printer.motion_lock import MotionLock
    from passo.printer.recovery.supervisor import Supervisor
    from passo.printer.state import State
    from passo.printer.stops import Stops
    from passo.printer.targets import Targets
    from passo.printer.unfit_commands import Skips
    from passo.printer.wait_runner import WaitRunner


@dataclass(frozen=True, slots=True)
class Control:
    """How commands of one printer are carried out: `dispatch` passes them to handlers while their
    source has the `motion_lock`, `waits` runs their waits, `prompts` asks the user, `stops` stops
    the machine, and `supervisor` restarts it. `machine` is the machine file, `lifetime` calls parts
    as time passes, and `skips` are the commands that prints may skip."""

    machine: MachineConfig
    rig: LiveRig
    state: State
    lifetime: Lifetime
    targets: Targets
    motion_lock: MotionLock
    prompts: UserPrompts
    waits: WaitRunner
    dispatch: Dispatch
    stops: Stops
    supervisor: Supervisor
    skips: Skips
