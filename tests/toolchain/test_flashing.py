"""Flashing with programs that are not there, and boards that are made of a pty."""

import asyncio
import io
import json
import signal
import struct
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from hashlib import sha256
from pathlib import Path

import pytest

from passo import config
from passo.cli.main import main
from passo.clock import ScaledLoop
from passo.errors import FirmwareError
from passo.toolchain.flashing import User, flash
from passo.toolchain.formats import intel_hex as whole_hex
from passo.toolchain.formats import uf2
from passo.toolchain.images import About, write_about
from passo.toolchain.tables import compress

from .fakes import (
    AVR_CODE,
    SAM_CODE,
    TEENSY_CODE,
    Board,
    Port,
    Unplugged,
    intel_hex,
    packed,
    program,
)

UF2 = uf2(bytes(256), 0x1000_0000)


@pytest.fixture
def tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only folder with programs."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    return folder


@pytest.fixture
def image(tmp_path: Path) -> Path:
    path = tmp_path / "ramps.hex"
    path.write_text(intel_hex())
    return path


@pytest.fixture
def port() -> Iterator[Port]:
    it = Port(Board(packed()))
    yield it
    it.close()


def about(image: Path, dictionary: bytes, board: str = "RAMPS 1.4") -> None:
    hashes = (sha256(image.read_bytes()).hexdigest(), sha256(dictionary).hexdigest())
    sizes = (100, 262_144, 10, 8192)
    names = ("ramps", board, "atmega2560", image.name)
    write_about(About(*names, hashes[0], *sizes, "0.1.0-test", "gcc", hashes[1], {}), image)


def carrying(**constants: object) -> bytes:
    """The hex file of an image that carries a dictionary with these constants."""
    return whole_hex(AVR_CODE + packed(config=constants), 0)


def with_gap(count: int) -> bytes:
    """An Intel hex of a start and, so many bytes behind it, of one part more."""
    first, rest = (whole_hex(AVR_CODE, at).splitlines() for at in (0, 16 + count))
    return b"\n".join([*first[:-1], *rest])


def elf(address: int, content: bytes) -> bytes:
    """An ELF file of one segment."""
    head = b"\x7fELF\1\1\1".ljust(28, b"\0") + struct.pack("<I10x2H", 52, 32, 1).ljust(24, b"\0")
    return head + struct.pack("<8I", 1, 84, address, address, *[len(content)] * 2, 5, 4) + content


def flashed(name: str, where: str | None, image: Path, served: Port | None = None) -> list[str]:
    """What was told and asked for, at ten times the speed."""
    said: list[str] = []
    user = User(said.append, lambda text: said.append(f"HANDS: {text}"))
    with asyncio.Runner(loop_factory=lambda: ScaledLoop(10)) as runner:
        if served:
            served.serve(runner.get_loop())
        runner.run(flash(name, config.load_board(name), where, image, user))
    return said


def test_a_ramps_is_written_and_asked(tools: Path, image: Path, port: Port) -> None:
    notes = program(tools, "avrdude")
    about(image, packed())
    said = flashed("ramps", port.name, image, port)
    assert json.loads(notes.read_text()) == [
        *("-p", "atmega2560", "-c", "wiring", "-b", "115200", "-P", port.name, "-D"),
        *("-U", f"flash:w:{image}:i"),
    ]
    assert said == [
        f"avrdude -p atmega2560 -c wiring -b 115200 -P {port.name} -D -U flash:w:{image}:i",
        "ramps: written, and it answers: version 0.1.0-test, 2 commands.",
    ]


def test_a_melzi_waits_for_a_manual_step(tools: Path, image: Path, port: Port) -> None:
    program(tools, "avrdude")
    said = flashed("melzi", port.name, image, port)
    assert [text.startswith("HANDS: ") for text in said] == [False, True, False, True, False]
    assert "jumper on the pins marked Debug" in said[1]
    assert "Take the jumper off Debug again" in said[3]


def test_due_is_reset_by_1200_baud_first(tools: Path, tmp_path: Path, port: Port) -> None:
    notes = program(tools, "bossac")
    image = tmp_path / "radds.bin"
    image.write_bytes(SAM_CODE)
    said = flashed("radds", port.name, image, port)
    assert said[0].endswith(
        ": without the radds.json of its build nobody knows that it is for this board and is whole."
    )
    assert "programming port" in said[1]
    assert said[-1].startswith("radds: written, and it answers")
    assert json.loads(notes.read_text()) == [
        *("-p", port.name.removeprefix("/dev/"), "-Ufalse"),
        *("-e", "-w", "-v", "-b", str(image), "-R"),
    ]


