"""The one table of the motor drivers that have registers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from passo.config.trinamic.currents import CurrentLaw, CurrentRange
from passo.config.trinamic.registers import (
    TMC2130,
    TMC2208,
    TMC2209,
    TMC2225,
    TMC2240,
    TMC2660,
    TMC5160,
    Field,
    Layout,
    Register,
)

ChipName: TypeAlias = Literal[
    "TMC2208", "TMC2209", "TMC2225", "TMC2226", "TMC2130", "TMC5160", "TMC2240", "TMC2660"
]
Bus: TypeAlias = Literal["uart", "spi", "spi20"]

THRESHOLD_MAX = 0xFFFFF  # of TPWMTHRS, TCOOLTHRS and THIGH

# Fields that no setting may change, and what sets them.
_OWNED = {
    "mres": "microsteps",
    "intpol": "interpolate",
    **dict.fromkeys(("tpwmthrs", "en_spreadcycle", "en_pwm_mode"), "stealthchop_below_mm_s"),
    **dict.fromkeys(("irun", "ihold", "cs"), "run_current_a and hold_current_a"),
    "tcoolthrs": "coolstep_above_mm_s",
    "thigh": "high_speed_above_mm_s",
    **dict.fromkeys(("vsense", "globalscaler", "current_range"), "run_current_a"),
}
_FIXED = {
    "dedge", "pdn_disable", "mstep_reg_select", "senddelay", "slaveaddr", "vactual", "test_mode",
    "direct_mode", "stop_enable", "coil_a", "coil_b", "rdsel", "sdoff", "tst", "fclktrim", "ottrim",
    "internal_rsense", "reset", "drv_err", "uv_cp", "register_reset", "vm_uvlo",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Chip:
    """One type of chip: the buses that reach it, its registers, the law of its current, and the
    frequency of its own oscillator. `start` are the values of fields that Passo writes unless the
    machine file has others. `version` is a field's value that identifies the chip. `shown`
    registers read back as they were written."""

    buses: tuple[Bus, ...]
    registers: Layout
    currents: CurrentLaw
    clock_hz: int
    start: Mapping[str, int]
    version: int | None = None
    addresses: int = 1
    """The number of addresses on a UART."""
    shown: tuple[str, ...] = ("GCONF", "CHOPCONF")
    measured: tuple[str, ...] = ()
    """Registers that are read with the status."""

    def field(self, name: str) -> Field | None:
        """A field by its name; None if the chip does not have it."""
        for register in self.registers.values():
            if name in register.fields:
                return register.fields[name]
        return None

    @property
    def settable(self) -> dict[str, Field]:
        """The fields that a machine file may set, by name."""
        return {
            name: field
            for register in self.registers.values()
            if "w" in register.access
            for name, field in register.fields.items()
            if name not in _FIXED and name not in _OWNED
        }

    @property
    def runtime(self) -> set[str]:
        """The fields that a command may set: also the thresholds that have keys of their own."""
        return set(self.settable) | {n for n in ("tcoolthrs", "thigh") if self.field(n)}

    def bounds(self, name: str) -> tuple[int, int]:
        """The minimum and maximum value of a field. TOFF 0 would switch the motor off."""
        field = self.field(name)
        if field is None:
            raise KeyError(name)
        return int(name == "toff") or field.least, field.most

    def owner(self, field: str) -> str:
        """The keys of the machine file that set a field of this chip; empty if none does."""
        return _OWNED.get(field, "") if self.field(field) else ""

    @property
    def mode(self) -> str:
        """The field that selects stealthChop or spreadCycle; empty if the chip has one mode."""
        return next((n for n in ("en_spreadcycle", "en_pwm_mode") if self.field(n)), "")

    @property
    def status(self) -> Register:
        """The register of the driver's flags."""
        return self.registers["DRV_STATUS" if self.version else "READRSP@RDSEL1"]

    @property
    def microsteps(self) -> str:
        """The register with the position within the wave of the coils."""
        return "MSCNT" if self.version else "READRSP@RDSEL0"


