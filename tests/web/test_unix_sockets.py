"""The web interface on a Unix socket: who may open it, and who its callers are."""

import asyncio
import os
import signal
import socket
import stat
import subprocess
import sys

import pytest

import passo
from passo.errors import InputError, WebError
from passo.web.client import AsyncClient, Client, RequestError
from passo.web.unix_sockets import UnixSocket


def served(test, path, **options):
    """Runs `test(client, printer)` with a printer that is served on a Unix socket."""

    async def main():
        async with passo.Printer("i3", **options) as printer:
            assert printer.open_http(path=path) == f"unix:{path}"
            await test(AsyncClient(f"unix:{path}"), printer)

    passo.run(main(), clock=50)


async def raw(path, *headers):
    """The answer to a request with these headers."""
    reader, writer = await asyncio.open_unix_connection(path)
    lines = ["GET /api/v1/session HTTP/1.1", "Connection: close", *headers, "", ""]
    writer.write("\r\n".join(lines).encode())
    answer = await reader.read()
    writer.close()
    return answer.decode()


def test_callers_of_the_socket_are_programs_of_this_computer(tmp_path):
    path = str(tmp_path / "i3.sock")

    async def test(client, printer):
        found = stat.S_IMODE(os.lstat(path).st_mode), (await client.session.get()).role
        assert found == (0o660, "admin")
        assert printer._places[-1] == f"unix:{path}"
        assert '"role":"public"' in await raw(path, "Host: localhost", "X-Forwarded-For: 10.0.0.1")
        assert "web.host" in await raw(path, "Host: evil.example")
        await client.session.set_up("ada", "correct horse")
        with pytest.raises(RequestError) as refused:
            await AsyncClient(f"unix:{path}").heaters.set("bed", 50)
        assert refused.value.fault.code == "web.log-in"

    served(test, path)
    assert not os.path.lexists(path)


def test_socket_of_a_killed_program_is_replaced(tmp_path):
    path = tmp_path / "i3.sock"
    code = "import os, signal, sys; from pathlib import Path; "
    code += "from passo.web.unix_sockets import UnixSocket; UnixSocket(Path(sys.argv[1]), 0o660); "
    code += "os.kill(os.getpid(), signal.SIGKILL)"
    killed = subprocess.run([sys.executable, "-c", code, str(path)])
    assert killed.returncode == -signal.SIGKILL
    assert path.is_socket()

    async def test(client, printer):
        assert (await client.status.version()).machine == "i3"

    served(test, str(path))


def test_socket_that_a_program_serves_is_refused(tmp_path):
    path = tmp_path / "i3.sock"
    first = UnixSocket(path, 0o660)
    with pytest.raises(InputError, match="another program serves this socket"):
        UnixSocket(path, 0o660)
    first.socket.close()
    second = UnixSocket(path, 0o660)  # the program has ended
    first.remove()
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        caller.connect(str(path))  # still that of the second
    second.remove()
    assert list(tmp_path.iterdir()) == []
    second.socket.close()
    path.write_text("a file")
    with pytest.raises(InputError, match="the path is that of a file"):
        UnixSocket(path, 0o660)
    assert path.read_text() == "a file"
    with pytest.raises(InputError, match="No such file or directory"):
        UnixSocket(tmp_path / "none" / "i3.sock", 0o660)


def test_an_address_without_host_and_path_is_refused():
    for url in ("unix:", "unix://host/i3.sock", "ftp://host", "i3.sock"):
        with pytest.raises(ValueError, match="expected http://HOST:PORT or unix:PATH"):
            Client(url)
    with pytest.raises(RequestError) as error:
        Client("unix:/none/i3.sock").status.get()
    assert error.value.fault.code == "web.unreachable"


def test_unix_socket_is_not_announced(tmp_path):
    async def main():
        async with passo.Printer("i3") as printer:
            printer.open_http(path=tmp_path / "i3.sock", announce=True)

    with pytest.raises((InputError, WebError), match="only this computer reaches it"):
        passo.run(main())
    assert list(tmp_path.iterdir()) == []
