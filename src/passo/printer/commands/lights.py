"""SET_LED and M150: coloured lights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from passo.config.lights import Led, led_outputs, shares, start_color
from passo.config.macros import literal
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.parameters import flag, ignored, integer, number, text
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.lacking import NamedParts, report_lack
from passo.printer.stand_ins import LIGHTS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from passo import _core
    from passo.config.lights import Color
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.commands.outputs import Outputs
    from passo.printer.skipped_commands import SkippedCommands
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply

LACKS = "The machine file has no light ([lights])."
NO_EFFECT = "The machine file has no effect of a light ([light_effects])."
_FULL = 255  # of M150


class LightSink(Protocol):
    """The lights that boards send frames to."""

    def set_light(self, light: str, colors: Sequence[Color], *, at_once: bool) -> None:
        """Shows the colours of a light's LEDs when the moves so far are done, or at once."""
        ...

    def set_effect(self, effect: str, *, on: bool, replaces: bool = False) -> None:
        """Starts or ends an effect when the moves so far are done."""
        ...

    def follow(
        self, light: str, leds: Sequence[int], template: str | None, values: Mapping[str, object]
    ) -> None:
        """Lets LEDs, from 0, follow a template when the moves so far are done, or none."""
        ...


class NoLights:
    """The lights of a program that is only planned."""

    def set_effect(self, effect: str, *, on: bool, replaces: bool = False) -> None:
        """Does nothing."""

    def set_light(self, light: str, colors: Sequence[Color], *, at_once: bool) -> None:
        """Shows nothing."""

    def follow(
        self, light: str, leds: Sequence[int], template: str | None, values: Mapping[str, object]
    ) -> None:
        """Follows nothing."""


