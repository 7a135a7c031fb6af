"""The firmware of an STM32F4 on QEMU: start-up, interrupts, protocol."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import pytest

from passo.toolchain import arm
from passo.toolchain.build import build
from passo.toolchain.images import About
from passo.toolchain.targets import board_target

from .machine import Host, Machine

HZ = 84_000_000


@pytest.fixture(scope="module", params=["arm-none-eabi-gcc", "ziglang"])
def built(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, About]:
    folder = tmp_path_factory.mktemp("image")
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "ziglang":
            patch.setenv("PATH", str(folder))
        command = arm.compiler()
        assert command is not None and request.param in command
        return build(board_target("stm32f407-discovery"), folder)


@pytest.fixture
def host(built: tuple[Path, About]) -> Iterator[Host]:
    machine = Machine(built[0])
    try:
        machine.control("cont")
        host = Host(machine)
        machine.slow_the_clock()
        yield host
    finally:
        machine.close()


def test_stm32f4_starts_and_identifies(host: Host, built: tuple[Path, About]) -> None:
    assert sha256(host.compressed).hexdigest() == built[1].dictionary_sha256
    assert host.dictionary.constants["MCU"] == "stm32f407"
    assert host.dictionary.number("CLOCK_FREQ") == HZ
    assert host.dictionary.enumerations["pin"]["PE5"] == 4 * 32 + 5
    before = host.machine.clock()
    clock = host.ask("get_clock", "clock")["clock"]
    assert isinstance(clock, int)
    assert 0 <= (clock - before) % 2**32 <= (host.machine.clock() - before) % 2**32


def configure(host: Host) -> None:
    host.send(
        "allocate_oids count=4",
        "config_stepper oid=0 step_pin=PD6 dir_pin=PD3 invert_step=0 step_pulse_ticks=168",
        "config_digital_out oid=1 pin=PD12 value=0 default_value=0 max_duration=0",
        "config_trsync oid=2",
        "config_stepper oid=3 step_pin=PE3 dir_pin=PE4 invert_step=0 step_pulse_ticks=168",
        "finalize_config crc=7",
    )
    state = host.ask("get_config", "config")
    assert (state["is_config"], state["crc"], state["is_shutdown"]) == (1, 7, 0)
    assert state["move_count"] == 1024


def test_two_motors_step_and_a_timer_runs_out_in_time(host: Host) -> None:
    configure(host)
    machine = host.machine
    machine.control("stop")
    start = machine.clock() + HZ // 5
    expires = start + HZ // 6
    host.send(
        "trsync_start oid=2 report_clock=0 report_ticks=0 expire_reason=3",
        f"trsync_set_timeout oid=2 clock={expires % 2**32}",
        f"reset_step_clock oid=0 clock={start % 2**32}",
        f"reset_step_clock oid=3 clock={start % 2**32}",
        "set_next_step_dir oid=0 dir=1",
        "queue_step oid=0 interval=8400 count=650 add=-8",
        "queue_step oid=3 interval=12600 count=700 add=4",
        "set_next_step_dir oid=0 dir=0",
        "queue_step oid=0 interval=4200 count=200 add=0",
    )
    machine.control("cont")
    state = host.hear("trsync_state")
    assert (state["can_trigger"], state["trigger_reason"]) == (0, 3)
    clock = state["clock"]
    assert isinstance(clock, int)
    assert 0 <= (clock - expires) % 2**32 < HZ // 10_000
    assert host.ask("stepper_get_position oid=0", "stepper_position")["pos"] == 450
    assert host.ask("stepper_get_position oid=3", "stepper_position")["pos"] == -700
    assert host.ask("get_config", "config")["is_shutdown"] == 0


def test_stm32f4_stops_and_resets(host: Host) -> None:
    configure(host)
    reason = host.ask("emergency_stop", "shutdown")["static_string_id"]
    assert host.dictionary.enumerations["static_string_id"]["Command request"] == reason
    assert host.ask("get_config", "config")["is_shutdown"] == 1
    assert host.ask("queue_digital_out oid=1 clock=0 on_ticks=1", "is_shutdown")
    host.send("clear_shutdown")
    state = host.ask("get_config", "config")
    assert (state["is_config"], state["is_shutdown"]) == (1, 0)
    host.send("reset")
    again = Host(host.machine)
    state = again.ask("get_config", "config")
    assert (state["is_config"], state["is_shutdown"]) == (0, 0)
