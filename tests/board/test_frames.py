"""Frames and integers against the plain oracle."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.oracles import wire

from passo import _core

payloads = st.binary(max_size=59)


def test_crc_has_the_published_check_value():
    assert _core.crc16(b"123456789") == 0x6F91


@given(st.binary(max_size=80))
def test_crc_of_random_bytes_equals_the_oracles(data):
    assert _core.crc16(data) == wire.crc16(data)


@pytest.mark.parametrize(
    ("first", "last", "size"),
    [(-32, 95, 1), (-4096, 12287, 2), (-524288, 1572863, 3), (-67108864, 201326591, 4)],
)
def test_integer_sizes_change_at_the_published_bounds(first, last, size):
    assert [len(_core.encode_vlq(v)) for v in (first, last)] == [size, size]
    assert [len(_core.encode_vlq(v)) for v in (first - 1, last + 1)] == [size + 1, size + 1]


@given(st.integers(-(2**31), 2**32 - 1))
def test_integers_are_decoded_modulo_2_to_32(value):
    data = _core.encode_vlq(value)
    assert data == wire.vlq(value)
    back, used = _core.decode_vlq(data + b"\xff")
    assert (back - value) % 2**32 == 0
    assert used == len(data)


@pytest.mark.parametrize("data", [b"", b"\x80", b"\xff\xff\xff\xff", b"\xff" * 5 + b"\x00"])
def test_an_integer_cut_short_or_too_long_is_refused(data):
    with pytest.raises(ValueError, match="variable length"):
        _core.decode_vlq(data)


@given(payloads, st.integers(0, 100))
def test_frame_is_built_as_the_oracle_builds_it(payload, sequence):
    assert _core.make_frame(payload, sequence) == wire.frame(payload, sequence)


def test_a_payload_beyond_59_bytes_is_refused():
    with pytest.raises(ValueError, match="59"):
        _core.make_frame(bytes(60), 0)


@given(st.lists(payloads, max_size=6), st.data())
def test_frames_are_found_however_the_bytes_are_cut(bodies, data):
    stream = b"\x7e".join(wire.frame(p, i) for i, p in enumerate(bodies))
    scanner = _core.FrameScanner()
    found = []
    while stream:
        n = data.draw(st.integers(1, len(stream)))
        found += scanner.feed(stream[:n])
        stream = stream[n:]
    assert found == [(i % 16, p) for i, p in enumerate(bodies)]


@given(payloads, st.integers(0, 63), st.integers(0, 7))
def test_one_flipped_bit_never_gives_a_wrong_frame(payload, place, bit):
    good = wire.frame(payload, 3)
    spoilt = bytearray(good)
    spoilt[place % len(good)] ^= 1 << bit
    # 64 sync bytes end whatever length the spoilt frame claims.
    found = _core.FrameScanner().feed(bytes(spoilt) + b"\x7e" * 64 + wire.frame(b"next", 4))
    assert found[-1] == (4, b"next")
    assert (3, payload) not in found[:-1]
    assert found.count(None) >= 1


@given(st.binary(max_size=300))
def test_noise_ends_with_the_next_good_frame(noise):
    found = _core.FrameScanner().feed(noise + b"\x7e" * 64 + wire.frame(b"hello", 9))
    assert found[-1] == (9, b"hello")


def test_consecutive_noise_counts_as_one_error():
    scanner = _core.FrameScanner()
    assert scanner.feed(b"\x03\x03\x03\x03") == [None]
    assert scanner.feed(b"\x03\x03\x7e") == []
    assert scanner.feed(b"\x41") == [None]
