"""Options of motor drivers with registers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options.option import flag, number, text, whole, words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.option import Options


def _fields(**defaults: int | bool) -> Options:
    """The options of registers, `driver_...`, with the values that Klipper writes without them."""
    return tuple(
        flag(f"driver_{name}", value) if isinstance(value, bool) else whole(f"driver_{name}", value)
        for name, value in defaults.items()
    )


_UART: Options = (
    text("uart_pin"),
    text("tx_pin"),
    words("select_pins"),
    whole("uart_address", 0),
)
_SPI: Options = (
    text("cs_pin"),
    text("spi_bus"),
    text("spi_software_sclk_pin"),
    text("spi_software_mosi_pin"),
    text("spi_software_miso_pin"),
    whole("spi_speed", 4_000_000),
    whole("chain_position"),
    whole("chain_length"),
)
# A sine wave of a quarter turn.
_WAVE = _fields(
    mslut0=2863314260,
    mslut1=1251300522,
    mslut2=608774441,
    mslut3=269500962,
    mslut4=4227858431,
    mslut5=3048961917,
    mslut6=1227445590,
    mslut7=4211234,
    w0=2,
    w1=1,
    w2=1,
    w3=1,
    x1=128,
    x2=255,
    x3=255,
    start_sin=0,
    start_sin90=247,
)
_COOL = _fields(semin=0, seup=0, semax=0, sedn=0, seimin=0)


def _driver(current_a: float, resistor_ohm: float, *options: Options) -> Options:
    """The options of a chip: its maximum current, which is that of a standing motor too if no other
    is given, its usual sense resistor, and its own options."""
    return (
        number("run_current"),
        number("hold_current", current_a),
        number("sense_resistor", resistor_ohm),
        number("stealthchop_threshold"),
        flag("interpolate", default=True),
        *(option for group in options for option in group),
    )


_TMC2208 = _fields(
    multistep_filt=True,
    toff=3,
    hstrt=5,
    hend=0,
    tbl=2,
    iholddelay=8,
    pwm_ofs=36,
    pwm_grad=14,
    pwm_freq=1,
    pwm_autoscale=True,
    pwm_autograd=True,
    pwm_reg=8,
    pwm_lim=12,
    tpowerdown=20,
    freewheel=0,
)
# Fields that the TMC2240 and the TMC5160 share.
_CHOPPER = _fields(
    multistep_filt=True,
    toff=3,
    hstrt=5,
    hend=2,
    fd3=0,
    disfdcc=0,
    chm=0,
    tbl=2,
    vhighfs=0,
    vhighchm=0,
    tpfd=4,
    diss2g=0,
    diss2vs=0,
    sgt=0,
    sfilt=0,
    iholddelay=6,
    tpowerdown=10,
    freewheel=0,
    pwm_grad=0,
    pwm_freq=0,
    pwm_autoscale=True,
    pwm_autograd=True,
    pwm_reg=4,
    pwm_lim=12,
)

DRIVERS: Mapping[str, Options] = {
    "tmc2208": _driver(2.0, 0.11, _UART, _TMC2208),
    "tmc2209": _driver(2.0, 0.11, _UART, (text("diag_pin"),), _TMC2208, _COOL, _fields(sgthrs=0)),
    "tmc2130": _driver(
        2.0,
        0.11,
        _SPI,
        (text("diag0_pin"), text("diag1_pin")),
        _WAVE,
        _COOL,
        _fields(
            iholddelay=8,
            tpowerdown=0,
            toff=4,
            hstrt=0,
            hend=7,
            tbl=1,
            vhighfs=0,
            vhighchm=0,
            sfilt=0,
            sgt=0,
            pwm_ampl=128,
            pwm_grad=4,
            pwm_freq=1,
            pwm_autoscale=True,
            freewheel=0,
        ),
    ),
    "tmc2240": (
        number("run_current"),
        number("hold_current", 3.0),
        number("rref", 12_000.0),
        number("stealthchop_threshold"),
        flag("interpolate", default=True),
        text("uart_pin"),
        whole("uart_address"),
        *_SPI,
        text("diag0_pin"),
        text("diag1_pin"),
        *_WAVE,
        *_COOL,
        *_CHOPPER,
        *_fields(offset_sin90=0, irundelay=4, sg4_angle_offset=True, slope_control=0, pwm_ofs=29),
    ),
    "tmc5160": _driver(
        10.0,
        0.075,
        _SPI,
        (text("diag0_pin"), text("diag1_pin")),
        _WAVE,
        _COOL,
        _CHOPPER,
        _fields(drvstrength=0, bbmclks=4, bbmtime=0, filt_isense=0, pwm_ofs=30),
    ),
}
