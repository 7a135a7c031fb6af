"""Consoles on real pseudo terminals and sockets: hosts that come, go, stay away or do not read.

The loop's time is real here. Nothing waits for time, only for what the printer says; the time limit
is for a printer that says nothing.
"""

import asyncio
import contextlib
import fcntl
import os
import re
import struct
import subprocess
import sys
import termios
from pathlib import Path

import pytest

from passo import config
from passo.cli.main import main
from passo.console.session import Session
from passo.console.transports import serial as lines
from passo.console.transports import streams as wires
from passo.console.transports.serial import open_pty, open_serial
from passo.console.transports.streams import ConsoleError, open_tcp
from passo.library.assembly import assembled

TIMEOUT_S = 60


class Client:
    """A host on a stream."""

    def __init__(self, reader, write, close):
        self.reader, self.write, self.close = reader, write, close

    async def line(self):
        return (await self.reader.readline()).decode("ascii").rstrip("\n")

    async def until(self, pattern):
        heard = []
        while not heard or not re.search(pattern, heard[-1]):
            assert not self.reader.at_eof(), heard
            heard.append(await self.line())
        return heard

    async def ok(self, text):
        self.write(f"{text}\n".encode())
        return await self.until("^ok")


async def at_pty(path):
    fd = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    reader = asyncio.StreamReader()
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(fd, "rb", 0)
    )
    return Client(reader, lambda data: os.write(fd, data), transport.close)


def tcp_address(console):
    host, port = console.place.removeprefix("tcp ").rsplit(":", 1)
    return host, int(port)


async def at_tcp(console):
    reader, writer = await asyncio.open_connection(*tcp_address(console))
    return Client(reader, writer.write, writer.close)


class Served:
    """A printer with its consoles."""

    def __init__(self, card=None):
        self.printer = assembled(config.load("i3"), card=card).printer
        self.consoles = []
        self._run = asyncio.get_running_loop().create_task(self.printer.run())

    async def open(self, opening):
        self.consoles.append(await opening)
        return self.consoles[-1]

    def session(self, wire):
        session = Session(self.printer.control, wire)
        session.say("start")
        return session

    async def tcp(self, clients=2):
        return await self.open(open_tcp(self.session, "127.0.0.1", 0, clients))

    async def pty(self, path):
        return await self.open(open_pty(self.session, str(path)))

    async def end(self):
        for console in self.consoles:
            console.close()
        self._run.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await self._run
        await asyncio.sleep(0)


def served(test):
    """Runs a test with a printer, in real time."""

    def run(**fixtures):
        async def body():
            async with asyncio.timeout(TIMEOUT_S):
                path = fixtures.get("tmp_path")
                serving = Served(None if path is None else str(path))
                try:
                    await test(serving, **fixtures)
                finally:
                    await serving.end()

        asyncio.run(body())

    names = test.__code__.co_varnames[1 : test.__code__.co_argcount]
    if names == ("tmp_path",):
        return lambda tmp_path: run(tmp_path=tmp_path)
    return lambda: run()


# -- pseudo terminals -----------------------------------------------------------------------------


@served
async def test_pty_accepts_hosts_one_after_another(s, tmp_path):
    path = tmp_path / "port"
    await s.pty(path)
    cut = False
    for _ in range(3):
        host = await at_pty(path)
        hello = await host.ok("N0 M110 N0*125")
        assert (
            any(x.startswith("Resend: ") for x in hello) == cut
        )  # what the last one left unfinished
        assert (await host.ok("N0 M110 N0*125"))[-1] == "ok"
        assert "T:" in (await host.ok("N1 M105*38"))[-1]
        host.write(b"G1 X")
        host.close()
        cut = True


@served
async def test_a_host_that_hangs_up_in_mid_upload_ends_it(s, tmp_path):
    """Nothing of the file stays, and what the next host sends is carried out."""
    path = tmp_path / "port"
    console = await s.pty(path)
    for i in range(3):
        host = await at_pty(path)
        await host.ok("G92 X0")
        assert (await host.ok("M28 new.g"))[-2] == "Writing to file: new.g"
        assert (await host.ok(f"G1 X{50 + i}"))[-1] == "ok"
        before = console.session
        host.write(b"G1 X60\nM106 S255\nG1 X7")
        host.close()
        while not before.closed or console.session is before:
            await asyncio.sleep(0)
    host = await at_pty(path)
    assert (await host.ok("M114"))[-2].startswith("X:0.000 ")
    assert s.printer.rig.commands.outputs.fans.get("part", 0) == 0
    assert "NEW.G" not in " ".join(await host.ok("M20"))
    await host.ok("M28 whole.g")
    await host.ok("G1 X5")
    assert "Done saving file." in await host.ok("M29")
    host.close()
    host = await at_pty(path)
    assert "WHOLE.G 6" in " ".join(await host.ok("M20"))
    assert console.session is not before
    host.close()


