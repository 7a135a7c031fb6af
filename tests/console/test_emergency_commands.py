"""Commands that act ahead of every queue, behind thousands of lines of their own console."""

import asyncio
import os
import socket
import time
import tracemalloc
from collections.abc import Callable

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.clock import VirtualLoop
from passo.console.receive_queue import MAX_BYTES, MAX_LINES
from passo.console.session import AT_ONCE, Session
from passo.console.transports.serial import open_pty
from passo.console.transports.streams import open_tcp
from passo.library.assembly import assembled
from passo.motion.motion_queue import MAX_QUEUED

MANY = 20_000  # lines, of 0.3 MB


def numbered(lines, first=1):
    """The lines with numbers and checksums."""
    for number, line in enumerate(lines, first):
        text = f"N{number} {line}"
        check = 0
        for byte in text.encode():
            check ^= byte
        yield f"{text}*{check}"


def piped(command, *, numbers):
    """A file sent without waiting for `ok`, and the command at its end."""
    lines = ["M109 S200", *(f"G1 X{20 + i % 100} F6000" for i in range(MANY)), command]
    return list(numbered(lines)) if numbers else lines


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X20 Y20 Z20")
        yield scenario


def oks(host, start=0):
    return sum(x.startswith("ok") for x in host.heard[start:])


# -- a console of lines ---------------------------------------------------------------------------


@pytest.mark.parametrize("numbers", [False, True])
def test_m112_acts_after_many_lines_of_its_console(s, numbers):
    start = len(s.host.heard)
    s.host.send(*piped("M112", numbers=numbers))
    assert s.printer.state.halted == "emergency stop by M112"
    s.passes(1)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert oks(s.host, start) == MANY + 2
    assert s.positions()["x"] == 20.0
    number = MANY + 3 if numbers else 1
    s.host.send("M999")
    s.host.expect("ready again", 3)
    if not numbers:
        s.host.ok(next(numbered(["M110"], 0)))
    s.host.send(next(numbered(["G92 X7"], number))[:-1] + "x")
    s.host.expect(f"^Resend: {number}$")
    s.host.expect("^ok")
    for i, line in enumerate(("G92 X7", "M114")):
        s.host.send(next(numbered([line], number + i)))
    s.host.expect("^X:7.000 ")


def test_m112_acts_before_earlier_numbered_lines(s):
    """The line before it was lost, and a host that pipes does not hear that it is asked for it."""
    lines = list(numbered(["M110", *["G1 X80 F600"] * 3, "M112"], 0))
    s.host.send(*lines[:2], *lines[3:])
    assert s.printer.state.halted == "emergency stop by M112"
    s.host.expect("^Resend: 2$")
    assert s.host.heard.count("Resend: 2") == 2