def test_a_teensy_needs_no_port_and_is_not_asked(tools: Path, image: Path) -> None:
    notes = program(tools, "teensy_loader_cli")
    image.write_text(intel_hex(TEENSY_CODE))
    said = flashed("teensy3-mk20dx256", None, image)
    assert said[1] == "HANDS: Press the button on the Teensy."
    assert json.loads(notes.read_text()) == ["--mcu=mk20dx256", "-w", "-v", str(image)]
    assert said[-1] == (
        "teensy3-mk20dx256: written. It speaks on UART1 (receives on PTE1, sends on PTE0), so it"
        " was not asked."
    )


def test_openocd_writes_an_elf(tools: Path, tmp_path: Path) -> None:
    notes = program(tools, "openocd")
    image = tmp_path / "disco.elf"
    image.write_bytes(elf(0x0800_0000, struct.pack("<2I8x", 0x2000_1000, 0x0800_0009)))
    flashed("stm32f407-discovery", None, image)
    assert json.loads(notes.read_text())[-1] == f"program {{{image}}} verify reset exit"


def test_pico_is_flashed_as_a_drive(tools: Path, tmp_path: Path) -> None:
    drive, image = tmp_path / "RPI-RP2", tmp_path / "pico.uf2"
    drive.mkdir()
    image.write_bytes(UF2)
    expected = "expected the folder of its drive, which holds INFO"
    said: list[str] = []
    user = User(said.append, said.append)
    with pytest.raises(FirmwareError, match=expected):  # nothing was mounted there
        asyncio.run(flash("pico", config.load_board("pico"), str(drive), image, user))
    assert said[-1].startswith("copy ")
    (drive / "photo.jpg").touch()
    said.clear()
    for wrong in ("/dev/null", str(drive)):  # told before hands do anything
        work = flash(
            "pico", config.load_board("pico"), wrong, image, User(said.append, said.append)
        )
        with pytest.raises(FirmwareError, match=expected):
            asyncio.run(work)
    assert said == []
    (drive / "INFO_UF2.TXT").write_text("UF2 Bootloader v3.0\n")
    said = flashed("pico", str(drive), image)
    assert said[1].startswith("HANDS: Hold the button BOOTSEL")
    assert (drive / "pico.uf2").read_bytes() == UF2


def test_board_that_does_not_answer_is_an_error(tools: Path, image: Path) -> None:
    program(tools, "avrdude")
    port = Port(None)
    with pytest.raises(FirmwareError, match=r"does not identify itself at .*, 250000") as caught:
        flashed("ramps", port.name, image, port)
    port.close()
    assert caught.value.status == 5


def test_port_missing_during_verification_is_named(
    tools: Path, image: Path, port: Port, tmp_path: Path
) -> None:
    link = tmp_path / "port"
    link.symlink_to(port.name)
    notes = program(tools, "avrdude", then=f"pathlib.Path({str(link)!r}).unlink()")
    says = r"port: the image was written, but the port cannot be read \(No such file or directory\)"
    with pytest.raises(
        FirmwareError, match=f"ramps does not identify itself at .*/{says}"
    ) as caught:
        flashed("ramps", str(link), image, port)
    assert caught.value.status == 5
    assert notes.exists()


def test_port_lost_during_verification_is_named(
    tools: Path, image: Path, caplog: pytest.LogCaptureFixture
) -> None:
    program(tools, "avrdude")
    port = Unplugged(None)
    with pytest.raises(
        FirmwareError, match=r"the port cannot be read \(Input/output error\)"
    ) as caught:
        flashed("ramps", port.name, image, port)
    port.close()
    assert caught.value.status == 5
    assert caplog.records == []


def test_board_with_another_firmware_fails_verification(tools: Path, image: Path) -> None:
    program(tools, "avrdude")
    image.write_bytes(whole_hex(AVR_CODE + b"\x78\xda\x78" + packed(), 0))
    port = Port(Board(packed(version="0.0.9")))
    with pytest.raises(FirmwareError, match=r"another image .* version '0.0.9', not '0.1.0-test'"):
        flashed("ramps", port.name, image, port)
    port.close()


def test_failing_flash_program_is_reported(tools: Path, image: Path, port: Port) -> None:
    program(tools, "avrdude", status=1)
    with pytest.raises(FirmwareError, match="avrdude ended with status 1") as caught:
        flashed("ramps", port.name, image)
    assert caught.value.status == 5


