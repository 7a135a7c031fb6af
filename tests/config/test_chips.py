"""Chips: pins, converters, timers, as their data sheets have them."""

import pytest

from passo.config.chips import Pulse, chip, chip_names, expanded, numbering

# name: pins, analog inputs, pins with hardware PWM, compare units, flash and RAM in KiB
SIZES = {
    "atmega1284p": (32, 8, 8, 4, 128, 16),
    "atmega2560": (86, 16, 15, 11, 256, 8),
    "mk20dx128": (40, 10, 12, 0, 128, 16),
    "mk20dx256": (40, 10, 14, 0, 256, 64),
    "rp2040": (30, 4, 30, 0, 2048, 256),
    "sam3u4e": (96, 8, 39, 0, 256, 32),
    "sam3x8e": (104, 15, 35, 0, 512, 96),
    "stm32f407": (82, 16, 39, 0, 1024, 128),
    "stm32f429": (114, 24, 43, 0, 2048, 192),
}


def test_all_chips_are_listed_here() -> None:
    assert chip_names() == sorted(SIZES)


@pytest.mark.parametrize("name", SIZES)
def test_chips_have_the_sizes_of_their_data_sheets(name: str) -> None:
    it = chip(name)
    pins, adc, pwm, units, flash, ram = SIZES[name]
    assert len(it.pins) == len(set(it.pins)) == pins
    assert (len(it.adc), len(it.pwm), len(it.compare_units)) == (adc, pwm, units)
    assert (it.flash_bytes, it.ram_bytes) == (flash * 1024, ram * 1024)


@pytest.mark.parametrize("name", SIZES)
def test_pin_functions_name_existing_pins(name: str) -> None:
    it = chip(name)
    assert not set(it.adc) - set(it.pins)
    assert not set(it.pwm) - set(it.pins)
    assert len(set(it.adc.items())) == len(it.adc)


@pytest.mark.parametrize(
    ("name", "pin", "channel"),
    [
        ("atmega2560", "PF0", 0),
        ("atmega2560", "PK5", 13),
        ("atmega1284p", "PA7", 7),
        ("sam3x8e", "PA16", 7),
        ("sam3x8e", "PB21", 14),
        ("sam3u4e", "PC16", 5),
        ("mk20dx256", "PTB0", 8),
        ("stm32f407", "PC5", 15),
        ("stm32f429", "PF6", 4),
        ("rp2040", "gpio28", 2),
    ],
)
def test_adc_channels_belong_to_existing_pins(name: str, pin: str, channel: int) -> None:
    assert chip(name).adc[pin] == channel


@pytest.mark.parametrize(
    ("name", "pin", "pulse"),
    [
        ("atmega2560", "PH5", Pulse("TIMER4", "C")),
        ("atmega2560", "PB4", Pulse("TIMER2", "A")),
        ("atmega1284p", "PD5", Pulse("TIMER1", "A")),
        ("sam3x8e", "PC24", Pulse("PWM7", "L")),
        ("sam3x8e", "PC21", Pulse("PWM4", "L")),
        ("sam3x8e", "PC20", Pulse("PWM4", "H")),
        ("sam3x8e", "PB6", Pulse("PWM4", "L")),
        ("sam3x8e", "PA13", Pulse("PWM2", "H")),
        ("sam3x8e", "PC18", Pulse("PWM6", "H")),
        ("sam3u4e", "PA20", Pulse("PWM3", "H")),
        ("mk20dx128", "PTD7", Pulse("FTM0", "7")),
        ("stm32f429", "PD13", Pulse("TIM4", "2")),
        ("rp2040", "gpio27", Pulse("PWM5", "B")),
    ],
)
def test_timer_channels_belong_to_existing_pins(name: str, pin: str, pulse: Pulse) -> None:
    assert chip(name).pwm[pin] == (pulse,)


def test_a_pin_may_have_several_timers() -> None:
    assert chip("atmega2560").pwm["PB7"] == (Pulse("TIMER0", "A"), Pulse("TIMER1", "C"))


@pytest.mark.parametrize(
    ("name", "number", "pin"),
    [
        ("arduino-mega", "D54", "PF0"),
        ("arduino-mega", "A15", "PK7"),
        ("arduino-mega", "D49", "PL0"),
        ("arduino-due", "D9", "PC21"),
        ("arduino-due", "A8", "PB17"),
        ("arduino-due", "D78", "PB23"),
        ("sanguino", "D31", "PA0"),
        ("teensy3", "T17", "PTB1"),
        ("teensy3", "A2", "PTB0"),
        ("pico", "GP28", "gpio28"),
    ],
)
def test_numbers_printed_on_boards_name_their_pins(name: str, number: str, pin: str) -> None:
    assert numbering(name)[number] == pin


def test_ranges_of_pins_are_expanded() -> None:
    assert expanded(["PA0-1", "gpio28-29", "PK7"]) == ["PA0", "PA1", "gpio28", "gpio29", "PK7"]
    with pytest.raises(ValueError, match="'P' names no pins"):
        expanded(["P"])


def test_unknown_pin_names_are_refused() -> None:
    with pytest.raises(KeyError):
        chip("z80")
    with pytest.raises(KeyError):
        numbering("uno")