@served
async def test_link_of_a_pty_is_removed_with_it(s, tmp_path):
    path = tmp_path / "port"
    console = await s.pty(path)
    assert path.is_symlink()
    s.consoles.remove(console)
    console.close()
    assert not path.is_symlink()


@served
async def test_a_pty_replaces_a_stale_link(s, tmp_path):
    path = tmp_path / "port"
    path.symlink_to(tmp_path / "gone")
    await s.pty(path)
    host = await at_pty(path)
    assert (await host.ok("M115"))[-1] == "ok"
    host.close()


@served
async def test_pty_does_not_replace_a_regular_file(s, tmp_path):
    path = tmp_path / "port"
    path.write_text("mine")
    with pytest.raises(ConsoleError, match=r"the pty .*port cannot be opened: File exists"):
        await s.pty(path)
    assert path.read_text() == "mine"


@served
async def test_a_host_that_does_not_read_blocks_no_other_client(s, tmp_path):
    console = await s.pty(tmp_path / "port")
    listener = await at_tcp(await s.tcp())
    for _ in range(3000):
        console.session.say("x" * 1000)
    held = console.writer.get_write_buffer_size()
    assert wires._DEAD <= held < wires._DEAD + 2000
    for _ in range(100):
        console.session.hear("y" * 1000)
    assert console.writer.get_write_buffer_size() <= held
    assert "T:" in (await listener.ok("M105"))[-1]
    host = await at_pty(tmp_path / "port")
    host.write(b"M118 back\n")
    await listener.until("^back$")
    listener.close()
    host.close()


# -- serial devices -------------------------------------------------------------------------------


@pytest.mark.parametrize("baud", [9600, 115200, 250000, 12345, 2000000])
def test_a_serial_device_at_any_rate(baud):
    async def body():
        s = Served()
        master, slave = os.openpty()
        await s.open(open_serial(s.session, os.ttyname(slave), baud))
        attributes = bytearray(44)
        fcntl.ioctl(slave, 0x802C542A, attributes, True)
        assert struct.unpack("4IB19s2I", attributes)[6:] == (baud, baud)
        assert not struct.unpack("4I", attributes[:16])[3] & (termios.ECHO | termios.ICANON)
        reader = asyncio.StreamReader()
        transport, _ = await asyncio.get_running_loop().connect_read_pipe(
            lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(master, "rb", 0)
        )
        host = Client(reader, lambda data: os.write(master, data), transport.close)
        async with asyncio.timeout(TIMEOUT_S):
            assert (await host.ok("M115"))[-1] == "ok"
        await s.end()
        host.close()
        os.close(slave)

    asyncio.run(body())


def test_unplugged_serial_device_is_reopened(tmp_path, monkeypatch):
    monkeypatch.setattr(lines, "REOPEN_S", 0.01)
    device = tmp_path / "ttyUSB0"

    async def plugged(s):
        """The host's end of the cable, when the printer has opened its own."""
        master, slave = os.openpty()
        device.symlink_to(os.ttyname(slave))
        if not s.consoles:
            await s.open(open_serial(s.session, str(device), 115200))
        reader = asyncio.StreamReader()
        transport, _ = await asyncio.get_running_loop().connect_read_pipe(
            lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(master, "rb", 0)
        )
        host = Client(reader, lambda data: os.write(master, data), transport.close)
        await host.until("^start$")
        os.close(slave)
        return host

    async def body():
        s = Served()
        try:
            async with asyncio.timeout(TIMEOUT_S):
                for i in range(3):
                    host = await plugged(s)
                    assert (await host.ok(f"G92 X{i}"))[-1] == "ok"
                    host.write(b"M28 half.g\nG1 X")
                    before = s.consoles[0].session
                    device.unlink()
                    host.close()
                    while s.consoles[0].session is before:
                        await asyncio.sleep(0)
                    assert before.closed
        finally:
            await s.end()

    asyncio.run(body())


# -- TCP ------------------------------------------------------------------------------------------


