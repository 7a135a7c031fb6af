"""Chips, UARTs, pins and baud rates that Passo's firmware does not know are errors of the machine
file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from passo import config
from passo.config.chips import chip
from passo.config.console_checks import makes
from passo.errors import ConfigError

ARM = Path(__file__).parents[2] / "firmware" / "hal" / "arm"
AVR = ARM.with_name("avr") / "console.c"
# chip: folder of its UART's source, folder of its registers
SOURCES = {
    "mk20dx128": ("mk20", "mk20dx128"),
    "mk20dx256": ("mk20", "mk20dx256"),
    "rp2040": ("rp2040", "rp2040"),
    "sam3u4e": ("sam3", "sam3u4e"),
    "sam3x8e": ("sam3", "sam3x8e"),
    "stm32f407": ("stm32f4", "stm32f4"),
    "stm32f429": ("stm32f4", "stm32f4"),
}
BAUDS = [*range(9600, 4_000_001, 9600), *range(50_000, 4_000_001, 50_000)]


def problem(text: str, file: str = "mine.toml") -> str:
    with pytest.raises(ConfigError) as error:
        config.load_text(text, file)
    (found,) = error.value.problems
    return str(found)


@pytest.mark.parametrize(
    ("baud", "nearest"),
    [
        (4_000_000, "2000000"),
        (921_600, "666666 and 1000000"),
        (230_400, "222222 and 250000"),
    ],
)
@pytest.mark.parametrize("before", ["", "console = { ", 'link = "serial"\nport = "/dev/x"\n'])
def test_an_impossible_baud_rate_is_named_with_those_next_to_it(
    i3_text: str, baud: int, nearest: str, before: str
) -> None:
    end, console = (" }", "console.") if "{" in before else ("", "")
    text = f"{i3_text}{before}baud = {baud}{end}\n"
    assert problem(text) == (
        f"mine.toml:{text.count(chr(10))}: board.{console}baud is {baud}: expected a baud rate that"
        f" its ATmega2560 makes within 2.5 %, the nearest: {nearest}. Correct the value."
    )


def test_a_further_boards_rate_is_checked_too(i3_text: str) -> None:
    tool = '\n[boards.tool]\nbase = "radds"\nbaud = 4_000_000\n'
    assert "boards.tool.baud is 4000000" in problem(i3_text + tool)
    assert "ATSAM3X8E makes within 2.5 %, the nearest: 2625000 and 5250000" in problem(
        i3_text + tool
    )


def test_no_rate_of_klippers_firmware_is_known(i3_text: str) -> None:
    tool = '\n[boards.tool]\nbase = "klipper"\nclock_hz = 16_000_000\nbaud = 921_600\n'
    assert config.load_text(i3_text + tool).boards["tool"].baud == 921_600


def test_rates_of_an_avr_are_those_of_its_firmware() -> None:
    """Its source refuses the others."""
    for hz in (16_000_000, 20_000_000):
        made = assertion(AVR.read_text(), {"BOARD_CLOCK_HZ": str(hz)}, 1)
        assert [b for b in BAUDS if makes(hz // 8, 1, b)] == [b for b in BAUDS if made(b)]


@pytest.mark.parametrize("name", SOURCES)
def test_rates_of_other_chips_are_those_of_their_firmware(name: str) -> None:
    uart, registers = (ARM / folder for folder in SOURCES[name])
    defined = dict(re.findall(r"#define (CHIP_\w+) (.+)", (registers / "registers.h").read_text()))
    for key, it in chip(name).uarts.items():
        bus = "CHIP_APB2_HZ" if key == "USART1" else "CHIP_APB1_HZ"
        hz, least = it.hz or 0, chip(name).uart_divisor
        made = assertion((uart / "uart.c").read_text(), defined | {"USART_HZ": bus}, least)
        assert [b for b in BAUDS if makes(hz, least, b)] == [b for b in BAUDS if made(b)]


def assertion(source: str, defined: dict[str, str], least: int) -> Callable[[int], bool]:
    """Whether the C source makes a rate: what its assertion says, of divisors that exist."""
    own = dict(re.findall(r"#define (DIVISOR|MADE) (\(.+?\))(?: *//.*)?\n", source))

    def number(text: str, baud: int) -> int:
        known = defined | own | {"BOARD_BAUD": str(baud)}
        while names := re.findall(r"[A-Z]\w{3,}", text):
            text = text.replace(names[0], f"({known[names[0]]})")
        return eval(re.sub(r"(\d)UL?\b", r"\1", text).replace("/", "//"))

    assert own.keys() == {"DIVISOR", "MADE"}
    return lambda baud: (
        number("DIVISOR", baud) >= least and abs(number("MADE", baud) - baud) < baud // 40
    )


BOARD = """
name = "Mine"
mcu = "stm32f407"
clock_hz = 168_000_000
move_count = 1024
console = { connector = "serial", uart = "USART2", pins = ["PD6", "PA2"], baud = 250_000 }
budget = { cycles_per_step = 600, cycles_per_command = 2000 }
"""


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "stm32f407",
            "stm32f470",
            "boards.tool.mcu is 'stm32f470': expected a chip of Passo's firmware (atmega1284p,"
            " atmega2560, mk20dx128, mk20dx256, rp2040, sam3u4e, sam3x8e, stm32f407, stm32f429), or"
            " Klipper's firmware. Did you mean 'stm32f407'?",
        ),
        (
            "USART2",
            "USART6",
            "boards.tool.console.uart is 'USART6': expected one that the firmware speaks on:"
            " USART1, USART2, USART3. Correct the value.",
        ),
        (
            'uart = "USART2", ',
            "",
            "boards.tool.console.uart is missing: expected one that the firmware speaks on: USART1,"
            " USART2, USART3. Add the key.",
        ),
        (
            '"PD6", "PA2"',
            '"PA2", "PD6"',
            "boards.tool.console.pins is 'PA2, PD6': expected the pins that USART2 receives and"
            " sends on: PA3 or PD6, then PA2 or PD5. Correct the value.",
        ),
        (
            ', pins = ["PD6", "PA2"]',
            "",
            "boards.tool.console.pins is missing: expected the pins that USART2 receives and sends"
            " on: PA3 or PD6, then PA2 or PD5. Add the key.",
        ),
    ],
)
def test_chip_and_console_of_a_board_of_ones_own(
    i3_text: str, old: str, new: str, sentence: str
) -> None:
    text = f"{i3_text}\n[boards.tool]{BOARD}"
    assert config.load_text(text).boards["tool"].console is not None
    assert problem(text.replace(old, new)).split(": ", 1)[1] == sentence


@pytest.mark.parametrize("uart", ["USART3", "USART0"])
def test_the_console_of_an_avr_is_that_of_its_firmware(i3_text: str, uart: str) -> None:
    """Whose pins nothing else can have."""
    own = f'[boards.tool]\nbase = "ramps"\nconsole = {{ uart = "{uart}", pins = ["D15", "D14"] }}'
    found = problem(f"{i3_text}\n{own}\n")
    if uart == "USART0":
        assert "is 'PJ0, PJ1': expected the pins that USART0 receives and sends on: PE0" in found
    else:
        assert "uart is 'USART3': expected one that the firmware speaks on: USART0." in found
