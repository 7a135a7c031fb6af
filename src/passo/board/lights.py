"""Lights that a board sends frames to: chains on one wire, and devices on SPI and I2C buses. The
frames of one light are at least `PERIOD_S` apart and use a small part of the link: of several new
states, the last one is shown."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from passo.board.description import I2cPins, Light, SpiPins

PERIOD_S = 0.1  # at most 10 frames a second
LINK_SHARE = 0.1  # the fraction of the link's bytes that one light may use
BIT_MAX_S = 4e-6  # a bit that takes longer ends the frame
SLOW_BIT_MAX_S = 40e-6  # on a slow board, for interrupts; LEDs show a frame after 50 µs or more
RESET_S = 50e-6  # rest of the line before a frame

_UPDATE_BYTES = 40  # of one message
_TRANSFER_BYTES = 40
_MESSAGES = 2  # sent at a time: the motion's messages come in between
_TRIES = 8  # of a frame that the board could not send in time
_ANSWER_S = 1.0
_OVERHEAD = 12  # bytes of a message besides its data


@dataclass(slots=True)
class _Sent:
    """What has been sent to one light."""

    light: Light
    oid: int
    wanted: bytes = b""  # empty: nothing yet
    sent: bytes = b""  # empty: the board may have any bytes
    messages: deque[str] = field(default_factory=deque[str])
    next_s: float = 0.0  # the next frame may start then
    answer_by_s: float | None = None
    failures: int = 0


class LightFrames:
    """The frames of the lights of one board. `oids` has the object number of each light. A byte
    takes `byte_s` on the link. `older_i2c`: the board has only the older command for I2C."""

    def __init__(
        self,
        lights: tuple[Light, ...],
        oids: Mapping[str, int],
        byte_s: float,
        *,
        older_i2c: bool = False,
    ) -> None:
        self._byte_s, self._older_i2c = byte_s, older_i2c
        self._lights = {light.name: _Sent(light, oids[light.name]) for light in lights}

    def show(self, name: str, frame: bytes) -> None:
        """Shows the bytes of `frame` as soon as the light's turn comes, unless another frame comes
        before. Raises KeyError if the board does not have the light."""
        one = self._lights[name]
        if frame != one.wanted:
            one.wanted, one.failures = frame, 0

    def renew(self) -> None:
        """Sends everything again: call this when messages may be lost."""
        for one in self._lights.values():
            one.sent, one.answer_by_s = b"", None
            one.messages.clear()

    def take_result(self, oid: int, *, success: bool) -> str | None:
        """Handles the report about a frame. Returns the light that could not show a frame in
        several attempts, None otherwise."""
        one = next((one for one in self._lights.values() if one.oid == oid), None)
        if one is None or one.answer_by_s is None:
            return None
        one.answer_by_s = None
        if success:
            one.failures = 0
            return None
        one.failures += 1
        if one.failures < _TRIES:
            one.messages.append(f"neopixel_send oid={one.oid}")
            return None
        return one.light.name if one.failures == _TRIES else None

    def work(self, now_s: float, send: Callable[[str], None]) -> None:
        """Sends what is due at this time, in seconds of any steady clock."""
        for one in self._lights.values():
            if one.answer_by_s is not None:
                if now_s < one.answer_by_s:
                    continue
                one.answer_by_s, one.sent = None, b""  # the answer is lost
            if not one.messages and one.wanted != one.sent:
                if now_s < one.next_s:
                    continue
                one.messages += self._messages(one)
                size = sum(len(text) // 2 + _OVERHEAD for text in one.messages)
                one.next_s = now_s + max(PERIOD_S, size * self._byte_s / LINK_SHARE)
                one.sent = one.wanted
            elif one.messages and now_s < one.next_s and one.failures:
                continue
            for _ in range(min(_MESSAGES, len(one.messages))):
                text = one.messages.popleft()
                send(text)
                if text.startswith("neopixel_send"):
                    one.answer_by_s = now_s + _ANSWER_S
                    one.next_s = max(one.next_s, now_s + PERIOD_S)

    def _messages(self, one: _Sent) -> Iterator[str]:
        """The commands that let a light show the wanted frame in place of the one that was sent."""
        oid, frame = one.oid, one.wanted
        if isinstance(one.light.wire, SpiPins):
            for i in range(0, len(frame), _TRANSFER_BYTES):
                yield f"spi_send oid={oid} data={frame[i : i + _TRANSFER_BYTES].hex()}"
        elif isinstance(one.light.wire, I2cPins):
            for write in (frame,) if one.sent else (*one.light.setup, frame):
                if self._older_i2c:
                    yield f"i2c_write oid={oid} data={write.hex()}"
                else:
                    yield f"i2c_transfer oid={oid} write={write.hex()} read_len=0"
        else:
            for begin, end in _changes(frame, one.sent):
                yield f"neopixel_update oid={oid} pos={begin} data={frame[begin:end].hex()}"
            yield f"neopixel_send oid={oid}"


def _changes(frame: bytes, sent: bytes) -> Iterator[tuple[int, int]]:
    """The parts of a frame that differ, each for one message."""
    for begin in range(0, len(frame), _UPDATE_BYTES):
        end = min(begin + _UPDATE_BYTES, len(frame))
        if frame[begin:end] != sent[begin:end]:
            yield begin, end
