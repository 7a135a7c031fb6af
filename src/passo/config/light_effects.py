"""Effects of lights: colours that change with time, with a temperature, or with the progress of a
print."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.findings import Finding, array, did_you_mean, number, table, tables
from passo.config.types import Fraction, Model, PartName

EffectKind = Literal[
    "steady", "breathing", "blink", "gradient", "chase", "fire", "heater", "progress"
]
_Color = Annotated[list[Fraction], Field(min_length=3, max_length=4)]
_Celsius = Annotated[float, Field(ge=0, le=1000)]


class LightEffect(Model):
    """An effect that SET_LED_EFFECT starts and stops. While it runs, its LEDs have its colours;
    afterwards they have those of SET_LED again."""

    light: PartName
    """One of the `lights`."""
    leds: list[Annotated[int, Field(ge=1, le=500)]] = []
    """The LEDs of the light that have the effect, from 1. If not given, all."""
    kind: EffectKind
    """What the LEDs do. `steady`: they have the first colour. `breathing`: each colour gets
    brighter and darker, one after the other. `blink`: the colours by turns; one colour is on for
    half of the time. `gradient`: the colours pass along the LEDs. `chase`: one LED with a tail runs
    along the others. `fire`: the LEDs flicker between the colours. `heater`: from the first colour
    to the last as the heater gets warmer. `progress`: the fraction of the LEDs that the print has
    done has the first colour, the others the second."""
    colors: list[_Color] = [[1.0, 1.0, 1.0]]
    """Colours: red, green, blue and perhaps white, as fractions of full brightness."""
    period_s: Annotated[float, Field(ge=0.2, le=3600)] = 3.0
    """The duration of one round."""
    heater: PartName | None = None
    """The heater of the kind `heater`."""
    low_c: _Celsius = 25.0
    """The temperature of the heater for the first colour."""
    high_c: _Celsius | None = None
    """The temperature of the heater for the last colour. If not given, its target."""
    starts: bool = False
    """Whether the effect runs from the start on."""


LightEffects = dict[PartName, LightEffect]


def check_light_effects(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that lights, LEDs and heaters of effects exist."""
    lights, heaters = table(data, "lights"), table(data, "heaters")
    for name, effect in tables(data, "light_effects"):
        path, light = ("light_effects", name), effect.get("light")
        if isinstance(light, str) and light not in lights:
            hint, limit = did_you_mean(light, lights), "the name of one of the lights"
            yield Finding("config.value", (*path, "light"), light, limit, hint)
        count = number(table(lights, str(light)), "count") or 1
        for led in array(effect, "leds"):
            if isinstance(led, int) and light in lights and led > count:
                limit = f"1 to {count:g}, the LEDs of lights.{light}"
                yield Finding("config.value", (*path, "leds"), led, limit)
        if "colors" in effect and not array(effect, "colors"):
            yield Finding("config.value", (*path, "colors"), "[]", "one colour at least")
        heater = effect.get("heater")
        if effect.get("kind") == "heater" and heater is None:
            yield Finding("config.missing-key", (*path, "heater"), None, "one of the heaters")
        if isinstance(heater, str) and heater not in heaters:
            hint, limit = did_you_mean(heater, heaters), "the name of one of the heaters"
            yield Finding("config.value", (*path, "heater"), heater, limit, hint)
