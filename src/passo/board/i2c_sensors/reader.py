"""Reads the sensor chips on the I2C buses of one board, one transfer of a chip at a time, without
waiting for the board."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from passo.board.description import I2cSensor
from passo.board.i2c_sensors.bosch_chips import read_bosch
from passo.board.i2c_sensors.exchanges import ChipError, ChipFault, Measured, Steps, Transfer
from passo.board.i2c_sensors.simple_chips import CHIPS, read_simple

ANSWERS = ("i2c_response", "i2c_read_response")
SUCCESS = "SUCCESS"

_ANSWER_S = 1.0
_AGAIN_S = 1.0  # after a failure
_FAILURES = 3  # in a row, until a chip counts as silent or as another one


@dataclass(slots=True)
class ChipState:
    """The last measurement of a chip, its time, and what is wrong: `found` is what came in place of
    the expected. `measured` is None before the first one, and while something is wrong."""

    measured: Measured | None = None
    at_s: float = 0.0
    fault: ChipFault | None = None
    found: str = ""


@dataclass(slots=True)
class _Chip:
    """One chip that is read."""

    sensor: I2cSensor
    oid: int
    state: ChipState = field(default_factory=ChipState)
    steps: Steps | None = None
    transfer: Transfer | None = None  # that the board has not answered
    answer_by_s: float = 0.0
    answers: deque[tuple[str, bytes]] = field(default_factory=deque[tuple[str, bytes]])
    next_s: float = 0.0
    failures: int = 0


class I2cSensorReader:
    """The chips of one board. `oids` has the object number of each chip. `older`: the board has the
    commands of firmware before August 2025, and shuts down if a chip does not answer."""

    def __init__(
        self, sensors: tuple[I2cSensor, ...], oids: Mapping[str, int], *, older: bool = False
    ) -> None:
        self._older = older
        self._chips = {sensor.name: _Chip(sensor, oids[sensor.name]) for sensor in sensors}

    def state(self, name: str) -> ChipState:
        """What is known of a chip. Raises KeyError if the board does not have it."""
        return self._chips[name].state

    def take(self, oid: int, status: str, data: bytes) -> None:
        """Takes the answer to a transfer: how it ended, and the bytes from the chip."""
        for chip in self._chips.values():
            if chip.oid == oid:
                chip.answers.append((status, data))

    def renew(self) -> None:
        """Starts all chips again: call this when messages may be lost."""
        for chip in self._chips.values():
            chip.steps = chip.transfer = None
            chip.answers.clear()

    def work(self, now_s: float, send: Callable[[str], None]) -> None:
        """Sends what is due at this time, in seconds of any steady clock."""
        for chip in self._chips.values():
            answer = b""
            if chip.transfer is not None:
                if not chip.answers and now_s < chip.answer_by_s:
                    continue
                status, answer = chip.answers.popleft() if chip.answers else ("no report", b"")
                transfer, chip.transfer = chip.transfer, None
                if status != SUCCESS or len(answer) < transfer.count:
                    self._failed(chip, ChipError("silent", status), now_s)
            if now_s >= chip.next_s:
                self._advance(chip, answer, now_s, send)

    def _advance(
        self, chip: _Chip, answer: bytes, now_s: float, send: Callable[[str], None]
    ) -> None:
        """Carries out the steps of a chip until it waits."""
        chip.answers.clear()
        if chip.steps is None:
            chip.steps, answer = _steps_of(chip.sensor.kind), b""
            step = next(chip.steps)
        else:
            step = None
        try:
            while step is None or isinstance(step, Transfer):
                if isinstance(step, Transfer):
                    send(self._command(chip.oid, step))
                    if step.count or not self._older:
                        chip.transfer, chip.answer_by_s = step, now_s + _ANSWER_S
                        return
                step, answer = chip.steps.send(answer), b""
        except ChipError as error:
            self._failed(chip, error, now_s)
            return
        if isinstance(step, Measured):
            chip.state, chip.failures = ChipState(step, now_s), 0
            chip.next_s = now_s + chip.sensor.period_s
        else:
            chip.next_s = now_s + step

    def _command(self, oid: int, step: Transfer) -> str:
        write = step.write.hex()
        if not self._older:
            return f"i2c_transfer oid={oid} write={write} read_len={step.count}"
        if step.count:
            return f"i2c_read oid={oid} reg={write} read_len={step.count}"
        return f"i2c_write oid={oid} data={write}"

    def _failed(self, chip: _Chip, error: ChipError, now_s: float) -> None:
        chip.steps, chip.next_s = None, now_s + _AGAIN_S
        chip.failures += 1
        if chip.failures >= _FAILURES:
            chip.state = ChipState(None, now_s, error.fault, str(error))


def _steps_of(kind: str) -> Steps:
    return read_simple(CHIPS[kind]) if kind in CHIPS else read_bosch()
