"""The wire in plain Python, bit by bit and step by step."""

from __future__ import annotations


def crc16(data: bytes) -> int:
    """CRC-16/MCRF4XX: reflected polynomial 0x8408, initial value 0xffff."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return crc


def vlq(value: int) -> bytes:
    """Groups of 7 bits, most significant first: as many as keep -32·128^k ≤ value < 96·128^k."""
    value = (value + 2**31) % 2**32 - 2**31
    groups = 1
    while groups < 5 and not -32 * 128 ** (groups - 1) <= value < 96 * 128 ** (groups - 1):
        groups += 1
    parts = [value >> 7 * i & 0x7F for i in reversed(range(groups))]
    return bytes([*(p | 0x80 for p in parts[:-1]), parts[-1]])


def frame(payload: bytes, sequence: int) -> bytes:
    body = bytes([len(payload) + 5, 0x10 | sequence % 16]) + payload
    return body + crc16(body).to_bytes(2, "big") + b"\x7e"


def step_clocks(last: int, interval: int, count: int, add: int) -> list[int]:
    """Clocks of the steps of one queue_step that follows a step at `last`."""
    clocks: list[int] = []
    for _ in range(count):
        last += interval
        interval += add
        clocks.append(last)
    return clocks
