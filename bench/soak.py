"""Whether `passo serve` keeps its memory over a day. Usage: bench/soak.py [HOURS] [SCALE]

A simulated printer prints one job after the other, HOURS (24) of print time at SCALE (60) times
real speed, for a client of Klipper's socket that asks what Moonraker asks: it subscribes to every
object and all lines, each fifth print it pauses and resumes, each seventh it cancels, and after
each twentieth it stops the printer by M112 and starts it again. Prints the memory of the server
(RSS) twenty times, and its growth after the first quarter. Ends with 1 if that is above 5 %, or if
a print fails.
"""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

_HOURS, _SCALE = 24.0, 60.0
_ROWS = 20
_START_S = 60.0  # real time, from the start of the server until the printer is ready
_MAX_GROWTH = 0.05
_LONGEST_S = 900.0  # print time of one job, far beyond what it takes
_NEEDED = ("complete", "cancelled")


def _job() -> str:
    """A print of some minutes, with objects, heating and fans."""
    lines = ["EXCLUDE_OBJECT_DEFINE NAME=cube CENTER=60,60", "M140 S50", "M109 S200", "G28"]
    lines += ["G90", "M83"]
    for layer in range(1, 11):
        lines += [f"G1 Z{layer * 0.2:.1f} F600", f"M106 S{layer * 25}", f"M117 layer {layer}"]
        lines += ["EXCLUDE_OBJECT_START NAME=cube"]
        lines += [f"G1 X{50 + i % 2 * 100} Y{50 + i} E4 F4800" for i in range(20)]
        lines += ["EXCLUDE_OBJECT_END NAME=cube"]
    return "\n".join([*lines, "M104 S0", "M140 S0", ""])


@dataclass
class _Client:
    """A client that asks what Moonraker asks. `state` has the subscribed objects."""

    path: str
    state: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])
    lines: int = 0
    _number: int = 0
    _answers: dict[int, asyncio.Future[dict[str, Any]]] = field(
        default_factory=dict[int, "asyncio.Future[dict[str, Any]]"]
    )

    async def connect(self) -> None:
        """Connects as soon as the printer is ready, and subscribes to everything. Raises
        TimeoutError."""
        async with asyncio.timeout(_START_S):
            await self._until_ready()
        names = (await self.ask("objects/list"))["objects"]
        await self.ask("gcode/subscribe_output", response_template={"method": "line"})
        wishes = dict.fromkeys(names)
        template = {"method": "status"}
        found = await self.ask("objects/subscribe", objects=wishes, response_template=template)
        self.state = found["status"]

    async def _until_ready(self) -> None:
        while True:
            try:
                reader, self._writer = await asyncio.open_unix_connection(self.path, limit=1 << 24)
            except OSError:
                await asyncio.sleep(0.2)
                continue
            self._reading = asyncio.create_task(self._read(reader))
            try:
                if (await self.ask("info"))["state"] == "ready":
                    break
            except ConnectionError:
                pass
            await self.close()
            await asyncio.sleep(0.2)

    async def close(self) -> None:
        """Ends the connection."""
        self._writer.close()
        await self._reading

    async def closed(self) -> None:
        """Waits until the server has ended the connection, as it does when the printer restarts: a
        new one before that would end, too."""
        await self._reading
        self._writer.close()

    async def _read(self, reader: asyncio.StreamReader) -> None:
        while True:
            try:
                message = json.loads((await reader.readuntil(b"\x03"))[:-1])
            except (asyncio.IncompleteReadError, ConnectionError):
                break
            if "id" in message:
                self._answers.pop(message["id"]).set_result(message)
            elif message["method"] == "line":
                self.lines += 1
            else:
                for name, values in message["params"]["status"].items():
                    self.state[name].update(values)
        for answer in self._answers.values():
            answer.set_exception(ConnectionError("the server has closed the connection"))
        self._answers.clear()

    async def ask(self, method: str, **params: object) -> dict[str, Any]:
        """The result of a request. Raises RuntimeError for one that is refused."""
        self._number += 1
        answer = asyncio.get_running_loop().create_future()
        self._answers[self._number] = answer
        request = {"id": self._number, "method": method, "params": params}
        self._writer.write(json.dumps(request).encode() + b"\x03")
        message: Mapping[str, Any] = await answer
        if "error" in message:
            raise RuntimeError(f"{method}: {message['error']['message']}")
        return message["result"]

    async def script(self, line: str) -> None:
        """Carries out a line."""
        await self.ask("gcode/script", script=line)

    async def until(self, *states: str, seconds: float) -> str:
        """Waits until the print is in one of these states; seconds of real time."""
        async with asyncio.timeout(seconds):
            while (now := self.state["print_stats"]["state"]) not in states:
                await asyncio.sleep(0.02)
        return now


def _memory_mb(pid: int) -> float:
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    raise RuntimeError("the server has ended")


async def _soak(process: subprocess.Popen[bytes], socket: Path, hours: float, scale: float) -> bool:
    client = _Client(str(socket))
    await client.connect()
    loop = asyncio.get_running_loop()
    begin, samples, rows, prints, restarts, failed = loop.time(), list[float](), 0, 0, 0, 0
    longest_s = _LONGEST_S / scale + 60

    def passed_h() -> float:
        return (loop.time() - begin) * scale / 3600

    print(" hours  prints  restarts  lines   MB", flush=True)
    while passed_h() < hours:
        prints += 1
        await client.script('SDCARD_PRINT_FILE FILENAME="part.gcode"')
        await client.until("printing", seconds=10)
        if prints % 5 == 0:
            await client.script("PAUSE")
            await client.until("paused", seconds=longest_s)
            await client.script("RESUME")
        if prints % 7 == 0:
            await client.script("CANCEL_PRINT")
        ended = await client.until(*_NEEDED, "error", seconds=longest_s)
        failed += ended not in _NEEDED
        if prints % 20 == 0:
            restarts += 1
            await client.ask("emergency_stop")
            await client.ask("gcode/firmware_restart")
            await client.closed()
            await client.connect()
        samples.append(_memory_mb(process.pid))
        if passed_h() >= hours * (rows + 1) / _ROWS:
            rows += 1
            row = f"{passed_h():6.2f}  {prints:6}  {restarts:8}  {client.lines:5}"
            print(f"{row}  {samples[-1]:5.1f}", flush=True)
    after = samples[len(samples) // 4 :]
    if len(after) < 2:
        raise SystemExit("too few prints to compare: give more hours")
    growth = max(after[len(after) // 2 :]) / max(after[: len(after) // 2]) - 1
    print(f"{prints} prints, {failed} failed; memory {growth:+.1%} after the first quarter")
    return growth <= _MAX_GROWTH and not failed


def main() -> int:
    """Runs the soak; 0 if memory is flat and no print has failed."""
    hours, scale = (
        float(sys.argv[i]) if len(sys.argv) > i else default
        for i, default in ((1, _HOURS), (2, _SCALE))
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        card, socket = folder / "card", folder / "klippy.sock"
        card.mkdir()
        (card / "part.gcode").write_text(_job())
        command = [sys.executable, "-m", "passo", "serve", "--machine", "i3"]
        command += ["--clock", f"{scale:g}"]
        command += ["--sd", str(card), "--state", str(folder / "state"), "--http", "none"]
        command += ["--tcp", "127.0.0.1:0", "--klippy-socket", str(socket)]
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        try:
            return 0 if asyncio.run(_soak(process, socket, hours, scale)) else 1
        finally:
            process.terminate()
            process.wait()


if __name__ == "__main__":
    sys.exit(main())
