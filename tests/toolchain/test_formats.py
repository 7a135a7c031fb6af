"""Files for flashing programs."""

import struct

from passo.toolchain.formats import intel_hex, uf2, with_boot_sum


def test_intel_hex_is_read_and_written() -> None:
    assert intel_hex(bytes(range(18)), 0x1FFF0).decode().split() == [
        ":020000040001F9",
        ":10FFF000000102030405060708090A0B0C0D0E0F89",
        ":020000040002F8",
        ":020000001011DD",
        ":00000001FF",
    ]


def test_uf2_is_read_and_written() -> None:
    data = uf2(b"\xaa" * 300, 0x10000000)
    assert len(data) == 1024
    for i, content in enumerate((b"\xaa" * 256, b"\xaa" * 44 + bytes(212))):
        block = data[512 * i : 512 * i + 512]
        head = struct.unpack("<8I", block[:32])
        assert head == (
            *(0x0A324655, 0x9E5D5157, 0x2000, 0x10000000 + 256 * i, 256, i, 2),
            0xE48BFF56,
        )
        assert block[32:288] == content
        assert block[288:508] == bytes(220)
        assert block[508:] == bytes.fromhex("306fb10a")


def test_second_stage_has_its_checksum() -> None:
    data = with_boot_sum(bytes(252) + b"\0\0\0\0" + b"image")
    crc = 0xFFFFFFFF
    for _ in range(252 * 8):
        crc = (crc << 1 ^ 0x04C11DB7 * (crc >> 31)) & 0xFFFFFFFF
    assert data[:252] == bytes(252)
    assert struct.unpack("<I", data[252:256]) == (crc,)
    assert data[256:] == b"image"