def test_a_missing_program_is_reported_before_any_manual_step(tools: Path, image: Path) -> None:
    said: list[str] = []
    work = flash(
        "melzi", config.load_board("melzi"), "/dev/null", image, User(said.append, said.append)
    )
    with pytest.raises(FirmwareError, match="melzi needs the program avrdude, which is") as caught:
        asyncio.run(work)
    assert caught.value.status == 2
    assert said == []


@pytest.mark.parametrize(
    ("name", "content", "board", "says"),
    [
        ("a.bin", b"x", "ramps", "expected a file that ends in .hex"),
        ("a.hex", b"x", "radds", "expected a file that ends in .bin"),
        ("a.hex", b"x", "stm32f429-discovery", "expected a file that ends in .elf or .bin"),
        ("a.hex", b"x", "pico", "expected a file that ends in .uf2"),
        ("a.hex", None, "ramps", "expected a file to read"),
        ("a.hex", b"\x7fELF", "ramps", "expected the content of a .hex file"),
        ("a.hex", b":00000001FE\n", "ramps", "expected the content of a .hex file"),
        ("a.hex", b":0400000001020304F2\n", "ramps", "expected the content of a .hex file"),
        ("a.elf", b"MZ", "stm32f407-discovery", "expected the content of a .elf file"),
        ("a.uf2", bytes(512), "pico", "expected the content of a .uf2 file"),
        ("a.bin", b"", "radds", "expected the content of a .bin file"),
        ("a.hex", b":00000001FF\n", "ramps", "expected the content of a .hex file"),
        ("a.hex", intel_hex().replace("0C94", "0C95").encode(), "ramps", "content of a .hex file"),
        ("a.hex", 2 * intel_hex().encode(), "ramps", "expected the content of a .hex file"),
        ("a.elf", b"\x7fELF\1\1\1", "stm32f407-discovery", "expected the content of a .elf file"),
        ("a.uf2", UF2 + UF2[:-1], "pico", "expected the content of a .uf2 file"),
        ("a.uf2", uf2(bytes(512), 0x1000_0000)[:512], "pico", "expected the content of a .uf2"),
        ("a.elf", elf(0x0800_0000, bytes(64))[:-1], "stm32f407-discovery", "content of a .elf"),
    ],
)
def test_files_that_are_not_an_image_are_refused(
    tmp_path: Path, name: str, content: bytes | None, board: str, says: str
) -> None:
    image = tmp_path / name
    if content is not None:
        image.write_bytes(content)
    with pytest.raises(FirmwareError, match=says) as caught:
        flashed(board, "/dev/null", image)
    assert caught.value.status == 2


OWN_SAM_CODE = SAM_CODE.ljust(28, b"\0") + struct.pack("<2I", 0x8_0100, 0x6F737350)


@pytest.mark.parametrize(
    ("name", "content", "board", "says"),
    [
        (
            "a.hex",
            whole_hex(AVR_CODE.ljust(0x20001, b"\0"), 0),
            "melzi",
            "one for the flash of ATmega1284P, 0x0 to 0x1ffff: this has something at 0x20000",
        ),
        ("a.hex", with_gap(8), "ramps", "a whole one: this lacks what is at 0x10"),
        ("a.hex", with_gap(0x8000), "melzi", "a whole one: this lacks what is at 0x10"),
        ("a.bin", SAM_CODE.ljust(0x80001, b"\0"), "radds", "something at 0x100000"),
        ("a.bin", SAM_CODE.ljust(0x40001, b"\0"), "4pi", "something at 0xc0000"),
        ("a.uf2", uf2(bytes(256), 0x2000_0000), "pico", "something at 0x20000000"),
        ("a.elf", elf(0x10000, SAM_CODE), "stm32f407-discovery", "something at 0x10000"),
        (
            "a.hex",
            intel_hex(TEENSY_CODE).encode(),
            "ramps",
            "one that ATmega2560 can start: this does not begin like it",
        ),
        ("a.hex", intel_hex().encode(), "teensy3-mk20dx256", "one that MK20DX256 can start"),
        ("a.bin", SAM_CODE, "4pi", "can start"),
        ("a.bin", struct.pack("<2I8x", 0x2008_8000, 0x8_0008), "radds", "can start"),
        ("a.bin", struct.pack("<2I8x", 0x2007_0000, 0x8_0009), "radds", "can start"),
        ("a.bin", SAM_CODE[:8], "radds", "expected a whole one: .* lacks what is at 0x80008"),
        ("a.bin", OWN_SAM_CODE.ljust(255, b"\0"), "radds", "cut short and .* at 0x800ff"),
    ],
)
def test_images_that_do_not_fit_are_refused(
    tmp_path: Path, name: str, content: bytes, board: str, says: str
) -> None:
    image = tmp_path / name
    image.write_bytes(content)
    with pytest.raises(FirmwareError, match=says) as caught:
        flashed(board, "/dev/null", image)
    assert caught.value.status == 2