def test_early_m112_in_an_uploaded_file_is_text(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        lines = list(numbered(["M110", "M28 a.g", "G1 X1", "M112", "M29"], 0))
        s.host.send(*lines[:2], lines[3])
        s.host.expect("^Resend: 2$")
        s.host.send(*lines[2:])
        s.host.expect("Done saving file")
        assert s.printer.state.halted == ""
    assert (tmp_path / "a.g").read_text() == "G1 X1\nM112\n"


def test_m410_discards_all_moves_in_progress(s):
    start = len(s.host.heard)
    s.host.ok("G1 X80 F600")
    s.host.send(*(["G1 X20"] * MANY), "M104 S50")
    s.passes(1)
    s.host.send("M410")
    s.until(lambda: s.printer.rig.queue.standing, 1)
    at = s.positions()["x"]
    assert 29 < at < 31
    s.passes(2)
    assert s.positions()["x"] == at
    assert oks(s.host, start) == MANY + 3
    assert s.printer.rig.connection.heaters["hotend"].target == 50
    refused = [x for x in s.host.heard if "it was in hand when the machine was stopped" in x]
    assert len(refused) >= MANY - MAX_QUEUED


def test_m108_ends_the_wait_in_front_of_many_lines(s):
    start = len(s.host.heard)
    s.host.send("M109 S200", *["M110"] * MANY)
    s.passes(1)
    s.host.send("M108")
    s.passes(0.1)
    assert oks(s.host, start) == MANY + 2
    assert s.printer.rig.connection.heaters["hotend"].target == 200


def test_consoles_share_time_while_many_lines_run(s):
    other = Host(s)

    async def both():
        s.host.session.receive(b"M118 mine\n" * MANY)
        other.session.receive(b"M118 theirs\n")

    s.run(both())
    s.passes(1)
    assert oks(s.host) == MANY + 1
    assert other.heard.index("theirs") == AT_ONCE


@pytest.mark.parametrize(
    ("line", "most"), [("M110", MAX_LINES), ("M117 " + "x" * 1019, MAX_BYTES // 1024)]
)
def test_receive_queue_is_bounded(s, line, most):
    """A sender is held up, and let go on when half of it is done."""
    s.host.ok("M110")
    data = f"{line}\n".encode() * 64
    start, sent = len(s.host.heard), 0
    s.host.send("M0")
    s.passes(0.1)
    tracemalloc.start()
    while not s.host.held:
        s.host.send_bytes(data)
        sent += 64
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most <= sent < most + 64
    assert used < 24e6
    s.host.send_bytes(b"M108\n")  # of what had been read already
    s.until(lambda: not s.host.held, 1)
    s.passes(1)
    assert oks(s.host, start) == sent + 2


# -- a real way in --------------------------------------------------------------------------------


class Pipe:
    """A host that writes as fast as it may, and does not read."""

    def __init__(self, fd):
        self.fd = fd
        os.set_blocking(fd, False)

    async def write(self, data):
        """Until all is written, or nothing can be for long."""
        data, refused = memoryview(data), 0
        while data and refused < 5000:
            try:
                data, refused = data[os.write(self.fd, data) :], 0
            except BlockingIOError:
                refused += 1
                if refused > 50:
                    time.sleep(1e-3)  # the kernel's time is real
            await asyncio.sleep(0)
        return len(data)


async def soon(true: Callable[[], bool]) -> None:
    """Lets the kernel carry bytes, whose time is real, until that is so: two virtual seconds."""
    for i in range(20_000):
        if true():
            return
        if i > 1000:
            time.sleep(1e-3)
        await asyncio.sleep(1e-4)
    raise AssertionError("it did not come true")


@pytest.mark.parametrize("way", ["pty", "tcp"])
@pytest.mark.parametrize("numbers", [False, True])
def test_m112_comes_through_a_pipe_that_is_full_of_lines(way, numbers, tmp_path):
    data = "".join(f"{x}\n" for x in piped("M112", numbers=numbers)).encode()
    sessions = []

    async def body():
        printer = assembled(config.load("i3")).printer
        runs = asyncio.get_running_loop().create_task(printer.run())

        def session(wire):
            sessions.append(Session(printer.control, wire))
            return sessions[-1]

        if way == "pty":
            console = await open_pty(session, str(tmp_path / "port"))
            fd = os.open(tmp_path / "port", os.O_RDWR | os.O_NOCTTY)
        else:
            console = await open_tcp(session, "127.0.0.1", 0, 1)
            port = int(console.place.rpartition(":")[2])
            fd = socket.create_connection(("127.0.0.1", port)).detach()
        before = data[: data[:-1].rindex(b"\n") + 1]
        assert await Pipe(fd).write(before) == 0
        await soon(lambda: printer.rig.connection.heaters["hotend"].target == 200)
        held = not printer.state.halted
        assert await Pipe(fd).write(data[len(before) :]) == 0
        await soon(lambda: bool(printer.state.halted))
        halted = printer.state.halted
        os.close(fd)
        console.close()
        await asyncio.sleep(1)
        runs.cancel()
        await asyncio.gather(runs, return_exceptions=True)
        return held, halted, printer.rig.connection.heaters["hotend"].target

    loop = VirtualLoop()
    held, halted, target = loop.run_until_complete(body())
    loop.close()
    assert held
    assert halted == "emergency stop by M112"
    assert target == 0
    assert len(sessions) == 1
