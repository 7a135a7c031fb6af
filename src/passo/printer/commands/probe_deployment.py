"""M401, M402 and the other commands that move the probe itself."""

from __future__ import annotations

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import choice, ignored
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.probing import Prober
from passo.printer.commands.probing import NO_PROBE
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure
from passo.probes.bltouch import COMMANDS, BLTouch

_PULSES_S = 0.7


class ProbeDeploymentCommands:
    """The commands of a printer whose probe can be deployed and stowed."""

    def __init__(self, prober: Prober) -> None:
        self._prober = prober

    @command(
        "M401",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Lifts the nozzle and deploys the probe, which stays so until M402. Commands that measure"
        " deploy it by themselves.",
        ignored("H R S"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "ATTACH_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As M401.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _deploy(self, _: Command, __: Reply) -> Wait | None:
        return WaitForProcedure(self._prober.deploy)

    @command(
        "M402",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Lifts the nozzle and stows the probe.",
        ignored("R"),
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    @command(
        "DETACH_PROBE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "As M402.",
        kind=Kind.PROBED,
        lacks=NO_PROBE,
    )
    def _stow(self, _: Command, __: Reply) -> Wait | None:
        return WaitForProcedure(self._prober.stow)

    @command(
        "BLTOUCH_DEBUG",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        f"Sends a command to a BLTouch: {', '.join(COMMANDS)}.",
        choice("COMMAND", "what the probe does", *COMMANDS, required=True),
        kind=Kind.SERVED,
        lacks="The probe of this machine is not a BLTouch.",
    )
    def _debug(self, command: Command, _: Reply) -> Wait | None:
        by_name = {k.lower(): width for k, width in COMMANDS.items()}
        if not isinstance(self._prober.carried, BLTouch):
            raise CommandError.of("probe.no-servo", value="BLTOUCH_DEBUG")
        return self._pulse(by_name[command.string("COMMAND").lower()])

    def _pulse(self, width_us: float) -> Wait:
        return WaitForProcedure(lambda: self._prober.pulse(width_us, _PULSES_S))
