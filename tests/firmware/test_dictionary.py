"""What the build gathers from the sources, and what the firmware tells of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.support.raw_board import RawBoard

from passo import _core
from passo.toolchain.declarations import DeclarationError, gather
from passo.toolchain.tables import dictionary, write_tables

FIRMWARE = Path(__file__).parents[2] / "firmware"
EDDY = re.compile("ldc1612|trigger_analog|sos_filter")
CORE = sorted(FIRMWARE.glob("core/*.c"))


def test_every_reason_for_a_shutdown_is_in_the_dictionary():
    used = {
        name
        for source in CORE
        for name in re.findall(r"\bSHUTDOWN_([A-Z0-9_]+)", source.read_text(encoding="utf-8"))
    }
    found = gather(CORE)
    assert set(found.shutdowns) == used
    assert len(set(found.shutdowns.values())) == len(used)
    board = RawBoard()
    assert set(board.dictionary.enumerations["static_string_id"]) == set(found.shutdowns.values())


def test_firmware_declares_all_commands_of_the_model():
    """But those of eddy current probes, which need Klipper's firmware."""
    board = RawBoard()

    def with_wide_pins(text: str) -> str:
        return text.replace("pin=%c", "pin=%u")

    known = {text for _, text in board.dictionary.commands}
    commands = {with_wide_pins(text) for _, text in _core.board_commands()}
    assert {text for text in commands - known if not EDDY.search(text)} == set()
    reports = {text for _, text in board.dictionary.reports}
    missing = {text for _, text in _core.board_reports()} - reports
    assert {text for text in missing if not EDDY.search(text)} == set()


def test_frequent_messages_have_one_byte_ids():
    assert all(0 <= number < 96 for number, _ in RawBoard().dictionary.commands)


def test_the_core_names_no_chip():
    for source in (*CORE, *FIRMWARE.glob("core/*.h"), FIRMWARE / "hal/hal.h"):
        text = source.read_text(encoding="utf-8").lower()
        assert not re.search(r"avr|atmega|stm32|sam3|rp2040|mk20|cortex", text), source


def declared(tmp_path, text):
    source = tmp_path / "part.c"
    source.write_text(text, encoding="utf-8")
    return gather([source])


def test_declarations_are_read_over_lines(tmp_path):
    found = declared(
        tmp_path,
        'DECL_COMMAND(run_it,\n             "go oid=%c"\n             " far=%u, please=%*s",\n'
        '             IN_SHUTDOWN);\nDECL_SHUTDOWN_REASON(BAD, "Not \\"so\\"");\n'
        'DECL_CONSTANT("SIZE", 0x10);\nDECL_CONSTANT("NAME", "me");\n'
        'DECL_ENUMERATION("bus", "one", 1);\nDECL_ENUMERATION_RANGE("pin", "PA0", 8, 4);\n',
    )
    [command] = found.commands
    assert found.shutdowns == {"BAD": 'Not "so"'}
    assert (command.handler, command.flags) == ("run_it", "IN_SHUTDOWN")
    assert command.format == "go oid=%c far=%u, please=%*s"
    assert found.constants == {"SIZE": 16, "NAME": "me"}
    assert found.enumerations == {"bus": {"one": 1}, "pin": {"PA0": (8, 4)}}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('DECL_COMMAND(a, "x", 0);\nDECL_COMMAND(b, "x a=%c", 0);', "declared twice"),
        ('DECL_REPORT("x");\nDECL_REPORT("x");', "declared twice"),
        ('DECL_SHUTDOWN_REASON(A, "x");\nDECL_SHUTDOWN_REASON(A, "y");', "declared twice"),
        ('DECL_CONSTANT("A", 1);\nDECL_CONSTANT("A", 2);', "another value"),
        ('DECL_ENUMERATION("A", "b", c);', "wrong type"),
        ('DECL_COMAND(a, "x", 0);', "unknown"),
        ('DECL_REPORT("x", 1);', "as many arguments"),
    ],
)
def test_invalid_declarations_are_named(tmp_path, text, complaint):
    with pytest.raises(DeclarationError, match=f"part.c: DECL_.*{complaint}"):
        declared(tmp_path, text)


@pytest.mark.parametrize("text", ["x a=%q", "x %c", "x a=%*s b=%*s"])
def test_invalid_formats_are_named(tmp_path, text):
    found = declared(tmp_path, f'DECL_REPORT("identify_response");\nDECL_COMMAND(a, "{text}", 0);')
    with pytest.raises(DeclarationError, match="'x "):
        write_tables(found, dictionary(found, version="1"), tmp_path)
