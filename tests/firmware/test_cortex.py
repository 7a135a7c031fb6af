"""The firmware of Cortex-M chips, on an instruction-set simulator: it starts, speaks and steps."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from itertools import pairwise
from math import ceil
from pathlib import Path

import pytest
from tests.support import kept

from passo.board.dictionary import Dictionary
from passo.toolchain import arm
from passo.toolchain.build import build
from passo.toolchain.targets import board_target

from .chips import Mk20dx128, Mk20dx256, Rp2040, Sam3u4e, Sam3x8e, Stm32f4, Stm32f429
from .cortex import Cortex
from .talk import Host, identified


@dataclass(frozen=True)
class Case:
    """A board, the model of its chip, and pins to try: what each of them does, and its number."""

    board: str
    model: type[Cortex]
    step: tuple[str, int]
    direction: tuple[str, int]
    output: tuple[str, int]
    pulse: tuple[str, str, str]  # its timer, its channel
    sensor: tuple[str, int]  # its channel
    first_vector: int = 0

    @property
    def hz(self) -> int:
        return self.model.CLOCK_HZ

    def host(self) -> Host:
        return Host(self.model(image(self.board)), dictionary_of(self.board))


CASES = [
    Case(
        *("radds", Sam3x8e, ("PC25", 89), ("PC26", 90), ("PD7", 103)),
        *(("PC24", "PWM7", "L"), ("PA16", 7)),
    ),
    Case(
        *("4pi", Sam3u4e, ("PC28", 92), ("PB8", 40), ("PA21", 21)),
        *(("PA20", "PWM3", "H"), ("PC16", 5)),
    ),
    Case(
        *("stm32f407-discovery", Stm32f4, ("PD6", 102), ("PD3", 99), ("PH1", 225)),
        *(("PD13", "TIM4", "2"), ("PC5", 15)),
    ),
    Case(
        *("stm32f429-discovery", Stm32f429, ("PG3", 195), ("PG2", 194), ("PG14", 206)),
        *(("PE14", "TIM1", "4"), ("PF6", 104)),
    ),
    Case(
        *("pico", Rp2040, ("gpio2", 2), ("gpio3", 3), ("gpio29", 29)),
        *(("gpio21", "PWM2", "B"), ("gpio28", 2)),
        first_vector=256,
    ),
    Case(
        *("teensy3-mk20dx128", Mk20dx128, ("PTB16", 48), ("PTB17", 49), ("PTB1", 33)),
        *(("PTC4", "FTM0", "3"), ("PTB3", 13)),
    ),
    Case(
        *("teensy3-mk20dx256", Mk20dx256, ("PTB16", 48), ("PTB17", 49), ("PTB1", 33)),
        *(("PTB19", "FTM2", "1"), ("PTD5", 6)),
    ),
]


# Pins of consoles, and of crystals and debuggers.
TAKEN = ("PA8", "PA9", "PA11", "PA12", "PA2", "PA3", "gpio0", "gpio1", "PTA0", "PTA3")


@cache
def image(board: str, compiler: str = "arm-none-eabi-gcc") -> bytes:
    """The flash's content, out of the file for the flashing program."""

    def make(folder: Path) -> Path:
        with pytest.MonkeyPatch.context() as patch:
            if compiler == "ziglang":
                patch.setenv("PATH", str(folder))
            command = arm.compiler()
            assert command is not None and compiler in command
            return build(board_target(board), folder)[0]

    made_from = (*kept.FIRMWARE, kept.ROOT / "src/passo/config", version("ziglang"))
    path = kept.kept(f"image-{board}-{compiler}", made_from, ["arm-none-eabi-gcc"], make)
    data = path.read_bytes()
    if path.suffix == ".uf2":
        return b"".join(data[i + 32 : i + 288] for i in range(0, len(data), 512))
    if path.suffix == ".hex":
        rows = (bytes.fromhex(line[1:]) for line in data.decode().split())
        return b"".join(row[4:-1] for row in rows if row[3] == 0)
    return data


