"""The firmware of a Due's chip, on an instruction-set simulator: it starts, speaks and steps."""

from __future__ import annotations

from pathlib import Path

import pytest

from passo import _core
from passo.board.dictionary import Dictionary
from passo.board.identify import Identification
from passo.toolchain import arm
from passo.toolchain.build import build
from passo.toolchain.targets import board_target

from .cortex import Sam3x8e

HZ = 42_000_000
PB1, PC25, PC26, PA16, PC24, PD7 = 33, 89, 90, 16, 88, 103


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path, _ = build(board_target("radds"), tmp_path_factory.mktemp("image"))
    return path.read_bytes()


class Host:
    """Speaks to the chip, a frame at a time."""

    def __init__(self, image: bytes) -> None:
        self.chip = Sam3x8e(image)
        found = Identification()
        while found.dictionary is None:
            data, _ = found.poll(self.chip.cycles / 84e6)
            self.chip.received.extend(data)
            self.chip.run(0.002)
            found.feed(self.heard())
            assert self.chip.cycles < 84e6
        self.identity, self.dictionary = found, found.dictionary
        self._commands = _core.Formats(list(self.dictionary.commands))
        self._reports = _core.Formats(list(self.dictionary.reports))
        self._scanner = _core.FrameScanner()
        self._sequence = found._sequence

    def heard(self) -> bytes:
        data = bytes(self.chip.sent)
        self.chip.sent.clear()
        return data

    def send(self, *lines: str, seconds: float = 0.002) -> dict[str, dict[str, int | bytes]]:
        """Sends commands, a frame each; the last report of each name that comes back in time."""
        reports: dict[str, dict[str, int | bytes]] = {}
        for line in lines:
            payload = self._commands.encode(*self.dictionary.values(line))
            self.chip.received.extend(_core.make_frame(payload, self._sequence))
            self._sequence = (self._sequence + 1) % 16
            self.chip.run(seconds)
            for frame in self._scanner.feed(self.heard()):
                assert frame is not None and frame[0] == self._sequence
                reports |= dict(self._reports.decode(frame[1]))
        return reports


def test_it_tells_who_it_is(image: bytes) -> None:
    host = Host(image)
    dictionary: Dictionary = host.dictionary
    assert dictionary.number("CLOCK_FREQ") == HZ
    assert dictionary.number("ADC_MAX") == 4095
    assert dictionary.constants["MCU"] == "sam3x8e"
    assert dictionary.enumerations["pin"]["PD10"] == 3 * 32 + 10
    answer = host.send("get_uptime")["uptime"]
    assert answer["clock"] == pytest.approx(host.chip.clock, abs=0.002 * HZ)


def configured(host: Host) -> None:
    host.send(
        "allocate_oids count=4",
        "config_stepper oid=0 step_pin=PC25 dir_pin=PC26 invert_step=0 step_pulse_ticks=84",
        "config_digital_out oid=1 pin=PD7 value=0 default_value=0 max_duration=0",
        "config_analog_in oid=2 pin=PA16",
        "config_pwm_out oid=3 pin=PC24 cycle_ticks=4200 value=0 default_value=0 max_duration=0",
        "finalize_config crc=7",
    )
    state = host.send("get_config")["config"]
    assert (state["is_config"], state["crc"], state["is_shutdown"]) == (1, 7, 0)


def test_it_steps_in_time(image: bytes) -> None:
    host = Host(image)
    configured(host)
    start = host.chip.clock + HZ // 50
    host.chip.edges.clear()
    host.send(
        f"reset_step_clock oid=0 clock={start}",
        "set_next_step_dir oid=0 dir=1",
        "queue_step oid=0 interval=4200 count=50 add=-20",
        "set_next_step_dir oid=0 dir=0",
        "queue_step oid=0 interval=8400 count=20 add=0",
    )
    host.chip.run(0.05)
    due, at, interval = [], start, 4200
    for _ in range(50):
        at, interval = at + interval, interval - 20
        due.append(at)
    due += [at + 8400 * (i + 1) for i in range(20)]
    rises = [clock for clock, pin, level in host.chip.edges if pin == PC25 and level]
    falls = [clock for clock, pin, level in host.chip.edges if pin == PC25 and not level]
    assert len(rises) == len(falls) == 70
    assert all(0 <= rise - wanted < 130 for rise, wanted in zip(rises, due, strict=True))  # 3 µs
    assert all(fall - rise >= 84 for rise, fall in zip(rises, falls, strict=True))
    turns = [level for _, pin, level in host.chip.edges if pin == PC26]
    assert turns == [1, 0]
    assert host.send("stepper_get_position oid=0")["stepper_position"]["pos"] == 30


