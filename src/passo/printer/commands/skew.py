"""M852, SET_SKEW and SKEW_PROFILE: axes that are not at right angles to each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.config.home_checks import check_skew
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import flag, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.geometry.skewable import MAX_SKEW, SkewableModel
from passo.levelling.mesh_files import check_name
from passo.levelling.skew import skew_degrees, skew_factor
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.motion.rig import Rig

NO_SKEW = "This machine has arms: skew is of axes with motors or crossed belts."
_PLANES = ("XY", "XZ", "YZ")
_DIGITS = 9  # so that stored and active values are equal


def _check_lengths(command: Command, _: object) -> None:
    """SET_SKEW. Raises CommandError for what no square has, and if nothing is given."""
    for name, given in command.pairs().items():
        if name in _PLANES:
            skew_factor(*_lengths(name, given))
    if not command.has("CLEAR", *_PLANES):
        raise CommandError.of("input.missing-word", axis=command.code, value="XY=")


class SkewCommands:
    """The skew of one machine. The active skew is that of the rig; homing works without it.
    `profiles` are saved factors by name."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self.profiles: dict[str, tuple[float, ...]] = {}

    @property
    def _geometry(self) -> SkewableModel:
        geometry = self._rig.machine.geometry
        assert isinstance(geometry, SkewableModel)
        return geometry

    def _use(self, factors: dict[int, float]) -> None:
        """Sets the factors of these planes. Raises CommandError if a motor could exceed its
        limits."""
        machine, skew = self._rig.machine, list(self._geometry.skew)
        if self._rig.job.stops.suspended:
            raise CommandError.of("command.aside", value="This command")
        for plane, factor in factors.items():
            if not abs(factor) <= MAX_SKEW:
                limit = f"-{MAX_SKEW:g} to {MAX_SKEW:g}"
                raise CommandError.bad_value(_PLANES[plane], factor, limit)
            skew[plane] = _rounded(factor)
        geometry = self._geometry.model_copy(update={"skew": skew})
        skewed = machine.model_copy(update={"geometry": geometry})
        for found in check_skew(skewed):
            value = "missing" if found.value is None else found.value
            raise CommandError.of(
                "levelling.skew-limits", axis=found.key, value=value, limit=found.limit
            )
        self._rig.use_geometry(skewed)

    @command(
        "M852",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets the skew of the planes XY (I, or S), XZ (J) and YZ (K): the tangent of what the angle"
        " between the axes differs from a right one. Without parameters it reports them.",
        number("I S", "the skew of XY", low=-MAX_SKEW, high=MAX_SKEW),
        number("J", "the skew of XZ", low=-MAX_SKEW, high=MAX_SKEW),
        number("K", "the skew of YZ", low=-MAX_SKEW, high=MAX_SKEW),
        kind=Kind.SERVED,
        lacks=NO_SKEW,
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
        "Sets the skew of planes by the lengths that were measured of a printed square: both"
        " diagonals, then the side AD. CLEAR=1 sets all of it to 0.",
        text("XY XZ YZ", "AC,BD,AD: both diagonals and the side, in mm"),
        flag("CLEAR", "sets all of it to 0"),
        kind=Kind.SERVED,
        valid=_check_lengths,
        lacks=NO_SKEW,
    )
    def _set_by_lengths(self, command: Command, _: Reply) -> Wait | None:
        factors: dict[int, float] = {}
        if command.flag("CLEAR"):
            factors = dict.fromkeys(range(3), 0.0)
        for plane, name in enumerate(_PLANES):
            if command.has(name):
                ac, bd, ad = _lengths(name, command.string(name))
                factors[plane] = skew_factor(ac, bd, ad)
        if not factors:
            raise CommandError.of("input.missing-word", axis="the command", value="XY=")
        return WaitForMoves(lambda: self._use(factors))

    @command(
        "GET_CURRENT_SKEW",
        Subject.LEVELLING,
        When.PLANNED,
        "Reports the skew of all planes.",
        kind=Kind.QUIET,
        lacks=NO_SKEW,
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
        "Calculates the skew of a printed square, and changes nothing.",
        number("AC BD", "a diagonal", "mm", 0, above=True),
        number("AD", "the side", "mm", 0, above=True),
        kind=Kind.QUIET,
        lacks=NO_SKEW,
    )
    def _calculate(self, command: Command, reply: Reply) -> Wait | None:
        factor = skew_factor(*(command.value(key) for key in ("AC", "BD", "AD")))
        reply.say(f"// Calculated Skew: {factor:.6f}, {skew_degrees(factor):.2f} degrees")
        return None

    @command(
        "SKEW_PROFILE",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Saves the skew in force under a name, loads it, or removes it; M500 stores all profiles."
        " SET gives a name these factors, CLEAR=1 removes all. Without parameters it lists them.",
        text("LOAD", "the name of a profile to use"),
        text("SAVE", "the name under which the skew is stored"),
        text("REMOVE", "the name of a profile to delete"),
        text("SET", "the name of a profile whose factors follow"),
        number("XY XZ YZ", "a factor of SET", low=-MAX_SKEW, high=MAX_SKEW),
        flag("CLEAR", "deletes all profiles"),
        kind=Kind.SERVED,
        lacks=NO_SKEW,
    )
    def _profile(self, command: Command, reply: Reply) -> Wait | None:
        pairs = command.pairs()
        if not pairs:
            for name, factors in sorted(self.profiles.items()):
                planes = zip(_PLANES, factors, strict=True)
                shown = " ".join(f"{plane}={factor:.6f}" for plane, factor in planes)
                reply.say(f"// {name}: {shown}")
        if command.value("CLEAR", 0.0):
            self.profiles = {}
        if "SET" in pairs:
            factors = tuple(_rounded(command.value(plane)) for plane in _PLANES)
            self.profiles[check_name(pairs["SET"])] = factors
        if "SAVE" in pairs:
            name = check_name(pairs["SAVE"])
            self.profiles[name] = self._in_force
            reply.say(f"// The skew is saved as profile [{name}]; M500 stores it")
        if "REMOVE" in pairs:
            self.profiles.pop(self._named("REMOVE", pairs["REMOVE"]))
            reply.say(f"// Profile [{pairs['REMOVE']}] is removed; M500 stores that")
        if "LOAD" not in pairs:
            return None
        name = self._named("LOAD", pairs["LOAD"])
        return WaitForMoves(lambda: self._use(dict(enumerate(self.profiles[name]))))

    def _named(self, word: str, name: str) -> str:
        if name not in self.profiles:
            limit = f"a profile: {', '.join(sorted(self.profiles)) or 'none is saved'}"
            raise CommandError.of("command.value", axis=word, value=name, limit=limit)
        return name

    @property
    def profile_status(self) -> str | None:
        """The name of the profile that the skew in force is equal to, or empty; None without skew
        and profiles."""
        skew = self._in_force
        if not self.profiles and not any(skew):
            return None
        return next((name for name, factors in self.profiles.items() if factors == skew), "")

    @property
    def _in_force(self) -> tuple[float, ...]:
        return tuple(_rounded(factor) for factor in self._geometry.skew)

    def setting_lines(self) -> Iterator[str]:
        """The commands that restore the exact skew and its profiles."""
        yield self.setting_line()
        yield "SKEW_PROFILE CLEAR=1"
        for name, factors in self.profiles.items():
            planes = zip(_PLANES, factors, strict=True)
            shown = " ".join(f"{plane}={factor:.{_DIGITS}f}" for plane, factor in planes)
            yield f"SKEW_PROFILE SET={name} {shown}"

    def setting_line(self) -> str:
        """M852 with the skew in force."""
        words = zip("IJK", self._geometry.skew, strict=True)
        return "M852 " + " ".join(f"{k}{factor:.{_DIGITS}f}" for k, factor in words)


def _rounded(factor: float) -> float:
    """A factor as it is stored, so that a profile is equal to the skew that it has set."""
    return round(factor, _DIGITS) + 0.0


def _lengths(plane: str, text: str) -> tuple[float, float, float]:
    """Three lengths, mm, separated by commas. Raises CommandError."""
    parts = text.split(",")
    try:
        ac, bd, ad = map(float, parts)
    except ValueError:
        limit = "the lengths AC,BD,AD in mm"
        raise CommandError.of("command.value", axis=plane, value=text, limit=limit) from None
    return ac, bd, ad
