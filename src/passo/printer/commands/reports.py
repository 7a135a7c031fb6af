"""Commands that report the state of the printer: position, firmware, drivers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_names import stepper_object
from passo.config.motor_roles import axis_order
from passo.errors import CommandError, Problem
from passo.gcode.command import Command
from passo.gcode.parameters import flag, ignored, number, refused, rest
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.axis_slots import E, slot_of_axis
from passo.motion.endstops import switches
from passo.printer.wait_requests import Reply, Wait
from passo.probes.base import SensingProbe
from passo.version import __version__

if TYPE_CHECKING:
    from passo.printer.commands.drivers import DriverCommands
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_SWITCHES = "XYZIJKPD", "homing"  # values of M123 and M124
CAPABILITIES = {
    "EEPROM": False,
    "AUTOREPORT_TEMP": True,
    "AUTOREPORT_POS": True,
    "AUTOREPORT_SD_STATUS": False,
    "BUSY_PROTOCOL": True,
    "EMERGENCY_PARSER": True,
    "CHAMBER_TEMP": False,
    "EXTENDED_M20": False,
    "LFN_WRITE": False,
    "PROMPT_SUPPORT": True,
    "PROGRESS": True,
}


class Reports:
    """The reporting commands of one printer."""

    def __init__(
        self,
        control: Control,
        parts: MachineParts,
        drivers: DriverCommands,
        *,
        card: bool = False,
        settings: bool = False,
    ) -> None:
        self._control, self._rig, self._motion = control, control.rig, parts.motion
        self._drivers, self._lateness, self._filament = (
            drivers,
            parts.lateness,
            parts.inputs.filament,
        )
        self._card, self._settings = card, settings
        self._letters = [name.upper() for name in axis_order(control.machine.axes)]

    def position(self) -> str:
        """`X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0`: the program's target, motor steps."""
        *axes, e = self._rig.positions.program
        rounded = [round(at, 3) + 0.0 for at in axes]  # never -0
        text = " ".join(
            f"{letter}:{at:.3f}" for letter, at in zip(self._letters, rounded, strict=True)
        )
        counts = " ".join(
            f"{row['name'].upper()}:{row['count']}"
            for row in self._rig.job.motors.statistics()
            if not row["name"].startswith("e")
        )
        return f"{text} E:{e:.4f} Count {counts}"

    @command(
        "M114",
        Subject.POSITIONS,
        When.IMMEDIATE,
        "Reports the position of the program. R reports the position of the machine now, D both.",
        flag("D", "both positions"),
        flag("R", "the position of the machine now"),
        ignored("E"),
        kind=Kind.QUIET,
    )
    def _position(self, command: Command, reply: Reply) -> Wait | None:
        flags = command.text.upper().split()
        if "R" in flags:
            reply.say(self._real())
            return None
        reply.say(self.position())
        if "D" in flags:
            reply.say(f"Real: {self._real()}")
        return None

    @command(
        "GET_POSITION",
        Subject.POSITIONS,
        When.IMMEDIATE,
        "Reports the steps of the motors, and the positions of machine and program, in mm.",
        kind=Kind.QUIET,
    )
    def _all_positions(self, command: Command, reply: Reply) -> None:
        job, machine = self._rig.job, self._control.machine
        counts = " ".join(
            f"{stepper_object(machine, row['name'])}:{row['count']}"
            for row in job.motors.statistics()
        )
        reply.say(f"mcu: {counts}")
        letters, at = [*self._letters, "E"], job.machine_position
        slots = [*(slot_of_axis(i) for i in range(len(self._letters))), E]
        places = {"toolhead": [at[slot] for slot in slots], "gcode": job.program_position}
        for name, place in places.items():
            words = (f"{k}:{round(mm, 6) + 0.0:.6f}" for k, mm in zip(letters, place, strict=True))
            reply.say(f"{name}: {' '.join(words)}")

    def _require_board(self) -> None:
        """Raises CommandError while the boards are stopped, because they do not answer then."""
        if self._control.state.halted:
            raise CommandError.of("command.halted", value=self._control.state.halted)

    def _real(self) -> str:
        """Like `position`, but for the real position by the step counts. Raises CommandError."""
        self._require_board()
        places, counts = self._rig.positions.now()
        e = places.pop("E", None)
        words = [f"{letter}:{round(at, 3) + 0.0:.3f}" for letter, at in places.items()]
        words += [] if e is None else [f"E:{round(e, 4) + 0.0:.4f}"]
        steps = [f"{n.upper()}:{count}" for n, count in counts.items() if not n.startswith("e")]
        return f"{' '.join(words)} Count {' '.join(steps)}"

    @command(
        "M119",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Reports which endstops are triggered, and which sensors detect filament.",
        kind=Kind.QUIET,
    )
    def _switches(self, _: Command, reply: Reply) -> Wait | None:
        self._require_board()
        reply.say("Reporting endstop status")
        machine = self._control.machine
        homes = {s.label: machine.homing[s.home].direction for s in switches(machine)}
        for name, pressed in self._motion.homer.states().items():
            reply.say(f"{name}_{homes[name]}: {'TRIGGERED' if pressed else 'open'}")
        if isinstance(machine.probe, SensingProbe):
            triggered = self._motion.prober.triggered()
            reply.say(f"z_probe: {'TRIGGERED' if triggered else 'open'}")
        for name, sensor in self._filament.status().items():
            reply.say(f"filament {name}: {'TRIGGERED' if sensor.detected else 'open'}")
        return None

    @command(
        "M122",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Reports the soft limits of the axes, the state of the drivers, and late commands.",
        number("S", "1: they stay on; the machine file has them", default=1),
        ignored("I V X Y Z E P B"),
        kind=Kind.QUIET,
    )
    def _limits(self, command: Command, reply: Reply) -> Wait | None:
        if command.value("S") == 0:
            raise CommandError([Problem("command.fixed", values={"value": "axes"})])
        axes = self._control.machine.axes
        names = [n for n in axis_order(axes) if not axes[n].extruder]
        low = " ".join(f"{n.upper()}:{axes[n].min_mm:.2f}" for n in names)
        high = " ".join(f"{n.upper()}:{axes[n].max_mm:.2f}" for n in names)
        reply.say(f"Soft endstops: ON  Min: {low}  Max: {high}")
        for line in self._drivers.status_lines():
            reply.say(line)
        for line in self._lateness.summaries():
            reply.say(line)
        return None

    @command(
        "M123",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Reports the logic of the endstops, which the machine file sets.",
        refused("XYZIJKPD", "homing"),
        kind=Kind.QUIET,
    )
    @command(
        "M124",
        Subject.MOTORS,
        When.IMMEDIATE,
        "Reports the logic and pull-ups of the endstops, as M123.",
        refused("XYZIJKPD", "homing"),
        kind=Kind.QUIET,
    )
    def _switch_logic(self, _: Command, reply: Reply) -> Wait | None:
        reply.say("Reporting endstop logic and pullup")
        for switch in switches(self._control.machine):
            logic, pullup = "!" in switch.pin, "^" in switch.pin
            reply.say(
                f"{switch.label} Logic:{'true' if logic else 'false'}"
                f" Pullup:{'true' if pullup else 'false'}"
            )
        return None

    @command(
        "M115",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Reports the firmware and its capabilities.",
        rest(),
        kind=Kind.QUIET,
    )
    def _firmware(self, _: Command, reply: Reply) -> Wait | None:
        machine = self._control.machine
        reply.say(
            f"FIRMWARE_NAME:Passo {__version__} PROTOCOL_VERSION:1.0"
            f" MACHINE_TYPE:{machine.name} EXTRUDER_COUNT:{max(1, len(machine.tools))}"
            f" UUID:{machine.uuid}"
        )
        for name, there in self.capabilities().items():
            reply.say(f"Cap:{name}:{int(there)}")
        return None

    def capabilities(self) -> dict[str, bool]:
        """The capabilities in the reply to M115."""
        chamber = any(h.kind == "chamber" for h in self._control.machine.heaters.values())
        files = dict.fromkeys(("AUTOREPORT_SD_STATUS", "EXTENDED_M20", "LFN_WRITE"), self._card)
        return CAPABILITIES | files | {"CHAMBER_TEMP": chamber, "EEPROM": self._settings}
