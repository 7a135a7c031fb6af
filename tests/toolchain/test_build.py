"""Images of all boards that have one, and what `passo firmware` says of the others."""

import hashlib
import json
import re
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.support.klipper_board import DICTIONARY

from passo import config
from passo.cli.main import main
from passo.config.chips import chip, chip_names
from passo.errors import FirmwareError
from passo.toolchain import arm, avr
from passo.toolchain.arm import ArmBoard, board_header, pin_number
from passo.toolchain.build import build, firmware_folder
from passo.toolchain.declarations import gather
from passo.toolchain.images import about_path, check_image, read_about
from passo.toolchain.sources import TOO_FAST_FOR_AVR, core_sources
from passo.toolchain.tables import compress
from passo.toolchain.targets import Motor, board_target, state, target

# board: most bytes of flash, and of static data in RAM
LIMITS = {
    "ramps": (37_000, 7_200),
    "mks-gen": (37_000, 7_200),
    "mks-gen-l": (37_000, 7_200),
    "melzi": (37_000, 14_000),
    "radds": (24_000, 56_000),
    "ramps-fd": (24_000, 56_000),
    "duet-0.6": (24_000, 56_000),
    "4pi": (24_000, 28_600),
    "teensy3-mk20dx128": (24_000, 12_200),
    "teensy3-mk20dx256": (24_000, 40_000),
    "stm32f407-discovery": (24_000, 56_000),
    "stm32f429-discovery": (24_000, 56_000),
    "pico": (24_000, 76_000),
}
SUFFIXES = {"avrdude": ".hex", "teensy_loader_cli": ".hex", "uf2": ".uf2"}
STATES = {
    "ramps": "ready",
    "mks-gen": "ready",
    "mks-gen-l": "ready",
    "melzi": "ready",
    "radds": "ready",
    "ramps-fd": "ready",
    "duet-0.6": "incomplete: usb",
    "4pi": "incomplete: usb",
    "teensy3-mk20dx128": "incomplete: usb",
    "teensy3-mk20dx256": "incomplete: usb",
    "stm32f407-discovery": "incomplete: usb",
    "stm32f429-discovery": "incomplete: usb",
    "pico": "incomplete: usb",
    **{
        name: "runs Klipper's"
        for name in config.shipped_boards()
        if not config.load_board(name).chip
    },
}


def test_the_limits_are_those_of_all_boards_with_firmware() -> None:
    assert {name for name, it in STATES.items() if it in ("ready", "incomplete: usb")} == {*LIMITS}


def _told_by_the_documentation() -> dict[str, tuple[int, int]]:
    """Flash and RAM of each board in the table of docs/reference/firmware.md."""
    text = (Path(__file__).parents[2] / "docs" / "reference" / "firmware.md").read_text(
        encoding="utf-8"
    )
    rows = re.findall(r"^\| ([\w., -]+) \| \w+ \| (\d+) of \d+ \| (\d+) of", text, re.MULTILINE)
    return {name: (int(f), int(r)) for names, f, r in rows for name in names.split(", ")}


@pytest.mark.parametrize("name", LIMITS)
def test_every_board_builds_within_its_limits(name: str, tmp_path: Path) -> None:
    image, about = build(board_target(name), tmp_path)
    flash, ram = LIMITS[name]
    assert 10_000 < about.flash_bytes <= flash
    assert 2_000 < about.ram_bytes <= ram
    assert about.flash_size == chip(about.mcu).flash_bytes
    assert about.ram_size == chip(about.mcu).ram_bytes
    flash_method = config.load_board(name).flash
    assert flash_method
    suffix = SUFFIXES.get(flash_method.method, ".bin")
    assert image == tmp_path / f"{name}{suffix}"
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}{suffix}", f"{name}.json"}
    assert about.sha256 == hashlib.sha256(image.read_bytes()).hexdigest()
    assert read_about(image) == about
    about_path(image).unlink()
    checked = check_image(image, name, config.load_board(name), (suffix,))
    assert checked.unknown == ()  # it says itself what it is, and where it ends
    assert checked.carried is not None
    assert hashlib.sha256(checked.carried.compressed).hexdigest() == about.dictionary_sha256
    assert checked.carried.dictionary.version == about.version
    told = _told_by_the_documentation()[name]
    assert (about.flash_bytes, about.ram_bytes) == pytest.approx(told, rel=0.02)
    board = config.load_board(name)
    assert about.dictionary["config"]["CLOCK_FREQ"] == board.clock_hz
    assert board.console
    assert about.dictionary["config"]["SERIAL_BAUD"] == board.console.baud
    assert about.dictionary["config"]["MCU"] == board.mcu
    assert any(text.startswith("queue_step ") for text in about.dictionary["commands"])