@served
async def test_lines_of_a_half_closed_client_are_executed(s):
    """As with `printf … | nc -N`."""
    console = await s.tcp(clients=1)
    lines = [b"G92 X0 Y0 Z0\n", b"G1 X1 F6000\n", b"M400\n", b"M114\n"]
    for text in (b"", b"M105\n", b"".join(lines), b"G4 P50\n" + 5000 * b"M105\n"):
        reader, writer = await asyncio.open_connection(*tcp_address(console))
        writer.write(text)
        writer.write_eof()
        heard = (await reader.read()).decode().splitlines()  # until it hangs up
        oks = [line for line in heard if line.startswith("ok")]
        assert len(oks) == text.count(b"\n")
        if b"M114" in text:
            assert heard[-2].startswith("X:1.000 Y:0.000")
        writer.close()


@served
async def test_a_client_that_goes_away_ends_its_wait(s):
    console = await s.tcp(clients=1)
    client = await at_tcp(console)
    await client.ok("M113 S0.01")
    client.write(b"M109 S200\nM104 S50\n")
    while not s.printer.waits.heating:
        await asyncio.sleep(0)
    client.close()
    while s.printer.waits.heating:
        await asyncio.sleep(0)
    assert s.printer.rig.connection.heaters["hotend"].target == 200
    while True:  # and its place is free
        client = await at_tcp(console)
        told = await client.line()
        client.close()
        if told == "start":
            break


@served
async def test_one_client_too_many_gets_an_error(s):
    console = await s.tcp()
    first, second = await at_tcp(console), await at_tcp(console)
    for client in (first, second):
        assert await client.line() == "start"
    third = await at_tcp(console)
    assert await third.line() == "Error:too many clients"
    assert await third.line() == ""
    assert third.reader.at_eof()
    third.close()
    first.close()
    while True:  # until the printer has noticed that one has gone
        third = await at_tcp(console)
        if await third.line() == "start":
            break
        third.close()
    assert "T:" in (await third.ok("M105"))[-1]
    third.close()
    second.close()


@served
async def test_200_clients(s):
    """And when they are gone, nothing of them is left but what their lines have done."""

    def kept():
        printer = s.printer
        return (
            len(printer.state.listeners),
            len(printer.state.stop_listeners),
            len([*Path("/dev/fd").iterdir()]),
        )

    console = await s.tcp(clients=200)
    before = kept()
    clients = [await at_tcp(console) for _ in range(200)]
    for client in clients:
        client.write(b"M110\nM105\n")
    for client in clients:
        assert (await client.until("^ok T:"))[:2] == ["start", "ok"]
    assert kept()[:2] == (before[0] + 200, before[1] + 200)
    for line in ("M104 S45", "G92 X0 Y0 Z0", "G91"):
        await clients[0].ok(line)
    assert "to all" in await clients[0].ok("M118 to all")
    for client in clients[1:]:
        await client.until("^to all$")
    for client in clients:
        client.write(b"G1 X0.25 F6000\n")
    for client in clients:
        await client.until("^ok$")
        client.close()
    while any(now > then for now, then in zip(kept(), before, strict=True)):
        await asyncio.sleep(0)
    last = await at_tcp(console)
    await last.ok("M400")
    assert (await last.ok("M114"))[-2].startswith("X:50.000 Y:0.000 Z:0.000 E:0.0000 ")
    heaters = s.printer.rig.connection.heaters
    assert {name: heater.target for name, heater in heaters.items()} == {"hotend": 45, "bed": 0}
    assert s.printer.state.halted == ""
    last.close()


@served
async def test_partial_line_of_a_lost_client_is_dropped(s):
    console = await s.tcp()
    first, second = await at_tcp(console), await at_tcp(console)
    first.write(b"G92 X20\nM118 here\nG92 X3")
    await second.until("^here$")
    first.close()
    for _ in range(2):
        assert (await second.ok("M114"))[-2].startswith("X:20.000 ")
    second.close()


@served
async def test_host_that_does_not_read_loses_nothing(s):
    console = await s.tcp()
    host = await at_tcp(console)
    host.write(b"G4 P200\nM400\n" + b"M110\n" * 5000 + b"M118 end\n")
    heard = await host.until("^end$")
    assert heard.count("ok") == 5002
    host.close()


@served
async def test_a_client_that_sends_no_line_end_takes_no_memory(s):
    console = await s.tcp()
    first, second = await at_tcp(console), await at_tcp(console)
    for _ in range(160):
        first.write(b"x" * (1 << 16))
        await asyncio.sleep(0)
    assert "T:" in (await second.ok("M105"))[-1]
    first.write(b"\nM118 done\n")
    assert "echo:this line is longer than 65536" in (await first.until("^done$"))[1]
    first.close()
    second.close()


