"""Baud rates that a board's chip cannot make are errors of the machine file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from passo import config
from passo.config.baud_checks import makes
from passo.config.chips import chip
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
    for key, hz in chip(name).uarts.items():
        bus = "CHIP_APB2_HZ" if key == "USART1" else "CHIP_APB1_HZ"
        least = chip(name).uart_divisor
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
