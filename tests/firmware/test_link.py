"""The firmware's end of the wire, when the wire loses, spoils, doubles and reorders bytes."""

from __future__ import annotations

import random

from hypothesis import given
from hypothesis import strategies as st
from tests.oracles import wire
from tests.support.link_bench import HZ
from tests.support.raw_board import RawBoard

from passo import _core

WINDOW = 12
PINGS = 25


def scanned(data: bytes) -> list[tuple[int, bytes]]:
    """Numbers and payloads of the board's frames: its own wire is clean here."""
    frames: list[tuple[int, bytes]] = []
    while data:
        length = data[0]
        crc = int.from_bytes(data[length - 3 : length - 1], "big")
        assert wire.crc16(data[: length - 3]) == crc
        frames.append((data[1] & 15, data[2 : length - 3]))
        data = data[length:]
    return frames


class Host:
    """Sends numbered pings over a bad wire, and sends again what is not acknowledged, until all
    are. It keeps the pongs."""

    def __init__(self, board: RawBoard, seed: int) -> None:
        self.board = board
        self.random = random.Random(seed)
        self.base = 0
        self.pongs: list[int] = []
        self.ping = board_id(board, "debug_ping")
        self.pong = board_id(board, "pong")

    def run(self) -> None:
        rounds = 0
        while self.base < PINGS:
            rounds += 1
            assert rounds < 500
            bad = rounds < 40
            burst = [self.frame(i) for i in range(self.base, min(PINGS, self.base + WINDOW))]
            self.send(self.mangled(burst) if bad else b"".join(burst))
        self.send(b"")

    def frame(self, index: int) -> bytes:
        return b"\x7e" * (index == self.base) + wire.frame(
            wire.vlq(self.ping) + b"\x01" + bytes([index]), index
        )

    def mangled(self, frames: list[bytes]) -> bytes:
        r = self.random
        if r.random() < 0.2 and len(frames) > 1:
            i = r.randrange(len(frames) - 1)
            frames[i], frames[i + 1] = frames[i + 1], frames[i]
        if r.random() < 0.2:
            frames.insert(r.randrange(len(frames) + 1), r.choice(frames))
        data = bytearray(b"".join(frames))
        for _ in range(r.choice((0, 0, 1, 1, 2, 5))):
            at = r.randrange(len(data))
            kind = r.randrange(3)
            if kind == 0:
                data[at] ^= 1 << r.randrange(8)
            elif kind == 1:
                del data[at : at + r.randrange(1, 20)]
            else:
                data[at:at] = r.randbytes(r.randrange(1, 70))
            if not data:
                break
        return bytes(data)

    def send(self, data: bytes) -> None:
        while data:
            cut = self.random.randrange(1, 80)
            self.board.device.feed(data[:cut], self.board.now)
            data = data[cut:]
        self.board.now += 1000
        for number, payload in scanned(self.board.device.poll(self.board.now)):
            self.base += (number - self.base) % 16
            if payload and payload[0] == self.pong:
                self.pongs.append(payload[2])


def restarted(board: RawBoard) -> None:
    """The board is reset; what the wire left behind is flushed before."""
    board.device.feed(b"\x7e" * 64, board.now)
    reset = wire.frame(wire.vlq(board_id(board, "reset")), board.device.frames)
    board.device.feed(reset, board.now)
    assert board.read()[-1] == ("starting", {})


def test_every_frame_is_executed_once_and_in_its_order():
    """10 000 schedules, fifty of them on each board."""
    naks = 0
    for start in range(0, 10_000, 50):
        board = RawBoard()
        for seed in range(start, start + 50):
            restarted(board)
            host = Host(board, seed)
            host.run()
            assert host.pongs == list(range(PINGS)), seed
            assert board.device.frames == PINGS
            naks += board.device.naks
    assert naks > 10_000


def board_id(board: RawBoard, name: str) -> int:
    """The number of a command or a report."""
    messages = (*board.dictionary.commands, *board.dictionary.reports)
    return next(i for i, text in messages if text.split()[0] == name)


@given(st.lists(st.binary(max_size=80), max_size=8))
def test_consecutive_bad_bytes_get_one_answer(chunks):
    board = RawBoard()
    data = b"".join(chunk.replace(b"\x7e", b"").replace(b"\x10", b"") for chunk in chunks)
    board.device.feed(data, board.now)
    answers = scanned(board.device.poll(board.now))
    assert len(answers) == board.device.naks <= 1
    board.device.feed(b"\x7e" * 64, board.now)
    board.read()
    assert board.tell("get_counters") == [
        ("counters", {"frames": 1, "naks": board.device.naks, "dropped": 0})
    ]


def test_answers_carry_the_number_after_the_frame():
    board = RawBoard()
    payload = board.commands.encode("get_clock", [])
    for sequence in range(20):
        board.device.feed(wire.frame(payload, sequence), board.now)
        answers = scanned(board.device.poll(board.now))
        assert [n for n, _ in answers] == [(sequence + 1) % 16] * 2
        assert [bool(p) for _, p in answers] == [True, False]


def test_statistics_come_every_five_seconds():
    board = RawBoard()
    for _ in range(3):
        board.now += 5 * HZ
        frames = _core.FrameScanner().feed(board.device.poll(board.now))
        [(name, values)] = [m for _, payload in frames for m in board.reports.decode(payload)]
        assert name == "stats"
        assert values["count"] > 0
        assert (values["sum"], values["sumsq"]) == (0, 0)  # work takes no virtual time


def test_frame_without_0x10_in_sequence_is_refused():
    board = RawBoard()
    ping = wire.vlq(board_id(board, "debug_ping")) + b"\x01a"
    body = bytes([len(ping) + 5, 0x20]) + ping
    board.device.feed(body + wire.crc16(body).to_bytes(2, "big") + b"\x7e", board.now)
    assert board.read() == []
    assert [name for name, _ in board.feed(ping)] == ["pong"]


def test_a_length_that_no_frame_has_is_refused_at_once():
    board = RawBoard()
    for length in (0, 4, 65, 255):
        board.device.feed(bytes([length]), board.now)
        assert scanned(board.device.poll(board.now)) == [(0, b"")], length
        board.device.feed(b"\x7e", board.now)


def test_bytes_that_do_not_end_with_the_frame_are_an_error():
    """One of them would be the first of the checksum."""
    for held, told in ((3, 4), (0, 1), (0, 0xFF)):
        board = RawBoard()
        ping = wire.vlq(board_id(board, "debug_ping"))
        said = [name for name, _ in board.feed(ping + bytes([told]) + bytes(held))]
        assert "pong" not in said
        assert board.device.fault == "Command parser error"


def test_the_uptime_counts_how_often_the_clock_has_wrapped():
    board = RawBoard()
    for seconds in (0.5, 1, 200, 200, 300):
        for _ in range(4):
            board.wait(round(seconds * HZ / 4))
        ((name, values),) = board.tell("get_uptime")
        assert (name, values["high"] << 32 | values["clock"]) == ("uptime", board.now)