def test_the_default_words_are_klippers() -> None:
    """Every command of the firmware is in a dictionary of Klipper's, except those of which newer
    Klipper has another form, and Passo's own. The types of integers are all the same in a frame."""

    def plain(text: str) -> str:
        return re.sub("%(hu|hi|u|i|c)", "%", text)

    klippers = {plain(text) for text in DICTIONARY["commands"]}
    core = gather(core_sources(firmware_folder())).commands
    differ = {c.format.split()[0] for c in core if plain(c.format) not in klippers}
    own = {"get_counters", *(name for name in differ if name.startswith("survive_"))}
    left_out = {name for name in differ if re.search("_(adxl345|lis2dw)", name)}  # of that build
    assert differ - own - left_out == {"query_analog_in", "i2c_transfer"}


@pytest.mark.parametrize("name", ["ramps", "radds"])
def test_an_image_for_older_hosts(name: str, tmp_path: Path) -> None:
    words = ["firmware", "build", name, "--for-older-hosts", "--output", str(tmp_path)]
    assert main(words) == 0
    about = json.loads((tmp_path / f"{name}.json").read_text())
    avr = TOO_FAST_FOR_AVR if name == "ramps" else ()
    newer = {c.format for c in gather(core_sources(firmware_folder(), without=avr)).commands}
    older = {text for text in about["dictionary"]["commands"] if text not in newer}
    assert older == {
        "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u"
        " min_value=%hu max_value=%hu range_check_count=%c",
        "i2c_write oid=%c data=%*s",
        "i2c_read oid=%c reg=%*s read_len=%u",
    }
    assert len(about["dictionary"]["commands"]) == len(newer) + 1
    assert "analog_in_state oid=%c next_clock=%u value=%hu" in about["dictionary"]["responses"]
    assert 10_000 < about["flash_bytes"] <= LIMITS[name][0]


def test_a_cortex_m_board_file_sets_the_pins_of_its_layer() -> None:
    it = chip("mk20dx128")
    board = ArmBoard(it, 48_000_000, "UART1", 250_000, ("PTE1", "PTE0"))
    lines = board_header(board).splitlines()
    assert lines[2:7] == [
        "#define BOARD_CLOCK_HZ 48000000UL",
        "#define BOARD_UART_UART1 1",
        "#define BOARD_BAUD 250000UL",
        "#define BOARD_RECEIVE 129",
        "#define BOARD_SEND 128",
    ]
    assert lines[7] == (
        "#define CHIP_PINS 0x000c303f, 0x000f000f, 0x00000fff, 0x000000ff, 0x00000000"
    )
    assert lines[8].startswith("#define CHIP_ANALOG(X) X(66, 4) X(97, 5) ")
    assert lines[9].startswith("#define CHIP_PULSES(X) X(65, FTM0, 0) ")
    with pytest.raises(avr.FirmwareError, match="PTF0 is not a pin of MK20DX128"):
        pin_number(it, "PTF0")


def test_a_timer_that_the_firmware_uses_makes_no_pulses() -> None:
    text = board_header(ArmBoard(chip("stm32f407"), 84_000_000, "USART3", 9600, ("PD9", "PD8")))
    assert "X(0, TIM5, 1)" in text
    assert "TIM2" not in text


def _bytes_of(image: Path) -> bytes:
    """The content of an Intel hex file, its records joined."""
    rows = (bytes.fromhex(line[1:]) for line in image.read_text().split())
    return b"".join(row[4:-1] for row in rows if row[3] == 0)


def test_the_image_carries_the_dictionary_of_its_file(tmp_path: Path) -> None:
    image, about = build(board_target("ramps"), tmp_path)
    carried = compress(about.dictionary)
    assert carried in _bytes_of(image)
    assert about.dictionary_sha256 == hashlib.sha256(carried).hexdigest()
    assert json.loads(zlib.decompress(carried))["version"] == about.version


def test_the_same_target_makes_the_same_image(tmp_path: Path) -> None:
    first, about = build(board_target("melzi"), tmp_path / "a")
    second, _ = build(board_target("melzi"), tmp_path / "b")
    assert first.read_bytes() == second.read_bytes()
    assert about.version.startswith("0.1.0-")