@cache
def dictionary_of(board: str) -> Dictionary:
    (model,) = (case.model for case in CASES if case.board == board)
    return identified(model(image(board)))


@pytest.fixture(params=CASES, ids=lambda case: case.board)
def case(request: pytest.FixtureRequest) -> Case:
    return request.param


def test_cortex_identifies(case: Case) -> None:
    host = case.host()
    dictionary = host.dictionary
    assert dictionary.number("CLOCK_FREQ") == case.hz
    assert dictionary.number("ADC_MAX") == 4095
    assert dictionary.constants["MCU"] == board_target(case.board).board.mcu
    for name, number in (case.step, case.direction, case.output):
        assert dictionary.enumerations["pin"][name] == number
    answer = host.send("get_uptime")["uptime"]
    assert answer["clock"] == pytest.approx(host.chip.clock, abs=0.002 * case.hz)


def test_image_of_other_compiler_runs(case: Case) -> None:
    dictionary = identified(case.model(image(case.board, "ziglang")))
    assert dictionary.constants["MCU"] == board_target(case.board).board.mcu


def configured(case: Case) -> Host:
    host = case.host()
    host.send(
        "allocate_oids count=6",
        f"config_stepper oid=0 step_pin={case.step[0]} dir_pin={case.direction[0]} invert_step=0"
        f" step_pulse_ticks={2 * case.hz // 1_000_000}",
        f"config_digital_out oid=1 pin={case.output[0]} value=0 default_value=0 max_duration=0",
        f"config_analog_in oid=2 pin={case.sensor[0]}",
        f"config_pwm_out oid=3 pin={case.pulse[0]} cycle_ticks={case.hz // 10_000} value=0"
        " default_value=0 max_duration=0",
        "config_trsync oid=5",
    )
    return host


def finalized(case: Case) -> Host:
    host = configured(case)
    host.send("finalize_config crc=7")
    state = host.send("get_config")["config"]
    assert (state["is_config"], state["crc"], state["is_shutdown"]) == (1, 7, 0)
    assert state["move_count"] >= board_target(case.board).board.move_count
    return host


def test_cortex_steps_in_time(case: Case) -> None:
    host = finalized(case)
    us = case.hz // 1_000_000
    start = host.chip.clock + case.hz // 100
    host.chip.edges.clear()
    host.send(
        f"reset_step_clock oid=0 clock={start}",
        "set_next_step_dir oid=0 dir=1",
        f"queue_step oid=0 interval={100 * us} count=50 add={-us}",
        "set_next_step_dir oid=0 dir=0",
        f"queue_step oid=0 interval={200 * us} count=20 add=0",
    )
    host.chip.run(0.02)
    due, at, interval = [], start, 100 * us
    for _ in range(50):
        at, interval = at + interval, interval - us
        due.append(at)
    due += [at + 200 * us * (i + 1) for i in range(20)]
    step, direction = case.step[1], case.direction[1]
    rises = [clock for clock, pin, level in host.chip.edges if pin == step and level]
    falls = [clock for clock, pin, level in host.chip.edges if pin == step and not level]
    assert len(rises) == len(falls) == 70
    late = [rise - wanted for rise, wanted in zip(rises, due, strict=True)]
    assert min(late) >= 0
    assert max(late) * case.model.CORE_HZ / case.hz <= 260  # cycles
    assert all(fall - rise >= 2 * us for rise, fall in zip(rises, falls, strict=True))
    assert [level for _, pin, level in host.chip.edges if pin == direction] == [1, 0]
    assert host.send("stepper_get_position oid=0")["stepper_position"]["pos"] == 30


