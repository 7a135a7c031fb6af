"""Coloured lights: chains of LEDs on data pins, LEDs on outputs and on chips."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.findings import Finding, array, number, tables
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
# The registers that set the chips up, with their values. The two pulses of a PCA9533 have 152 Hz;
# they are on for one and two thirds of the time.
_SETUP: Mapping[str, tuple[tuple[int, int], ...]] = {
    "pca9632": ((0x00, 0x00), (0x01, 0x00), (0x08, 0xAA)),
    "pca9533": ((0x01, 0), (0x02, 85), (0x03, 0), (0x04, 171)),
}
_BRIGHTNESS = 0x80 | 0x02  # of a PCA9632: the first of its registers
_SELECTORS = 0x05  # of a PCA9533: two bits for each output
_STEPS = (0, 2, 3, 1)  # of a PCA9533: off, its two pulses, on


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
    orders: list[ColorOrder] = []
    """The order of each LED, in place of `order`, of a chain with LEDs of several kinds."""
    start: _Start = [0.0, 0.0, 0.0]
    """Red, green, blue and perhaps white after the start, as fractions of full brightness."""

    @property
    def colors(self) -> str:
        """The colours of its LEDs: some of R, G, B and W, in this order."""
        return _in_order("".join(self.led_orders))

    @property
    def led_orders(self) -> list[str]:
        """The order of each LED."""
        return self.orders or [self.order] * self.count

    def frame(self, colors: Iterable[Color]) -> bytes:
        """The bytes of the chain for the colour of each LED."""
        return bytes(
            _byte(color["RGBW".index(letter)])
            for color, order in zip(colors, self.led_orders, strict=True)
            for letter in order
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

    kind: Literal["pca9632", "pca9533"]
    """The chip. A PCA9533 knows four brightnesses: off, a third, two thirds and on."""
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
        return tuple(bytes(written) for written in _SETUP[self.kind])

    def frame(self, colors: Iterable[Color]) -> bytes:
        """The bytes that set the brightness of all outputs."""
        color = next(iter(colors))
        shares = [color["RGBW".index(letter)] for letter in self.order]
        if self.kind == "pca9632":
            return bytes((_BRIGHTNESS, *map(_byte, shares)))
        bits = [_STEPS[int(3.0 * share + 0.5)] << 2 * i for i, share in enumerate(shares)]
        return bytes((_SELECTORS, sum(bits)))


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
        count = int(number(light, "count") or 1)
        orders = [str(one) for one in array(light, "orders")]
        for one in orders:
            if sorted(one) not in (sorted("RGB"), sorted("RGBW")):
                limit = "permutations of RGB or RGBW"
                yield Finding("config.value", (*path, "orders"), one, limit)
        if orders and len(orders) != count:
            limit = f"one order for each of the {count} LEDs"
            yield Finding("config.value", (*path, "orders"), f"{len(orders)} orders", limit)
        size = sum(map(len, orders)) if orders else count * len(str(order))
        if light.get("kind") == "neopixel" and size > MAX_BYTES:
            limit = f"LEDs of at most {MAX_BYTES} bytes together, here {size}"
            yield Finding("config.value", (*path, "count"), light.get("count"), limit)
        if light.get("kind") == "led" and not any(f"{color}_pin" in light for color in _NAMES):
            yield Finding("config.missing-key", (*path, "white_pin"), None, "a pin in quotes")