def test_a_machine_has_an_image_with_its_own_step_pins(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(config.shipped_text("i3").replace('"E0"', '"E0"\nstep_pin = "D40"'))
    aim = target(str(path))
    assert aim.motors == (
        Motor("x", "PF0", "PF1", "TIMER3A", 1.0),
        Motor("y", "PF6", "PF7", "TIMER3B", 1.0),
        Motor("z", "PL3", "PL1", "TIMER3C", 1.0),
        Motor("e", "PG1", "PA6", "TIMER4A", 1.0),
    )
    image, about = build(aim, tmp_path)
    assert image.name == "i3.hex"
    ramps, other = build(board_target("ramps"), tmp_path)
    assert about.version != other.version
    assert image.read_bytes() != ramps.read_bytes()


def test_motors_with_long_pulses_get_units_that_can_make_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = config.shipped_text("i3").replace('"E0"', '"E0"\ndriver = "TB6600"')
    path = tmp_path / "mine.toml"
    path.write_text(text.replace('socket = "X"', 'socket = "X"\npulse_us = 2.1'))
    aim = target(str(path))
    assert [motor.pulse_us for motor in aim.motors] == [2.1, 1.0, 1.0, 3.0]
    made: list[avr.AvrBoard] = []
    whole = avr.build

    def kept(board: avr.AvrBoard, *rest: Any) -> Any:
        made.append(board)
        return whole(board, *rest)

    monkeypatch.setattr(avr, "build", kept)
    build(aim, tmp_path)
    assert [(len(board.motors), board.slow_motors) for board in made] == [(3, 1)]


def test_machine_with_klipper_firmware_has_no_image(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(config.shipped_text("i3") + 'firmware = "klipper"\n')
    with pytest.raises(FirmwareError, match="no firmware of Passo for i3: it runs Klipper's own"):
        target(str(path))


def test_step_units_are_assigned_to_motors() -> None:
    assert [m.name for m in board_target("melzi").motors] == ["X", "Y", "Z", "E"]
    assert board_target("duet-0.6").motors[0] == Motor("X", "PD4", "PD5")


def test_boards_and_builds_have_the_same_chips() -> None:
    assert {*avr.CHIPS, *arm.CHIPS} == {*chip_names()}
    for name, known in avr.CHIPS.items():
        it = chip(name)
        assert (known.flash, known.ram, set(known.units)) == (
            it.flash_bytes,
            it.ram_bytes,
            set(it.compare_units),
        )
        assert {f"P{port}" for port in known.ports} == {pin[:2] for pin in it.pins}


def test_a_clock_that_the_chip_has_not_is_refused(tmp_path: Path) -> None:
    aim = board_target("pico")
    board = aim.board.model_copy(update={"clock_hz": 1_000_000})
    says = "pico has a clock of 1 MHz, but the firmware for its chip runs at 12 MHz"
    with pytest.raises(FirmwareError, match=says):
        build(replace(aim, board=board), tmp_path)


def test_unwritable_output_is_named(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("")
    with pytest.raises(FirmwareError, match="cannot be written"):
        build(board_target("ramps"), path)


def test_old_image_stays_if_json_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "ramps.json").mkdir()
    (tmp_path / "ramps.hex").write_text("old")
    with pytest.raises(FirmwareError, match="cannot be written"):
        build(board_target("ramps"), tmp_path)
    assert (tmp_path / "ramps.hex").read_text() == "old"
    assert len([*tmp_path.iterdir()]) == 2


def test_firmware_list_shows_all_boards(capsys: pytest.CaptureFixture[str]) -> None:
    assert {name: state(config.load_board(name)) for name in config.shipped_boards()} == STATES
    assert main(["firmware", "list"]) == 0
    head, *rows = capsys.readouterr().out.splitlines()
    assert head.split("  ")[0] == "BOARD"
    assert {row.split()[0] for row in rows} == set(STATES)
    assert all(row.endswith(STATES[row.split()[0]]) for row in rows)
    assert main(["firmware", "list", "--json"]) == 0
    by_name = {row["board"]: row for row in json.loads(capsys.readouterr().out)}
    assert by_name["radds"]["console"] == "UART 115200 baud"
    assert by_name["radds"]["flash"] == "bossac"
    assert by_name["klipper"]["clock_hz"] is None
    assert by_name["ramps-fd"]["notes"][0].startswith("RAMPS-FD 1 switches its outputs on with low")


def test_firmware_command_builds_an_image(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["firmware", "build", "melzi", "--output", str(tmp_path)]) == 0
    assert f"{tmp_path}/melzi.hex: " in capsys.readouterr().out
    assert (tmp_path / "melzi.json").is_file()
