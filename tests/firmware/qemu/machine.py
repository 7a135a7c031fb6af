"""An STM32F405 as QEMU makes it, with an image of the firmware, and a host that speaks to it.

Time is QEMU's: so many nanoseconds an instruction, whatever the machine that runs the test is busy
with, and none while the chip is stopped. What QEMU has of the chip are core, memory, interrupts,
UARTs and timers; pins, clocks and watchdog are places that forget what is written to them.
"""

from __future__ import annotations

import json
import socket
import subprocess
from pathlib import Path
from typing import Any

from passo import _core
from passo.board.dictionary import Dictionary
from passo.board.identify import Identification

Values = dict[str, int | bytes]
_TIM2_COUNT, _TIM2_DIVIDER = 0x40000024, 0x40000028
# QEMU's timers count a clock of 1 GHz, the chip's one of 84 MHz.
_DIVIDER = 1000 // 84 + 1
_LONGEST_S = 120.0  # without an answer: QEMU hangs


class Machine:
    """QEMU with an image; its console is the third of the UARTs."""

    def __init__(self, image: Path) -> None:
        pairs = {name: socket.socketpair() for name in ("uart", "memory", "control")}
        links = (("-chardev", f"socket,id={n},fd={p[1].fileno()}") for n, p in pairs.items())
        self._process = subprocess.Popen(
            [
                *("qemu-system-arm", "-M", "netduinoplus2", "-nodefaults", "-display", "none"),
                *("-kernel", str(image), "-icount", "shift=4", "-S"),
                *(word for link in links for word in link),
                *("-serial", "null", "-serial", "null", "-serial", "chardev:uart"),
                *("-object", "qtest,id=registers,chardev=memory,log=/dev/null"),
                *("-mon", "chardev=control,mode=control"),
            ],
            pass_fds=[pair[1].fileno() for pair in pairs.values()],
        )
        for mine, others in pairs.values():
            others.close()
            mine.settimeout(_LONGEST_S)
        self.uart, self._memory = pairs["uart"][0], pairs["memory"][0]
        self._link = pairs["control"][0]
        self._control = self._link.makefile("rw")
        json.loads(self._control.readline())
        self.control("qmp_capabilities")

    def control(self, command: str) -> dict[str, Any]:
        """Gives QEMU itself a command."""
        self._control.write(json.dumps({"execute": command}) + "\n")
        self._control.flush()
        while "event" in (answer := json.loads(self._control.readline())):
            pass
        assert "return" in answer, answer
        return answer

    def _access(self, words: str) -> list[str]:
        self._memory.sendall(words.encode() + b"\n")
        answer = b""
        while not answer.endswith(b"\n"):
            answer += self._memory.recv(256)
        parts = answer.decode().split()
        assert parts[0] == "OK", parts
        return parts[1:]

    def read(self, address: int) -> int:
        """A word of memory, or a register."""
        return int(self._access(f"readl {address:#x}")[0], 16)

    def slow_the_clock(self) -> None:
        """To what the firmware expects, as far as whole numbers go (0.8 % less); after a reset."""
        self._access(f"writel {_TIM2_DIVIDER:#x} {_DIVIDER - 1}")

    def clock(self) -> int:
        """The firmware's clock."""
        return self.read(_TIM2_COUNT)

    def close(self) -> None:
        """Ends QEMU."""
        self._process.kill()
        self._process.wait()
        self._control.close()
        for link in (self.uart, self._memory, self._link):
            link.close()


class Host:
    """Speaks the protocol over a machine's UART: what it waits for are answers, never times."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.dictionary, self.compressed = self._identify()
        self._commands = _core.Formats(list(self.dictionary.commands))
        self._reports = _core.Formats(list(self.dictionary.reports))

    def _identify(self) -> tuple[Dictionary, bytes]:
        found, heard = Identification(), 0
        while found.dictionary is None:
            found.feed(self._receive())  # first it says that it starts
            # What was asked of a board that was just resetting is lost. It reports now and then:
            # a few reports without an answer are time enough to ask again.
            heard += 1
            self.machine.slow_the_clock()
            data, _ = found.poll(heard / 16)
            self.machine.uart.sendall(data)
        self._scanner, self._sequence = found._scanner, found._sequence
        return found.dictionary, found.compressed

    def _receive(self) -> bytes:
        data = self.machine.uart.recv(4096)
        assert data, "QEMU has ended"
        return data

    def send(self, *lines: str) -> None:
        """Sends commands at once, a frame each."""
        data = b""
        for line in lines:
            payload = self._commands.encode(*self.dictionary.values(line))
            data += _core.make_frame(payload, self._sequence)
            self._sequence = (self._sequence + 1) % 16
        self.machine.uart.sendall(data)

    def hear(self, name: str) -> Values:
        """Waits for a report."""
        while True:
            for frame in self._scanner.feed(self._receive()):
                assert frame is not None
                for found, values in self._reports.decode(frame[1]):
                    if found == name:
                        return values

    def ask(self, line: str, answer: str) -> Values:
        """Sends a command and waits for the report that answers it."""
        self.send(line)
        return self.hear(answer)