# -- the command line -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--tcp", "here"], "'here' is not HOST:PORT"),
        (["--tcp", "127.0.0.1:http"], "is not HOST:PORT"),
        (["--tcp", "127.0.0.1:70000"], "is not HOST:PORT, with a port below 65536"),
        (["--tcp", "192.0.2.1:2323"], "TCP 192.0.2.1:2323 cannot be opened: "),
        (["--tcp", "a" * 70 + ".b:2323"], "cannot be opened: "),
        (["--serial", "/nowhere/ttyUSB0"], "/nowhere/ttyUSB0 cannot be opened: No such file"),
        (["--serial", "/nowhere/ttyUSB0:115200"], "the serial device /nowhere/ttyUSB0 cannot"),
        (["--serial", "/nowhere/tty:0"], "0 is no rate"),
        (["--serial", "/dev/null"], "/dev/null cannot be opened: Inappropriate ioctl"),
        (["--pty", "{file}"], "cannot be opened: File exists"),
        (["--pty", "/nowhere/port"], "the pty /nowhere/port cannot be opened: No such file"),
        (["--pty", ""], "argument --pty: the path is empty"),
        (["--pty", "{file}/../a", "--pty", "{file}/../a"], "/a is given twice"),
        (["--tcp-clients", "0"], "'0' is not a number of clients from 1 to 65535"),
        (["--tcp-clients", "-1"], "'-1' is not a number of clients"),
        (["--state", "{file}"], "/file is no folder"),
        (["--clock", "soon"], "'soon' is not fast, real, or a factor from 0.001"),
    ],
)
def test_transport_that_cannot_open_is_one_sentence(
    options, sentence, tmp_path, capfd, monkeypatch
):
    (tmp_path / "file").write_text("mine")
    options = [x.format(file=tmp_path / "file") for x in options]
    with Path(tmp_path / "file").open() as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        assert main(["serve", *options]) == 2
    said = capfd.readouterr().err
    assert sentence in said
    assert "Traceback" not in said


@pytest.mark.parametrize("closed", ["<&-", ">&-"])
def test_standard_input_and_output_must_be_open(closed):
    line = f'"$0" -m passo serve --stdin {closed}'
    told = subprocess.run(
        ["sh", "-c", line, sys.executable], stderr=subprocess.PIPE, text=True, timeout=60
    )
    assert told.returncode == 2
    assert "standard input cannot be opened: it, or standard output, is closed" in told.stderr
    assert "Traceback" not in told.stderr


@pytest.mark.parametrize(
    ("answers", "turns"), [("answers", 4000), ("/dev/null", 50), ("/dev/full", 50)]
)
def test_standard_input_and_output_may_be_files(answers, turns, tmp_path):
    moves = "G1 X12 F6000\nG1 X10\n" * turns
    (tmp_path / "lines.gcode").write_text(f"G28\n{moves}M114\n")
    line = f'"$0" -m passo serve --stdin --clock fast --state . <lines.gcode >{answers}'
    served = subprocess.run(
        ["sh", "-c", line, sys.executable], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    # Some versions of Python write zero bytes there as they end: that is refused, too.
    assert served.returncode == 0 or answers == "/dev/full", served.stderr
    assert "Traceback" not in served.stderr
    if answers == "answers":
        said = (tmp_path / answers).read_text().splitlines()
        assert said.count("ok") == 8002
        assert said[-2].startswith("X:10.000 Y:0.000")


def test_empty_standard_input_ends_at_once():
    served = subprocess.run(
        [sys.executable, "-m", "passo", "serve", "--stdin", "--http", "none"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (served.returncode, served.stdout) == (0, "start\necho:Passo, i3\n")


def test_standard_input_runs_to_its_last_line():
    served = subprocess.run(
        [sys.executable, "-m", "passo", "serve", "--stdin", "--clock", "fast", "--http", "none"],
        input="G28\nG1 X12 F6000\nM400\nM114\n",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert served.returncode == 0
    assert "X:12.000" in served.stdout
    assert served.stdout.count("ok") == 4


@pytest.mark.parametrize("reader", ["head -1", "true", "sleep 0.2"])
@pytest.mark.parametrize("streams", ["", "2>&1"])
def test_a_reader_that_closes_standard_output_ends_it(reader, streams):
    lines = "(for i in 1 2 3 4 5 6; do echo M115; sleep 0.2; done)"
    served = f'"$0" -m passo serve --stdin --clock fast {streams}; echo "status $?" >&2'
    told = subprocess.run(
        ["sh", "-c", f"{lines} | ({served}) | {reader}", sys.executable],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert "status 0" in told.stderr
    assert "Traceback" not in told.stderr