class Lights:
    """The lights that the program of one job sets. `colors` are the last commanded ones."""

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        outputs: Outputs,
        sink: LightSink,
        stand_ins: StandIns,
        omitted: SkippedCommands,
    ) -> None:
        self._lights, self._outputs, self._sink = machine.lights, outputs, sink
        self._job, self._effects = job, machine.light_effects
        self._templates = machine.light_templates
        self._named = NamedParts(self._lights, LACKS, LIGHTS, job, stand_ins, omitted)
        self.colors: dict[str, list[Color]] = {
            name: [start_color(light)] * light.count for name, light in self._lights.items()
        }

    def reset(self, *, adopted: bool) -> None:
        """Call this after the boards have started: LEDs on outputs take the colours of the start,
        which their boards do not have. Boards that are `adopted` may have others."""
        for name, light in self._lights.items():
            if isinstance(light, Led) and (adopted or any(light.start)):
                self._show(name, at_once=True)

    def set_colors(self, name: str, colors: Sequence[Color], *, at_once: bool) -> None:
        """Sets the colours of all LEDs of a light."""
        self.colors[name] = list(colors)
        self._show(name, at_once=at_once)

    def plan_forgotten(self, shown: Mapping[str, Sequence[Color]]) -> None:
        """Call this when the plan is discarded. The lights keep the colours that are `shown`."""
        self.colors |= {name: list(colors) for name, colors in shown.items()}

    def _show(self, name: str, *, at_once: bool) -> None:
        light = self._lights[name]
        if isinstance(light, Led):
            self._show_leds(name, light, self.colors[name][0], at_once=at_once)
        else:
            self._sink.set_light(name, self.colors[name], at_once=at_once)

    def show_leds(self, name: str, color: Color) -> None:
        """Shows a colour on the LEDs of a light on outputs, at once, without a command."""
        light = self._lights[name]
        if isinstance(light, Led):
            self._show_leds(name, light, color, at_once=True)

    def _show_leds(self, name: str, light: Led, color: Color, *, at_once: bool) -> None:
        outputs = led_outputs(name, light)
        for output, share in zip(outputs, shares(light, color).values(), strict=True):
            self._outputs.set_output(output, share, at_once=at_once)

    def named(self, command: Command, key: str, reply: Reply) -> str | None:
        """The light that a parameter names. None for one that the machine does not have, which
        macros for other printers may name. Raises CommandError."""
        return self._named.find(command, key, reply)

    @command(
        "SET_LED",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the colour of a light, or of its LED INDEX. A colour that is not given is off.",
        text("LED", "the name of the light"),
        number("RED GREEN BLUE WHITE", "the brightness of each colour", low=0, high=1, default=0),
        integer("INDEX", "the LED, from 1", 1),
        number("TRANSMIT", "0: the light shows it with its next change", default=1),
        number("SYNC", "0: at once, not in order with the moves", default=1),
        lacks=LACKS,
    )
    def _set_led(self, command: Command, reply: Reply) -> None:
        name = self.named(command, "LED", reply)
        if name is None:
            return
        red, green, blue, white = (
            command.value(key, 0.0) for key in ("RED", "GREEN", "BLUE", "WHITE")
        )
        color, colors = (red, green, blue, white), self.colors[name]
        index = command.integer("INDEX", 0)
        if index > len(colors):
            raise CommandError.bad_value("INDEX", index, f"1 to {len(colors)}")
        self.colors[name] = (
            [color] * len(colors) if index == 0 else [*colors[: index - 1], color, *colors[index:]]
        )
        if command.value("TRANSMIT", 1.0):
            self._show(name, at_once=not command.value("SYNC", 1.0))

    @command(
        "SET_LED_TEMPLATE",
        Subject.OUTPUTS,
        When.PLANNED,
        "Lets a light, or its LED INDEX, follow a template of the machine file. Other keys, such as"
        " PARAM_X, set variables of the template. With an empty TEMPLATE the LEDs have the colours"
        " of SET_LED again.",
        text("LED", "the name of the light"),
        text("TEMPLATE", "the name of the template"),
        integer("INDEX", "the LED, from 1", 1),
        lacks=LACKS,
    )
    def _set_template(self, command: Command, reply: Reply) -> None:
        name = self.named(command, "LED", reply)
        if name is None:
            return
        template, count = self._template(command.string("TEMPLATE")), self._lights[name].count
        index = command.integer("INDEX", 0)
        if index > count:
            raise CommandError.bad_value("INDEX", index, f"1 to {count}")
        values: dict[str, object] = {}
        for key, written in command.pairs().items() if template else ():
            variable = found_name(self._templates[template].variables, key) if template else None
            if variable is not None:
                values[variable] = _literal(key, written)
        leds = range(count) if index == 0 else (index - 1,)
        self._sink.follow(name, leds, template, values)

    def _template(self, written: str) -> str | None:
        """The template of this name; None for an empty one. Raises CommandError."""
        if not written:
            return None
        name = found_name(self._templates, written)
        if name is None:
            limit = (
                ", ".join(self._templates)
                or "a name of [light_templates], which this machine file does not have"
            )
            raise CommandError.of("command.value", axis="TEMPLATE", value=written, limit=limit)
        return name

    @command(
        "SET_LED_EFFECT",
        Subject.OUTPUTS,
        When.PLANNED,
        "Starts an effect of the machine file, or ends it with STOP=1.",
        text("EFFECT", "the name of the effect"),
        number("STOP", "1: ends the effect", default=0),
        number("REPLACE", "1: ends the other effects of its light", default=0),
        ignored("FADETIME RESTART"),
        lacks=NO_EFFECT,
    )
    def _set_effect(self, command: Command, reply: Reply) -> None:
        written = command.string("EFFECT")
        name = found_name(self._effects, written)
        if name is None:
            if not self._effects:
                report_lack(self._job, command, reply, NO_EFFECT)
                return
            limit = ", ".join(self._effects)
            raise CommandError.of(
                "command.value", axis="EFFECT", value=written or "missing", limit=limit
            )
        replaces = command.value("REPLACE", 0.0) != 0
        self._sink.set_effect(name, on=not command.value("STOP", 0.0), replaces=replaces)

    @command(
        "STOP_LED_EFFECTS",
        Subject.OUTPUTS,
        When.PLANNED,
        "Ends all effects, or those of the light LEDS, such as `neopixel:head`.",
        text("LEDS", "the light"),
        ignored("FADETIME"),
        lacks=NO_EFFECT,
    )
    def _stop_effects(self, command: Command, reply: Reply) -> None:
        if not self._effects:
            report_lack(self._job, command, reply, NO_EFFECT)
            return
        written = command.string("LEDS")
        light = found_name(self._lights, written.rpartition(":")[2].partition(" ")[0])
        for name, effect in self._effects.items():
            if not written or effect.light == light:
                self._sink.set_effect(name, on=False)

    @command(
        "M150",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the colour of a light. A colour that is not given is off, or stays with K.",
        number("R U B W", "red, green, blue, white", low=0, high=_FULL, clamped=True, alone=True),
        number("P", "the brightness of all", low=0, high=_FULL, clamped=True, default=_FULL),
        integer("I", "only this LED, from 0", 0),
        flag("K", "keep the colours that are not given"),
        integer("S", "the number of the light, from 0, in the order of the machine file", 0),
        lacks=LACKS,
    )
    def _set_strip(self, command: Command, reply: Reply) -> None:
        names = list(self._lights)
        if not names:
            report_lack(self._job, command, reply, LACKS)
            return
        number_ = command.integer("S", 0)
        if number_ >= len(names):
            raise CommandError.bad_value("S", number_, f"0 to {len(names) - 1}")
        name = names[number_]
        colors, index = self.colors[name], command.integer("I", -1)
        if index >= len(colors):
            raise CommandError.bad_value("I", index, f"0 to {len(colors) - 1}")
        changed = list(colors)
        for i in range(len(colors)) if index < 0 else (index,):
            changed[i] = self._mixed(command, colors[i])
        self.set_colors(name, changed, at_once=False)

    @staticmethod
    def _mixed(command: Command, before: Color) -> Color:
        """The colour that M150 gives a LED that had another one."""
        bright = min(max(command.value("P", float(_FULL)), 0.0), _FULL) / _FULL

        def share(letter: str, kept: float) -> float:
            if not command.has(letter):
                return kept if command.has("K") else 0.0
            value = command.value(letter, None)
            return min(max(_FULL if value is None else value, 0.0), _FULL) / _FULL * bright

        red, green, blue, white = (share(x, y) for x, y in zip("RUBW", before, strict=True))
        return red, green, blue, white


def _literal(key: str, written: str) -> object:
    """The value of a parameter. Raises CommandError."""
    try:
        return literal(written)
    except ValueError:
        raise CommandError.of("macro.value", axis=key, value=written) from None
