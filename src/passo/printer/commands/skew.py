"""M852 and SET_SKEW: axes that are not at right angles to each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Subject, When, command
from passo.geometry.cartesian import MAX_SKEW, Cartesian
from passo.levelling.skew import skew_degrees, skew_factor
from passo.printer.commands.klipper_commands import number
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.motion.rig import Rig

NOT_CARTESIAN = "This machine is not cartesian."
_PLANES = ("XY", "XZ", "YZ")
_DIGITS = 9  # so that stored and active values are equal


class SkewCommands:
    """The skew of one cartesian machine. The active skew is that of the rig; homing works without
    it."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig

    @property
    def _geometry(self) -> Cartesian:
        geometry = self._rig.machine.geometry
        assert isinstance(geometry, Cartesian)
        return geometry

    def _use(self, factors: dict[int, float]) -> None:
        """Sets the factors of these planes. Raises CommandError if a motor could exceed its
        limits."""
        machine, skew = self._rig.machine, list(self._geometry.skew)
        if self._rig.job.suspended:
            raise CommandError.of("command.aside", value="This command")
        for plane, factor in factors.items():
            if not abs(factor) <= MAX_SKEW:
                limit = f"-{MAX_SKEW:g} to {MAX_SKEW:g}"
                raise CommandError.bad_value(_PLANES[plane], factor, limit)
            skew[plane] = round(factor, _DIGITS) + 0.0
        geometry = self._geometry.model_copy(update={"skew": skew})
        for axis in geometry.sheared_axes:
            for name, stepper in machine.steppers.items():
                if machine.driven_by(name) != machine.drivable.by_name[axis]:
                    continue
                if stepper.min_mm is None or stepper.max_mm is None:
                    raise CommandError.of("levelling.skew-limits", axis=name)
        self._rig.use_geometry(machine.model_copy(update={"geometry": geometry}))

    @command(
        "M852",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "I J K S",
        "Sets the skew of the planes XY (I, or S), XZ (J) and YZ (K): the tangent of what the angle"
        " between the axes differs from a right one. Without parameters it reports them.",
        kind=Kind.SERVED,
        lacks=NOT_CARTESIAN,
    )
    def _set_factors(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        planes = {"S": 0, "I": 0, "J": 1, "K": 2}
        factors = {planes[k]: v for k, v in words.items() if k in planes}
        if not factors:
            reply.say(f"  {self.setting_line()}")
            return None
        return WaitForMoves(lambda: self._use(factors))

    @command(
        "SET_SKEW",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "XY XZ YZ (AC,BD,AD in mm) CLEAR",
        "Sets the skew of planes by the lengths that were measured of a printed square: both"
        " diagonals, then the side AD. CLEAR=1 sets all of it to 0.",
        kind=Kind.SERVED,
        bare=None,
        lacks=NOT_CARTESIAN,
    )
    def _set_by_lengths(self, command: Command, _: Reply) -> Wait | None:
        pairs = command.pairs()
        factors: dict[int, float] = {}
        if number(pairs, "CLEAR", 0.0):
            factors = dict.fromkeys(range(3), 0.0)
        for plane, name in enumerate(_PLANES):
            if name in pairs:
                ac, bd, ad = _lengths(name, pairs[name])
                factors[plane] = skew_factor(ac, bd, ad)
        if not factors:
            raise CommandError.of("input.missing-word", axis="the command", value="XY=")
        return WaitForMoves(lambda: self._use(factors))

    @command(
        "GET_CURRENT_SKEW",
        Subject.LEVELLING,
        When.PLANNED,
        "",
        "Reports the skew of all planes.",
        kind=Kind.QUIET,
        bare=None,
        lacks=NOT_CARTESIAN,
    )
    def _report(self, _: Command, reply: Reply) -> Wait | None:
        reply.say("// Current Printer Skew:")
        for name, factor in zip(_PLANES, self._geometry.skew, strict=True):
            reply.say(f"// {name} Skew: {factor:.6f}, {skew_degrees(factor):.2f} degrees")
        return None

    @command(
        "CALC_MEASURED_SKEW",
        Subject.LEVELLING,
        When.PLANNED,
        "AC BD AD (mm)",
        "Calculates the skew of a printed square, and changes nothing.",
        kind=Kind.QUIET,
        bare=None,
        lacks=NOT_CARTESIAN,
    )
    def _calculate(self, command: Command, reply: Reply) -> Wait | None:
        pairs = command.pairs()
        factor = skew_factor(*(number(pairs, key) for key in ("AC", "BD", "AD")))
        reply.say(f"// Calculated Skew: {factor:.6f}, {skew_degrees(factor):.2f} degrees")
        return None

    def setting_line(self) -> str:
        """The command that restores the skew exactly."""
        words = zip("IJK", self._geometry.skew, strict=True)
        return "M852 " + " ".join(f"{k}{factor:.{_DIGITS}f}" for k, factor in words)


def _lengths(plane: str, text: str) -> tuple[float, float, float]:
    """Three lengths, mm, separated by commas. Raises CommandError."""
    parts = text.split(",")
    try:
        ac, bd, ad = map(float, parts)
    except ValueError:
        limit = "the lengths AC,BD,AD in mm"
        raise CommandError.of("command.value", axis=plane, value=text, limit=limit) from None
    return ac, bd, ad