def test_outputs_sensors_and_the_shutdown(image: bytes) -> None:
    host = Host(image)
    configured(host)
    host.chip.analog[7] = 1234
    at = host.chip.clock + HZ // 50
    host.send(
        f"queue_digital_out oid=1 clock={at} on_ticks=1",
        f"queue_pwm_out oid=3 clock={at} value=128",
        f"query_analog_in oid=2 clock={at} sample_ticks=42000 sample_count=4 rest_ticks=420000"
        " bytes_per_report=2 min_value=0 max_value=16380 range_check_count=4",
    )
    reports = host.send("get_clock", seconds=0.05)
    (rise,) = (clock for clock, pin, level in host.chip.edges if pin == PD7 and level)
    assert 0 <= rise - at < 420
    assert host.chip.duties[7] == 128
    values = reports["analog_in_state"]["values"]
    assert isinstance(values, bytes)
    assert int.from_bytes(values[-2:], "little") == 4 * 1234
    host.send("emergency_stop")
    assert host.chip.levels[PD7] == 0
    assert host.chip.duties[7] == 0
    assert host.send("get_config")["config"]["is_shutdown"] == 1


def test_a_heater_is_off_before_the_last_messages(image: bytes) -> None:
    host = Host(image)
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
def test_a_pulsed_output_that_is_refused_is_put_to_its_default(image, oid, longest) -> None:
    host = Host(image)
    host.send(
        "allocate_oids count=2",
        "config_trsync oid=0",
        f"config_pwm_out oid={oid} pin=PC24 cycle_ticks=4200 value=128 default_value=3"
        f" max_duration={longest}",
    )
    assert host.chip.duties[7] == 3


def test_an_endstop_is_looked_at_every_15_us(image: bytes) -> None:
    host = Host(image)
    host.send(
        "allocate_oids count=3",
        "config_stepper oid=0 step_pin=PC25 dir_pin=PC26 invert_step=0 step_pulse_ticks=84",
        "config_endstop oid=1 pin=PD7 pull_up=1",
        "config_trsync oid=2",
        "finalize_config crc=1",
    )
    start = host.chip.clock + HZ // 50
    host.chip.edges.clear()
    host.send(
        f"reset_step_clock oid=0 clock={start}",
        "queue_step oid=0 interval=4200 count=1000 add=0",
        f"trsync_start oid=2 report_clock={start} report_ticks={HZ // 4} expire_reason=2",
        "stepper_stop_on_trigger oid=0 trsync_oid=2",
        f"endstop_home oid=1 clock={start} sample_ticks=630 sample_count=4 rest_ticks=630"
        " pin_value=1 trsync_oid=2 trigger_reason=1",
    )
    assert host.send("get_config", seconds=0.05)["config"]["is_shutdown"] == 0
    host.chip.inputs[PD7] = 1
    hit = host.chip.clock
    state = host.send("get_clock", seconds=0.01)["trsync_state"]
    assert (state["can_trigger"], state["trigger_reason"]) == (0, 1)
    clock = state["clock"]
    assert isinstance(clock, int)
    assert 3 * 630 <= clock - hit < 6 * 630
    rises = [at for at, pin, level in host.chip.edges if pin == PC25 and level]
    assert len(rises) < 1000
    assert 0 <= clock - rises[-1] < 4400


def test_reset_starts_the_chip_anew(image: bytes) -> None:
    host = Host(image)
    host.send("emergency_stop")
    payload = host._commands.encode("reset", [])
    host.chip.received.extend(_core.make_frame(payload, host._sequence))
    host.chip.run(0.01)
    assert host.chip.resets > 0


def test_vectors_lead_into_the_flash(image: bytes) -> None:
    words = [int.from_bytes(image[i : i + 4], "little") for i in range(0, 4 * (16 + 45), 4)]
    assert words[0] == 0x20070000 + 96 * 1024
    used = [word for word in words[1:] if word]
    assert all(word & 1 and 0x80000 < word < 0x80000 + len(image) for word in used)
    assert len(used) == 8 + 1 + 45
    assert len({words[14], words[15], words[16 + 8], words[3]}) == 4


def test_without_a_compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(arm, "compiler", lambda: None)
    with pytest.raises(Exception, match="arm-none-eabi-gcc") as caught:
        build(board_target("radds"), tmp_path)
    assert caught.value.status == 2