def test_an_image_fills_the_flash(tools: Path, tmp_path: Path, port: Port) -> None:
    program(tools, "bossac")
    image = tmp_path / "radds.bin"
    image.write_bytes(SAM_CODE.ljust(0x80000, b"\0"))
    assert flashed("radds", port.name, image, port)[-1].startswith("radds: written")


def test_bytes_that_align_what_follows_are_not_a_gap(tools: Path, image: Path, port: Port) -> None:
    program(tools, "avrdude")
    image.write_bytes(with_gap(7))
    assert flashed("ramps", port.name, image, port)[-1].startswith("ramps: written")


def test_an_image_that_states_its_end_is_complete(tools: Path, tmp_path: Path, port: Port) -> None:
    program(tools, "bossac")
    image = tmp_path / "radds.bin"
    image.write_bytes(OWN_SAM_CODE.ljust(256, b"\0"))
    said = flashed("radds", port.name, image, port)
    assert said[-1].startswith("radds: written") and said[0].endswith("that it is for this board.")


def test_image_for_another_board_with_same_chip_is_refused(
    image: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about(image, packed())
    words = ["--port", "/dev/null", "--image", str(image), "--dry-run"]
    assert main(["firmware", "flash", "mks-gen-l", *words]) == 2
    assert "expected one for MKS Gen L V2.1: this is for RAMPS 1.4" in capsys.readouterr().err
    assert main(["firmware", "flash", "ramps", *words]) == 0


RAMPS = {"MCU": "atmega2560", "CLOCK_FREQ": 16_000_000, "SERIAL_BAUD": 250_000}


@pytest.mark.parametrize(
    ("constants", "says"),
    [
        ({"MCU": "atmega1284p"}, "one for atmega2560: this is for atmega1284p"),
        ({"MCU": "\x1b[2J\x9b31m\x07"}, r"this is for \\x1b\[2J\\x9b31m\\x07\. Build one"),
        ({"CLOCK_FREQ": 20_000_000}, "one for 16000000 Hz: this is for 20000000 Hz"),
        (
            {"SERIAL_BAUD": 115_200},
            "one for 250000 baud on PE0,PE1: this is for 115200 baud on PE0,PE1",
        ),
        (
            {"RESERVE_PINS_serial": "PD2,PD3"},
            "one for 250000 baud on PE0,PE1: this is for 250000 baud on PD2,PD3",
        ),
    ],
)
def test_image_that_declares_its_board(
    image: Path, constants: dict[str, object], says: str
) -> None:
    image.write_bytes(carrying(**RAMPS | constants))
    with pytest.raises(FirmwareError, match=says) as caught:
        flashed("ramps", "/dev/null", image)
    assert caught.value.status == 2


@pytest.mark.parametrize(
    "behind",
    [
        packed(config=RAMPS)[:-1],  # cut: its sum is missing
        packed(config=RAMPS | {"MCU": 9 * 2**20 * "a"}),  # more than a dictionary unpacks to
        compress({"MCU": "atmega1284p"}),  # none of a board
        20_000 * b"\x78\xda",
    ],
)
def test_false_dictionary_in_image_is_ignored(
    tools: Path, image: Path, port: Port, behind: bytes
) -> None:
    program(tools, "avrdude")
    image.write_bytes(whole_hex(AVR_CODE + behind, 0))
    doubt, _, last = flashed("ramps", port.name, image, port)
    assert doubt.endswith("nobody knows that it is for this board.")
    assert last.startswith("ramps: written")


def test_klippers_name_of_a_chip_is_longer_and_its_clock_another(
    tools: Path, tmp_path: Path
) -> None:
    program(tools, "openocd")
    image = tmp_path / "klipper.bin"
    code = struct.pack("<2I8x", 0x2000_1000, 0x0800_0009)
    image.write_bytes(code + packed(config={"MCU": "stm32f407xx", "CLOCK_FREQ": 168_000_000}))
    doubt, *_ = flashed("stm32f407-discovery", None, image)
    assert doubt.endswith("nobody knows that it is whole.")


def test_image_that_declares_its_board_passes_all_checks(
    tools: Path, image: Path, port: Port
) -> None:
    program(tools, "avrdude")
    image.write_bytes(carrying(**RAMPS))
    assert port.board
    port.board.dictionary = packed(config=RAMPS)
    said = flashed("ramps", port.name, image, port)
    assert [line.split()[0] for line in said] == ["avrdude", "ramps:"]


def test_image_for_another_chip_or_changed_is_refused(tools: Path, image: Path) -> None:
    about(image, packed(), board="Melzi")
    with pytest.raises(FirmwareError, match=r"one for RAMPS 1.4: this is for Melzi"):
        flashed("ramps", "/dev/null", image)
    about(image, packed())
    image.write_text(intel_hex(b"other"))
    with pytest.raises(FirmwareError, match="its hash differs"):
        flashed("ramps", "/dev/null", image)


@pytest.mark.parametrize("where", ["/dev/no-such-port", ".", "/dev/null"])
def test_invalid_ports_are_refused(tools: Path, image: Path, where: str) -> None:
    program(tools, "avrdude")
    with pytest.raises(FirmwareError, match="expected a serial port") as caught:
        flashed("ramps", where, image)
    assert caught.value.status == 2


def test_a_wrong_port_is_reported_before_the_board_is_erased(tools: Path, tmp_path: Path) -> None:
    program(tools, "bossac")
    image = tmp_path / "duet-0.6.bin"
    image.write_bytes(SAM_CODE)
    said: list[str] = []
    user = User(said.append, said.append)
    work = flash("duet-0.6", config.load_board("duet-0.6"), "/dev/null", image, user)
    with pytest.raises(FirmwareError, match="through /dev/null: expected a serial port") as caught:
        asyncio.run(work)
    assert caught.value.status == 2
    assert said == []


def test_a_port_may_appear_after_a_manual_step(tools: Path, tmp_path: Path, port: Port) -> None:
    notes = program(tools, "bossac")
    image = tmp_path / "duet-0.6.bin"
    image.write_bytes(SAM_CODE)
    link = tmp_path / "port"
    user = User(lambda _: None, lambda _: link.exists() or link.symlink_to(port.name))
    with asyncio.Runner(loop_factory=lambda: ScaledLoop(10)) as runner:
        port.serve(runner.get_loop())
        board = config.load_board("duet-0.6")
        runner.run(flash("duet-0.6", board, str(link), image, user))
    assert notes.exists()


def test_missing_port_is_reported_before_flashing(tools: Path, tmp_path: Path) -> None:
    notes = program(tools, "bossac")
    image = tmp_path / "duet-0.6.bin"
    image.write_bytes(SAM_CODE)
    with pytest.raises(FirmwareError, match="expected a serial port that opens"):
        flashed("duet-0.6", str(tmp_path / "port"), image)
    assert not notes.exists()


def test_end_of_input_is_not_a_confirmation(
    tools: Path, image: Path, port: Port, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    notes = program(tools, "avrdude")
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert main(["firmware", "flash", "melzi", "--port", port.name, "--image", str(image)]) == 2
    said = capsys.readouterr().err
    assert "no user has confirmed this step: Put a jumper on" in said and ".." not in said
    assert not notes.exists()


def test_flash_prompt_can_be_cancelled(tools: Path, image: Path, port: Port) -> None:
    """The first interruption counts, and nothing is written."""
    notes = program(tools, "avrdude")
    words = ["firmware", "flash", "melzi", "--port", port.name, "--image", str(image)]
    run = f"import sys; from passo.cli.main import main; sys.argv[1:] = {words}; sys.exit(main())"
    with subprocess.Popen(
        [sys.executable, "-c", run],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.default_int_handler),
    ) as process:
        assert process.stdout is not None
        while "press Enter" not in process.stdout.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (130, "Interrupted.\n")
    assert not notes.exists()


def test_the_command_flashes_and_reads_back(
    tools: Path, image: Path, port: Port, capsys: pytest.CaptureFixture[str]
) -> None:
    program(tools, "avrdude")
    port.serve_in_thread()
    assert main(["firmware", "flash", "ramps", "--port", port.name, "--image", str(image)]) == 0
    assert capsys.readouterr().out.endswith(
        "ramps: written, and it answers: version 0.1.0-test, 2 commands.\n"
    )


def dry(capsys: pytest.CaptureFixture[str], board: str, port: str, image: Path) -> list[str]:
    """What a dry run tells, without what it tells of the image."""
    assert (
        main(["firmware", "flash", board, "--port", port, "--image", str(image), "--dry-run"]) == 0
    )
    doubt, *lines = capsys.readouterr().out.splitlines()
    assert doubt.startswith(f"{image}: without the {image.stem}.json of its build nobody knows")
    return lines


def test_a_dry_run_changes_nothing(
    tools: Path, image: Path, port: Port, capsys: pytest.CaptureFixture[str]
) -> None:
    notes = program(tools, "avrdude")
    lines = dry(capsys, "melzi", port.name, image)
    assert [line[:3] for line in lines] == ["1. ", "2. ", "3. "]
    assert lines[1].startswith(f"2. avrdude -p atmega1284p -c stk500v1 -b 57600 -P {port.name}")
    assert not notes.exists()


def test_a_dry_run_reports_what_is_missing_or_wrong_now(
    tools: Path, image: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nothing, missing, *lines = dry(capsys, "melzi", "/dev/no-such-port", image)
    assert nothing == "/dev/no-such-port: nothing is there now."
    assert missing.startswith("As things are, melzi needs the program avrdude, which is missing.")
    assert [line[:3] for line in lines] == ["1. ", "2. ", "3. "]
    program(tools, "avrdude")
    wrong, *lines = dry(capsys, "melzi", str(image), image)
    assert wrong.startswith(
        f"As things are, melzi cannot be flashed through {image}: expected a serial port."
    )
    assert [line[:3] for line in lines] == ["1. ", "2. ", "3. "]
    drive = tmp_path / "pico.uf2"
    drive.write_bytes(UF2)
    wrong, *lines = dry(capsys, "pico", "/dev/null", drive)
    assert "expected the folder of its drive" in wrong
    assert [line[:3] for line in lines] == ["1. ", "2. "]


def _none() -> None:
    return None


@pytest.mark.parametrize(
    ("board", "compiler", "suffix"),
    [
        ("melzi", "avr-gcc (Debian: gcc-avr", "hex"),
        ("duet-0.6", "arm-none-eabi-gcc (Debian: gcc-arm-none-eabi", "bin"),
        ("pico", "arm-none-eabi-gcc", "uf2"),
    ],
)
def test_a_dry_run_without_a_compiler_shows_the_steps(
    tools: Path,
    board: str,
    compiler: str,
    suffix: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for finder in ("avr_wheel.available", "arm.compiler"):
        monkeypatch.setattr(f"passo.toolchain.{finder}", _none)
    where = str(tools) if suffix == "uf2" else "/dev/no-such-port"
    assert main(["firmware", "flash", board, "--port", where, "--dry-run"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(f"As things are, {board} needs the program {compiler}")
    steps = [line for line in lines if line[0].isdigit()]
    assert steps[0] == f"1. build {board}.{suffix}"
    assert [step[:3] for step in steps] == [f"{n}. " for n in range(1, len(steps) + 1)]
    assert any(f"{board}.{suffix}" in step for step in steps[1:])


@pytest.mark.parametrize("board", ["ramps", "radds", "pico"])
def test_a_dry_run_names_the_image_that_a_build_makes(
    board: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["firmware", "build", board, "--output", str(tmp_path)]) == 0
    made = next(path for path in tmp_path.iterdir() if path.suffix != ".json")
    assert capsys.readouterr().out.startswith(f"{made}: ")
    where = str(tmp_path) if board == "pico" else "/dev/null"
    assert main(["firmware", "flash", board, "--port", where, "--dry-run"]) == 0
    assert f"1. build {made.name}\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["flash", "rumps", "--image", "x.hex"], "there is no board called 'rumps'"),
        (
            ["flash", "ramps", "--image", "x.hex"],
            "no port was named for ramps",
        ),
        (
            ["flash", "ramps", "--port", "", "--image", "x.hex"],
            "no port was named for ramps: it needs a serial port",
        ),
        (["flash", "pico", "--port", ""], "for pico: it needs the folder of its drive"),
        (["flash", "ramps", "--port", "/dev/null", "--image", "x.bin"], "ends in .hex"),
        (["flash", "klipper", "--port", "/dev/null", "--image", "x.hex"], "no firmware of Passo"),
        (["build", "rumps"], "there is no board called 'rumps'"),
        (["build", "klipper"], "it runs Klipper's own firmware"),
    ],
)
def test_flash_usage_errors_exit_with_2(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["firmware", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert says in err
    assert err.count("\n") == 1