_SENSE = CurrentLaw(
    (CurrentRange(1, 0.18), CurrentRange(0, 0.32)), 0.11, select="vsense", inner_ohm=0.02
)
# The start values of the data sheets: slow decay of 3, hysteresis 4 and 1, blanking 2. The current
# falls 0.44 s after the last step: TPOWERDOWN counts 2¹⁸ clocks, as each step of IHOLDDELAY does.
_CHOPPER = {"toff": 3, "hstrt": 4, "hend": 1, "tbl": 2}
_DELAYS = {"iholddelay": 8, "tpowerdown": 20, "tpwmthrs": 0}
_NO_COOLING = {"tcoolthrs": 0, "semin": 0}
_UART_MODE = {"pdn_disable": 1, "mstep_reg_select": 1, "multistep_filt": 1}
# 24 bit times before an answer: the minimum with several drivers on one UART.
_ANSWER = {"senddelay": 2}
_PWM = {"pwm_autoscale": 1, "pwm_autograd": 1, "pwm_lim": 12}
_UART_START = (
    _UART_MODE | _ANSWER | _DELAYS | {"pwm_ofs": 36, "pwm_freq": 1, "pwm_reg": 1} | _PWM | _CHOPPER
)
_SPI_START = _DELAYS | _NO_COOLING | {"thigh": 0}
_WITH_SCALER = _SPI_START | {"multistep_filt": 1, "pwm_reg": 4, "tpfd": 4} | _PWM | _CHOPPER

CHIPS: Mapping[ChipName, Chip] = {
    "TMC2208": Chip(("uart",), TMC2208, _SENSE, 12_000_000, _UART_START, 0x20),
    "TMC2209": Chip(
        ("uart",), TMC2209, _SENSE, 12_000_000,
        _UART_START | _NO_COOLING | {"sgthrs": 0}, 0x21, addresses=4,
    ),
    "TMC2225": Chip(("uart",), TMC2225, _SENSE, 12_000_000, _UART_START, 0x20),
    "TMC2226": Chip(
        ("uart",), TMC2209, _SENSE, 12_000_000,
        _UART_START | _NO_COOLING | {"sgthrs": 0}, 0x21, addresses=4,
    ),
    "TMC2130": Chip(
        ("spi",), TMC2130, _SENSE, 13_200_000,
        _SPI_START | {"pwm_ampl": 200, "pwm_grad": 1, "pwm_autoscale": 1} | _CHOPPER, 0x11,
    ),
    "TMC5160": Chip(
        ("spi",), TMC5160, CurrentLaw((CurrentRange(0, 0.325),), 0.075, scaled=True), 12_000_000,
        _WITH_SCALER | {"pwm_ofs": 30}, 0x30,
    ),
    "TMC2240": Chip(
        ("spi", "uart"), TMC2240,
        CurrentLaw(
            tuple(CurrentRange(i, v) for i, v in enumerate((11_750.0, 24_000.0, 36_000.0))),
            12_000.0, select="current_range", scaled=True,
        ),
        12_500_000,
        _WITH_SCALER | _ANSWER | {"pwm_ofs": 29, "irundelay": 4, "sg4_angle_offset": 1}, 0x40,
        addresses=8, shown=("GCONF", "CHOPCONF", "DRV_CONF"),
        measured=("ADC_TEMP", "ADC_VSUPPLY_AIN"),
    ),
    "TMC2660": Chip(
        ("spi20",), TMC2660,
        CurrentLaw(
            (CurrentRange(1, 0.165), CurrentRange(0, 0.310)), 0.051, select="vsense", run="cs",
            hold="",
        ),
        15_000_000,
        {"rdsel": 1, "semin": 0, "sgt": 0} | _CHOPPER, shown=(),
    ),
}  # fmt: skip
assert set(CHIPS) == set(get_args(ChipName))


def chip_of(driver: object) -> ChipName | None:
    """The name of a motor's `driver`, if it is a supported chip with registers."""
    return next((chip for chip in CHIPS if chip == driver), None)
