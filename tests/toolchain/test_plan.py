"""What is done to flash each board, to the letter."""

from pathlib import Path

import pytest

from passo import config
from passo.errors import ExitStatus, FirmwareError
from passo.toolchain.flash_plan import SUFFIXES, Copy, Hands, Run, Touch, plan

IMAGE = Path("out/board.img")
OPENOCD = "openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -c"
COMMANDS = {
    "ramps": "avrdude -p atmega2560 -c wiring -b 115200 -P /dev/ttyACM0 -D -U flash:w:{}:i",
    "mks-gen": "avrdude -p atmega2560 -c wiring -b 115200 -P /dev/ttyACM0 -D -U flash:w:{}:i",
    "mks-gen-l": "avrdude -p atmega2560 -c wiring -b 115200 -P /dev/ttyACM0 -D -U flash:w:{}:i",
    "melzi": "avrdude -p atmega1284p -c stk500v1 -b 57600 -P /dev/ttyACM0 -D -U flash:w:{}:i",
    "radds": "bossac -p ttyACM0 -Ufalse -e -w -v -b {} -R",
    "ramps-fd": "bossac -p ttyACM0 -Ufalse -e -w -v -b {} -R",
    "duet-0.6": "bossac -p ttyACM0 -e -w -v -b {}",
    "4pi": "bossac -p ttyACM0 -e -w -v -b {}",
    "teensy3-mk20dx128": "teensy_loader_cli --mcu=mk20dx128 -w -v {}",
    "teensy3-mk20dx256": "teensy_loader_cli --mcu=mk20dx256 -w -v {}",
    "stm32f407-discovery": OPENOCD + " 'program {{{}}} 0x08000000 verify reset exit'",
    "stm32f429-discovery": OPENOCD + " 'program {{{}}} 0x08000000 verify reset exit'",
}
# What hands do before and after.
HANDS = {
    "melzi": (1, 1),
    "radds": (1, 0),
    "ramps-fd": (1, 0),
    "duet-0.6": (2, 1),
    "4pi": (2, 1),
    "teensy3-mk20dx128": (1, 0),
    "teensy3-mk20dx256": (1, 0),
    "stm32f407-discovery": (1, 0),
    "stm32f429-discovery": (1, 0),
    "pico": (1, 0),
}


@pytest.mark.parametrize("name", [*COMMANDS, "pico"])
def test_flash_plan_has_its_steps(name: str) -> None:
    board = config.load_board(name)
    steps = plan(name, board, "/dev/ttyACM0", IMAGE)
    before, after = HANDS.get(name, (0, 0))
    assert [isinstance(step, Hands) for step in steps].count(True) == before + after
    assert all(isinstance(step, Hands) for step in steps[:before])
    assert all(isinstance(step, Hands) for step in steps[len(steps) - after :])
    *touch, work = steps[before : len(steps) - after]
    assert touch == ([Touch("/dev/ttyACM0")] if name in ("radds", "ramps-fd") else [])
    if name == "pico":
        assert work == Copy(IMAGE, Path("/dev/ttyACM0"))
    else:
        assert isinstance(work, Run)
        assert str(work) == COMMANDS[name].format(IMAGE)


def test_openocd_takes_the_address_of_an_elf_from_the_file() -> None:
    (_, work) = plan("disco", config.load_board("stm32f407-discovery"), None, Path("a b.elf"))
    assert isinstance(work, Run)
    assert work.words[-1] == "program {a b.elf} verify reset exit"


@pytest.mark.parametrize(
    ("name", "expected"), [("ramps", "a serial port"), ("pico", "the folder of its drive")]
)
def test_missing_port_is_named_in_the_plan(name: str, expected: str) -> None:
    with pytest.raises(FirmwareError, match=f"no port was named .*: it needs {expected}") as caught:
        plan(name, config.load_board(name), None, IMAGE)
    assert caught.value.status == ExitStatus.USAGE == 2


def test_board_with_other_firmware_is_not_flashed() -> None:
    with pytest.raises(FirmwareError, match="it runs Klipper's own firmware") as caught:
        plan("klipper", config.load_board("klipper"), "/dev/ttyACM0", IMAGE)
    assert caught.value.status == 2


def test_every_method_knows_its_files() -> None:
    boards = (config.load_board(name) for name in config.shipped_boards())
    assert {board.flash.method for board in boards if board.flash} == set(SUFFIXES)
