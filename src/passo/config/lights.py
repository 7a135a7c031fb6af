"""Coloured lights: chains of LEDs on data pins, LEDs on outputs and on chips."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.findings import Finding, number, tables
from passo.config.types import ColorOrder, Fraction, Model, PartName, Pin

Color = tuple[float, float, float, float]
"""Red, green, blue and white, each a fraction of full brightness."""

MAX_BYTES = 500  # of a chain: the limit of Klipper's firmware
LIGHT_PINS = (
    *("pin", "data_pin", "clock_pin", "scl_pin", "sda_pin"),
    *("red_pin", "green_pin", "blue_pin", "white_pin"),
)
_NAMES = ("red", "green", "blue", "white")
_DOTSTAR_ON = 0xFF  # the first byte of an LED: full brightness
_Start = Annotated[list[Fraction], Field(min_length=3, max_length=4)]
_Count = Annotated[int, Field(ge=1, le=MAX_BYTES // 3)]
# Registers of the chips: (bytes that set the chip up, register of the first brightness).
_CHIPS = {
    "pca9632": ((bytes((0x00, 0x00)), bytes((0x01, 0x00)), bytes((0x08, 0xAA))), 0x02),
}


class Neopixel(Model):
    """A chain of LEDs with one data wire, such as WS2812 and SK6812."""

    kind: Literal["neopixel"]
    """LEDs on one data wire."""
    pin: Pin
    """The data pin."""
    count: _Count = 1
    """The number of LEDs in the chain."""
    order: ColorOrder = "GRB"
    """The order of the colours in the chain: a permutation of RGB or RGBW."""
    start: _Start = [0.0, 0.0, 0.0]
    """Red, green, blue and perhaps white after the start, as fractions of full brightness."""

    @property
    def colors(self) -> str:
        """The colours of its LEDs: some of R, G, B and W, in this order."""
        return _in_order(self.order)

    def frame(self, colors: Iterable[Color]) -> bytes:
        """The bytes of the chain for the colour of each LED."""
        return bytes(
            _byte(color["RGBW".index(letter)]) for color in colors for letter in self.order
        )


class Dotstar(Model):
    """A chain of LEDs with a data and a clock wire, such as APA102 and SK9822."""

    kind: Literal["dotstar"]
    """LEDs on a data and a clock wire."""
    data_pin: Pin
    """The data pin."""
    clock_pin: Pin
    """The clock pin, on the same board."""
    count: _Count = 1
    """The number of LEDs in the chain."""
    start: _Start = [0.0, 0.0, 0.0]
    """Red, green and blue after the start, as fractions of full brightness."""

    @property
    def colors(self) -> str:
        """The colours of its LEDs."""
        return "RGB"

    def frame(self, colors: Iterable[Color]) -> bytes:
        """The bytes of the chain for the colour of each LED."""
        content = b"".join(
            bytes((_DOTSTAR_ON, _byte(blue), _byte(green), _byte(red)))
            for red, green, blue, _ in colors
        )
        return bytes(4) + content + b"\xff" * (4 + self.count // 16)


class LedChip(Model):
    """A chip that sets up to four LEDs, on an I2C bus."""

    kind: Literal["pca9632"]
    """The chip."""
    scl_pin: Pin
    """The clock pin of the bus."""
    sda_pin: Pin
    """The data pin of the bus, on the same board."""
    address: Annotated[int, Field(ge=0, le=127)] = 98
    """The address of the chip."""
    order: ColorOrder = "RGBW"
    """The colours on the outputs of the chip, in their order: a permutation of RGB or RGBW."""
    start: _Start = [0.0, 0.0, 0.0]
    """Red, green, blue and perhaps white after the start, as fractions of full brightness."""

    @property
    def count(self) -> int:
        """The number of lights with a colour of their own."""
        return 1

    @property
    def colors(self) -> str:
        """The colours of its LEDs: some of R, G, B and W, in this order."""
        return _in_order(self.order)

    @property
    def setup(self) -> tuple[bytes, ...]:
        """The bytes that set the chip up."""
        return _CHIPS[self.kind][0]

    def frame(self, colors: Iterable[Color]) -> bytes:
        """The bytes that set the brightness of all outputs."""
        color = next(iter(colors))
        values = [_byte(color["RGBW".index(letter)]) for letter in self.order]
        return bytes((0x80 | _CHIPS[self.kind][1], *values))


class Led(Model):
    """LEDs on outputs of a board: one of each colour, or of white alone."""

    kind: Literal["led"]
    """LEDs on outputs that the board pulses."""
    red_pin: Pin | None = None
    """The output of red."""
    green_pin: Pin | None = None
    """The output of green."""
    blue_pin: Pin | None = None
    """The output of blue."""
    white_pin: Pin | None = None
    """The output of white."""
    pwm: Literal["software", "hardware"] = "software"
    """Whether the board's software or hardware pulses the outputs."""
    pwm_hz: Annotated[float, Field(ge=1, le=100_000)] = 100.0
    """Pulses per second."""
    start: _Start = [0.0, 0.0, 0.0]
    """Red, green, blue and perhaps white after the start, as fractions of full brightness."""

    @property
    def count(self) -> int:
        """The number of lights with a colour of their own."""
        return 1

    @property
    def pins(self) -> dict[str, str]:
        """The outputs by their colours."""
        pins = {color: getattr(self, f"{color}_pin") for color in _NAMES}
        return {color: pin for color, pin in pins.items() if pin is not None}

    @property
    def colors(self) -> str:
        """The colours of its LEDs: some of R, G, B and W, in this order."""
        return _in_order("".join(color[0].upper() for color in self.pins))


Framed = Neopixel | Dotstar | LedChip
"""Lights that a board sends frames to; the others are outputs."""
Lights = dict[PartName, Annotated[Framed | Led, Field(discriminator="kind")]]


def start_color(light: Framed | Led) -> Color:
    """The colour of a light after the start."""
    red, green, blue, white = (*light.start, 0.0)[:4]
    return red, green, blue, white


def led_outputs(name: str, light: Led) -> dict[str, str]:
    """The names of a light's outputs on the timeline, with their pins as written."""
    return {f"lights.{name}.{color}": pin for color, pin in light.pins.items()}


def shares(light: Led, color: Color) -> dict[str, float]:
    """The fraction of fully on of each of a light's outputs, by the names of the colours."""
    return {name: color[_NAMES.index(name)] for name in light.pins}


def _in_order(colors: str) -> str:
    return "".join(color for color in "RGBW" if color in colors)


def _byte(share: float) -> int:
    return int(255.0 * share + 0.5)


def check_lights(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks the orders of colours, the length of chains, and that LEDs have an output."""
    for name, light in tables(data, "lights"):
        path, order = ("lights", name), light.get("order", "RGB")
        if isinstance(order, str) and sorted(order) not in (sorted("RGB"), sorted("RGBW")):
            limit = "a permutation of RGB or RGBW"
            yield Finding("config.value", (*path, "order"), order, limit)
        size = (number(light, "count") or 1) * len(str(order))
        if light.get("kind") == "neopixel" and size > MAX_BYTES:
            limit = f"{MAX_BYTES // len(str(order))} at most, of {len(str(order))} bytes each"
            yield Finding("config.value", (*path, "count"), light.get("count"), limit)
        if light.get("kind") == "led" and not any(f"{color}_pin" in light for color in _NAMES):
            yield Finding("config.missing-key", (*path, "white_pin"), None, "a pin in quotes")