def test_steps_that_are_late_keep_pulse_and_low_time(case: Case) -> None:
    host = finalized(case)
    us = case.hz // 1_000_000
    start = host.chip.clock + case.hz // 100
    host.chip.edges.clear()
    host.send(
        f"reset_step_clock oid=0 clock={start}",
        "set_next_step_dir oid=0 dir=1",
        f"queue_step oid=0 interval={2 * us + 1} count=40 add=0",  # no time for a pause
    )
    host.chip.run(0.02)
    edges = [(clock, level) for clock, pin, level in host.chip.edges if pin == case.step[1]]
    assert [level for _, level in edges] == [1, 0] * 40
    assert min(b - a for (a, _), (b, _) in pairwise(edges)) >= 2 * us
    # They catch up as far as that lets them.
    assert edges[-1][0] - edges[0][0] < 40 * 2 * 2 * us + 40 * 400 * case.hz / case.model.CORE_HZ


@pytest.mark.parametrize("pulse_us", [0.1, 2])
def test_three_motors_keep_up_with_the_budget_of_the_board(case: Case, pulse_us: float) -> None:
    """A tenth more steps than the planner gives the board, beside all the commands that its link
    carries, each in a frame of its own, which is more work than several in one."""
    board = board_target(case.board).board
    spec = board.model_copy(update={"link": "serial", "port": "x"}).budget_spec(pulse_us)
    assert spec
    host = case.host()
    pins = [pin for pin in board_target(case.board).chip.pins if pin not in TAKEN][:3]
    numbers = host.dictionary.enumerations["pin"]
    host.send(
        "allocate_oids count=3",
        *(
            f"config_stepper oid={i} step_pin={pin} dir_pin={case.direction[0]} invert_step=0"
            f" step_pulse_ticks={ceil(pulse_us * case.hz / 1e6)}"
            for i, pin in enumerate(pins)
        ),
        "finalize_config crc=1",
    )
    steps_s = 1.1 * spec["steps_s"]
    interval = round(3 * case.hz / steps_s)
    count = int(steps_s / spec["commands_s"])
    start = host.chip.clock + case.hz // 100
    orders = [
        f"queue_step oid={i} interval={interval} count={count} add=0" for i in (*range(3),) * 18
    ]
    host.send(*(f"reset_step_clock oid={i} clock={start + i * interval // 3}" for i in range(3)))
    host.send(*orders[:9])
    host.chip.edges.clear()
    host.chip.run((start - host.chip.clock) / case.hz)
    for order in orders[9:]:
        host.give(order)
        host.chip.run(1 / spec["commands_s"])
    host.chip.run(4 * count * interval / case.hz)
    for i, pin in enumerate(pins):
        rises = [at for at, n, level in host.chip.edges if n == numbers[pin] and level]
        first = start + i * interval // 3 + interval
        late = [at - first - k * interval for k, at in enumerate(rises)]
        assert len(late) == 18 * count
        assert max(late) < case.hz // 50_000  # 20 µs


def test_outputs_sensors_and_the_shutdown(case: Case) -> None:
    host = finalized(case)
    _, timer, channel = case.pulse
    assert host.chip.pulse(timer, channel)[0] == 0
    host.chip.analog[case.sensor[1]] = 1234
    at = host.chip.clock + case.hz // 100
    host.send(
        f"queue_digital_out oid=1 clock={at} on_ticks=1",
        f"queue_pwm_out oid=3 clock={at} value=128",
        f"query_analog_in oid=2 clock={at} sample_ticks={case.hz // 1000} sample_count=4"
        f" rest_ticks={case.hz // 100} bytes_per_report=2 min_value=0 max_value=16380"
        " range_check_count=4",
    )
    reports = host.send("get_clock", seconds=0.03)
    output = case.output[1]
    (rise,) = (clock for clock, pin, level in host.chip.edges if pin == output and level)
    assert 0 <= rise - at < case.hz // 100_000
    share, cycle = host.chip.pulse(timer, channel)
    assert share == pytest.approx(128 / 255, abs=0.001)
    assert cycle == pytest.approx(1e-4, rel=0.5 if isinstance(host.chip, Sam3x8e) else 0.01)
    values = reports["analog_in_state"]["values"]
    assert isinstance(values, bytes)
    assert int.from_bytes(values[-2:], "little") == 4 * 1234
    host.send("emergency_stop")
    assert host.chip.levels[output] == 0
    assert host.chip.pulse(timer, channel)[0] == 0
    assert host.send("get_config")["config"]["is_shutdown"] == 1


def test_input_no_longer_sampled_releases_the_adc(case: Case) -> None:
    host = case.host()
    inputs = board_target(case.board).chip.adc
    other = next(pin for pin in inputs if pin not in (case.sensor[0], *TAKEN))
    host.send(
        "allocate_oids count=2",
        f"config_analog_in oid=0 pin={case.sensor[0]}",
        f"config_analog_in oid=1 pin={other}",
        "finalize_config crc=1",
    )
    us = case.hz // 1_000_000
    asked = "query_analog_in oid={} clock={} sample_ticks={} sample_count={} rest_ticks={}"
    limits = " bytes_per_report=2 min_value=0 max_value=65535 range_check_count=0"

    def ask(oid: int, count: int) -> str:
        start = host.chip.clock + 400 * us
        return asked.format(oid, start, 15 * us, count, case.hz // 2) + limits

    for trial in range(12):
        host.send(ask(0, 200), seconds=0.0008 + trial * 1e-6)
        host.send(ask(0, 0))  # now, while one of its samples is under way, most probably
        reports = host.send(ask(1, 1), seconds=0.002)
        assert reports["analog_in_state"]["oid"] == 1
        host.send(ask(1, 0))


def test_fully_on_has_no_gap(case: Case) -> None:
    host = finalized(case)
    host.send(f"queue_pwm_out oid=3 clock={host.chip.clock + case.hz // 100} value=255")
    host.chip.run(0.012)
    assert host.chip.pulse(*case.pulse[1:])[0] == 1


PAIRS = [
    # board, two pins of one timer, two pins of one channel
    ("stm32f407-discovery", ("PD12", "PD13", "TIM4", "1", "2"), ("PE9", "PA8")),
    ("pico", ("gpio20", "gpio21", "PWM2", "A", "B"), ("gpio4", "gpio20")),
    ("teensy3-mk20dx256", ("PTC3", "PTC4", "FTM0", "2", "3"), ("PTA12", "PTB0")),
]


@pytest.mark.parametrize("board", [board for board, _, _ in PAIRS])
def test_timer_has_one_cycle_and_channel_one_owner(board: str) -> None:
    (case,) = (case for case in CASES if case.board == board)
    (_, (first, second, timer, *channels), same) = next(row for row in PAIRS if row[0] == board)
    host = case.host()
    wishes = (case.hz // 10_000, case.hz // 100)
    host.send("allocate_oids count=2")
    for oid, (pin, cycle, value) in enumerate(zip((first, second), wishes, (51, 204), strict=True)):
        host.send(
            f"config_pwm_out oid={oid} pin={pin} cycle_ticks={cycle} value={value}"
            " default_value=0 max_duration=0"
        )
    (share, cycle), (other, same_cycle) = (host.chip.pulse(timer, it) for it in channels)
    assert (share, other) == pytest.approx((0.2, 0.8), abs=0.001)
    assert cycle == same_cycle == pytest.approx(1e-4, rel=0.01)
    host = case.host()
    host.send("allocate_oids count=2")
    states = []
    for oid, pin in enumerate(same):
        host.send(
            f"config_pwm_out oid={oid} pin={pin} cycle_ticks={wishes[0]} value=0 default_value=0"
            " max_duration=0"
        )
        states.append(host.send("get_config")["config"]["is_shutdown"])
    assert states == [0, 1]


@pytest.mark.parametrize("ticks", [1, 2**31 - 1])
def test_the_shortest_and_the_longest_cycle(case: Case, ticks: int) -> None:
    host = case.host()
    host.send(
        "allocate_oids count=1",
        f"config_pwm_out oid=0 pin={case.pulse[0]} cycle_ticks={ticks} value=85 default_value=0"
        " max_duration=0",
    )
    share, cycle = host.chip.pulse(*case.pulse[1:])
    assert share == pytest.approx(1 / 3, abs=0.001)
    assert cycle < 1e-5 if ticks == 1 else cycle > 2.5e-3


def test_an_output_of_the_console_or_none_is_refused(case: Case) -> None:
    host = case.host()
    console = board_target(case.board).board.console
    assert console
    pin = board_target(case.board).board.pin(console.pins[0])
    host.send(
        "allocate_oids count=1",
        f"config_digital_out oid=0 pin={pin} value=0 default_value=0 max_duration=0",
    )
    assert host.send("get_config")["config"]["is_shutdown"] == 1


@pytest.mark.parametrize("pin", ["PTA18", "PTA19"])
@pytest.mark.parametrize("words", ["digital_out", "endstop"])
def test_a_teensy_keeps_the_pins_of_its_crystal(words: str, pin: str) -> None:
    host = next(case for case in CASES if case.board == "teensy3-mk20dx256").host()
    more = "value=0 default_value=0 max_duration=0" if words == "digital_out" else "pull_up=0"
    host.send("allocate_oids count=1", f"config_{words} oid=0 pin={pin} {more}")
    assert host.send("get_config")["config"]["is_shutdown"] == 1


@pytest.mark.parametrize(("pulse_us", "taken"), [(30, 1), (31, 0)])
def test_a_pulse_that_would_hold_up_everything_is_refused(
    case: Case, pulse_us: int, taken: int
) -> None:
    host = case.host()
    host.send(
        "allocate_oids count=1",
        f"config_stepper oid=0 step_pin={case.step[0]} dir_pin={case.direction[0]} invert_step=0"
        f" step_pulse_ticks={pulse_us * case.hz // 1_000_000}",
        "finalize_config crc=1",
    )
    state = host.send("get_config")["config"]
    assert (state["is_config"], state["is_shutdown"]) == (taken, 1 - taken)


def test_an_endstop_is_looked_at_every_15_us(case: Case) -> None:
    host = configured(case)
    sample = 15 * case.hz // 1_000_000
    host.send(f"config_endstop oid=4 pin={case.output[0]} pull_up=1", "finalize_config crc=1")
    start = host.chip.clock + case.hz // 100
    interval = case.hz // 10_000
    host.chip.edges.clear()
    host.send(
        f"reset_step_clock oid=0 clock={start}",
        f"queue_step oid=0 interval={interval} count=1000 add=0",
        f"trsync_start oid=5 report_clock={start} report_ticks={case.hz // 4} expire_reason=2",
        "stepper_stop_on_trigger oid=0 trsync_oid=5",
        f"endstop_home oid=4 clock={start} sample_ticks={sample} sample_count=4"
        f" rest_ticks={sample} pin_value=1 trsync_oid=5 trigger_reason=1",
    )
    assert host.send("get_config", seconds=0.02)["config"]["is_shutdown"] == 0
    host.chip.inputs[case.output[1]] = 1
    hit = host.chip.clock
    state = host.send("get_clock", seconds=0.002)["trsync_state"]
    assert (state["can_trigger"], state["trigger_reason"]) == (0, 1)
    clock = state["clock"]
    assert isinstance(clock, int)
    assert 3 * sample <= clock - hit < 6 * sample
    rises = [at for at, pin, level in host.chip.edges if pin == case.step[1] and level]
    assert len(rises) < 1000
    assert 0 <= clock - rises[-1] < 1.05 * interval


def test_reset_restarts_the_chip(case: Case) -> None:
    host = case.host()
    host.send("emergency_stop")
    host.give("reset")
    host.chip.run(0.01)
    assert host.chip.resets > 0


def test_the_watchdog_is_on_and_fed(case: Case) -> None:
    host = case.host()
    assert 0.5 <= host.chip.watchdog_s <= 1.1
    host.chip.run(0.03)
    before = host.chip.fed
    host.chip.run(0.05)
    assert 4 <= host.chip.fed - before <= 5


def test_vectors_lead_into_the_code(case: Case) -> None:
    model, data = case.model, image(case.board)
    count = 16 + arm_interrupts(case.board)
    words = struct.unpack_from(f"<{count}I", data, case.first_vector)
    first = case.model.RAM[0] if case.board == "pico" else case.model.FLASH
    chip = board_target(case.board).chip
    assert words[0] == chip.ram_start + chip.ram_bytes
    end, mark = words[7:9]  # for the flasher
    assert mark == 0x6F737350
    assert 0 <= chip.flash_start + len(data) - end < (256 if case.board == "pico" else 1)
    used = [word for word in words[1:7] + words[9:] if word]
    assert all(word & 1 and first < word < first + len(data) for word in used)
    assert len(used) == 8 + 1 + arm_interrupts(case.board)
    assert len({words[14], words[15], words[16 + model.UART_IRQ], words[3]}) == 4


def arm_interrupts(board: str) -> int:
    """Interrupts of the chip, by its data sheet (those of the larger STM32F4 for both)."""
    chip = board_target(board).chip.key
    known = {"sam3x8e": 45, "sam3u4e": 30, "rp2040": 26, "mk20dx128": 46, "mk20dx256": 95}
    return known.get(chip, 91)


@pytest.mark.parametrize("board", ["teensy3-mk20dx128", "teensy3-mk20dx256"])
def test_hidden_overrun_does_not_stop_mk20_uart(board: str) -> None:
    (case,) = (case for case in CASES if case.board == board)
    host = case.host()
    assert isinstance(host.chip, Mk20dx256)
    for _ in range(3):
        host.chip.collides = True
        assert host.send("get_clock", seconds=0.001)["clock"]
        assert not host.chip.collides


@pytest.mark.parametrize("board", ["teensy3-mk20dx128", "teensy3-mk20dx256"])
def test_mk20_flash_stays_unlocked(board: str) -> None:
    assert image(board)[0x400:0x410] == bytes.fromhex("ff" * 12 + "fef9ffff")


def test_the_second_stage_of_an_rp2040_sets_up_its_flash() -> None:
    chip = Rp2040(image("pico"))
    chip.run(0.0003)
    flash = {
        address - 0x18000000: v for address, v in chip.registers.items() if address >> 24 == 24
    }
    # Off, a fourth of the clock, command and read with words of 32 bits, one of them, on.
    assert flash == {8: 1, 0x14: 4, 0: 31 << 16 | 3 << 8, 4: 0, 0xF4: 0x03000218}
    assert chip.vectors == 0x20000000
    assert chip.uc.mem_read(0x20000000, 10_000) == image("pico")[256:10_256]


# What the clocks and the UART are set to, by register: frequencies are products of these.
CLOCKS = {
    # 12 MHz × 14 / 2; 84 MHz / 16 / 46 = 114 130 baud, 0.9 % less than 115 200
    "radds": {0x400E0628: 0x200D3F01, 0x400E0630: 0x12, 0x400E0820: 46},
    "4pi": {0x400E0428: 0x200F3F01, 0x400E0430: 0x12, 0x400E0620: 24},
    # 8 MHz / 8 × 336 / 2, buses at a half and a quarter; 42 MHz / 168
    "stm32f407-discovery": {0x40023804: 0x07405408, 0x40023808: 0x9402, 0x40004808: 168},
    "stm32f429-discovery": {0x40023804: 0x07405408, 0x40023808: 0x9402, 0x40004408: 168},
    # 12 MHz × 120 / 6 / 2 and × 100 / 5 / 5; 120 MHz / 16 / 30
    "pico": {
        0x40028004: 4,
        0x40028008: 120,
        0x4002800C: 0x62000,
        0x4002C008: 100,
        0x4002C00C: 0x55000,
        0x40034024: 30,
        0x40034028: 0,
        0x40008048: 1 << 11,
        0x40008060: 1 << 11,
    },
    # 16 MHz / 8 × 24 or × 36; core, bus, flash; core / 16 / 12 or 18
    "teensy3-mk20dx128": {
        0x40064004: 7,
        0x40064005: 0x40,
        0x40064000: 0x20,
        0x40048044: 0x00010000,
        0x4006B000: 0,
        0x4006B001: 12,
        0x4006B00A: 0,
    },
    "teensy3-mk20dx256": {
        0x40064004: 7,
        0x40064005: 0x4C,
        0x40064000: 0x20,
        0x40048044: 0x01020000,
        0x4006B000: 0,
        0x4006B001: 18,
        0x4006B00A: 0,
    },
}


def test_clocks_are_set_to_the_reported_counts(case: Case) -> None:
    chip = case.host().chip
    expected = CLOCKS[case.board]
    assert {address: chip.registers.get(address) for address in expected} == expected


def test_stm32f4_without_crystal_runs_on_own_oscillator() -> None:
    class Crystalless(Stm32f4):
        def read(self, address: int, size: int) -> int | None:
            value = super().read(address, size)
            return value & ~(1 << 17) if address == 0x40023800 and value else value

    chip = Crystalless(image("stm32f407-discovery"))
    chip.run(0.02)
    assert chip.registers[0x40023804] == 0x07005410  # 16 MHz / 16 × 336 / 2
    assert chip.registers[0x40023808] == 0x9402
    assert len(chip.sent) > 0


RADDS = CASES[0]
PC24, PC26, PD7, PC25 = 88, 90, 103, 89


def test_a_heater_is_off_before_the_last_messages() -> None:
    host = RADDS.host()
    host.send(
        "allocate_oids count=3",
        "config_spi_without_cs oid=0",
        "spi_set_sw_bus oid=0 miso_pin=PC24 mosi_pin=PC25 sclk_pin=PC26 mode=0 pulse_ticks=420",
        "config_spi_shutdown oid=1 spi_oid=0 shutdown_msg=55",
        "config_digital_out oid=2 pin=PD7 value=0 default_value=0 max_duration=0",
        "finalize_config crc=1",
        "update_digital_out oid=2 value=1",
    )
    host.chip.edges.clear()
    host.send("emergency_stop")
    pins = [pin for _, pin, _ in host.chip.edges if pin != PC25]
    assert pins == [PD7] + [PC26] * 16


@pytest.mark.parametrize(("oid", "longest"), [(0, 0), (1, 2**31), (1, 42)])
def test_a_pulsed_output_that_is_refused_is_put_to_its_default(oid: int, longest: int) -> None:
    host = RADDS.host()
    host.send(
        "allocate_oids count=2",
        "config_trsync oid=0",
        f"config_pwm_out oid={oid} pin=PC24 cycle_ticks=4200 value=128 default_value=3"
        f" max_duration={longest}",
    )
    assert host.chip.pulse("PWM7", "L")[0] == 3 / 255


def test_either_output_of_a_pulsed_channel_has_it_alone() -> None:
    host = RADDS.host()
    states = []
    host.send("allocate_oids count=3")
    for oid, pin in enumerate(("PC20", "PA19", "PC21")):
        host.send(
            f"config_pwm_out oid={oid} pin={pin} cycle_ticks=4200 value=51 default_value=0"
            " max_duration=0"
        )
        states.append(host.send("get_config")["config"]["is_shutdown"])
        if pin == "PA19":
            assert host.chip.pulse("PWM1", "H")[0] == host.chip.pulse("PWM4", "H")[0] == 0.2
    assert states == [0, 0, 1]  # PC20 and PC21 are the two outputs of channel 4


def test_missing_compiler_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(arm, "compiler", lambda: None)
    with pytest.raises(Exception, match="arm-none-eabi-gcc") as caught:
        build(board_target("radds"), tmp_path)
    assert caught.value.status == 2
