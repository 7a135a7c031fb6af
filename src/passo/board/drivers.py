"""Configures and monitors the motor drivers of one board that have registers."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from passo.board.configuration import Oids
from passo.board.description import Driver, UartPins, bare
from passo.board.trinamic import (
    AnswerLostError,
    DriverFailure,
    DriverLink,
    DriverSettings,
    Exchange,
    Reading,
    Spi20Wire,
    SpiWire,
    UartWire,
)
from passo.config.trinamic import CHIPS
from passo.errors import MachineError

if TYPE_CHECKING:
    from passo.board.connection import Connection

# The timeout of an answer, from the acknowledgement of the question on. The slowest UART takes 30
# ms; an answer over SPI arrives before the acknowledgement.
_TIMEOUT_S = 0.3
_STEP_S = 0.01
_MAX_LOST = 50  # lost answers in a row, while a caller waits for them
_ANSWERS = ("tmcuart_response", "spi_transfer_response")


@dataclass
class DriverState:
    """One driver: the `settings` that it should have, the `failure` if it does not have them, and
    the `reading` of its last status. `fresh` is True until a caller has used the reading."""

    link: DriverLink
    settings: DriverSettings
    failure: DriverFailure | None = None
    reading: Reading | None = None
    fresh: bool = False


@dataclass(eq=False)
class _Talk:
    """An exchange in progress, one question at a time. An answer that has not arrived by `deadline`
    counts as lost. The deadline is None until the board has acknowledged the question."""

    exchange: Exchange[Any]
    done: Callable[[Any], None]
    failed: Callable[[DriverFailure], None]
    question: str | None = None
    deadline: int | None = None
    lost: int = 0  # lost answers in a row


@dataclass
class _Line:
    """A UART or SPI device with the exchanges that wait for it. On a `slow` one, the answer arrives
    after the acknowledgement of the question."""

    slow: bool
    talks: deque[_Talk] = field(default_factory=deque[_Talk])


class Drivers:
    """All drivers of a connection that have registers, by their motors.

    `configure` waits for the answers, before any motor moves. The other methods only queue
    questions: call `poll` repeatedly while time passes.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        oids = Oids.of(connection.board)
        self._lines: dict[int, _Line] = {}
        self.states: dict[str, DriverState] = {}
        for driver in connection.board.drivers:
            link, oid = _link(driver, oids)
            self.states[driver.stepper] = DriverState(link, driver.settings)
            self._lines.setdefault(oid, _Line(isinstance(driver.wire, UartPins)))
        self._oids = {d.stepper: _link(d, oids)[1] for d in connection.board.drivers}

    @property
    def idle(self) -> bool:
        """Whether no question waits for an answer."""
        return not any(line.talks for line in self._lines.values())

    def configure(self) -> None:
        """Sets all drivers up. Lets time pass. Raises MachineError if the board fails, or if too
        many answers in a row are lost. A driver that fails is not an error here: its state has a
        `failure`."""
        for motor in self.states:
            self.begin_configure(motor)
        while not self.idle:
            self.poll()
            for talk in (line.talks[0] for line in self._lines.values() if line.talks):
                if talk.question and talk.lost > _MAX_LOST:
                    raise self._connection.silence(talk.question.partition(" ")[0])
            self._connection.run(self._connection.now + int(_STEP_S * self._connection.wire.hz))

    def require(self) -> None:
        """Like `configure`, but raises MachineError also for a driver that fails."""
        self.configure()
        failures = [state.failure for state in self.states.values() if state.failure is not None]
        if failures:
            raise MachineError([failure.problem for failure in failures])

    def begin_configure(
        self, motor: str, settings: DriverSettings | None = None
    ) -> Callable[[], bool]:
        """Starts to write the settings of a driver, the present ones or new `settings`. Does not
        wait. What it returns says whether they are written or have failed; `idle` does not say it,
        as the next questions may follow without a gap."""
        state = self.states[motor]
        if settings is not None:
            state.settings = settings

        def done(_: None) -> None:
            state.failure = None

        return self._begin(motor, state.link.configure(state.settings), done)

    def begin_change(self, motor: str, settings: DriverSettings) -> Callable[[], bool]:
        """Like `begin_configure`, but writes only the registers that new `settings` change."""
        state = self.states[motor]
        if state.failure is not None:
            return self.begin_configure(motor, settings)
        before, state.settings = state.settings, settings
        return self._begin(motor, state.link.change(before, settings), lambda _: None)

    def begin_read(
        self, motor: str, register: str, done: Callable[[int], None]
    ) -> Callable[[], bool]:
        """Starts to read a register by its name; calls `done` with its value. Does not wait; what
        it returns says whether the exchange is over."""
        return self._begin(motor, self.states[motor].link.read(register), done)

    def interrupt(self) -> None:
        """Ends all exchanges, because many of their messages may have been lost."""
        for line in self._lines.values():
            line.talks.clear()

    def begin_status(self, motor: str) -> None:
        """Starts to ask a driver for its status. Does not wait."""
        state = self.states[motor]

        def done(reading: Reading) -> None:
            state.reading, state.fresh = reading, True

        self._begin(motor, state.link.status(), done)

    def _begin(
        self, motor: str, exchange: Exchange[Any], done: Callable[[Any], None]
    ) -> Callable[[], bool]:
        state = self.states[motor]

        def failed(failure: DriverFailure) -> None:
            state.failure = failure

        talks, talk = self._lines[self._oids[motor]].talks, _Talk(exchange, done, failed)
        talks.append(talk)
        return lambda: talk not in talks

    def poll(self) -> None:
        """Handles the answers of the drivers, and sends the next questions. Lets no time pass."""
        if self.idle:
            return
        acknowledged = self._connection.link.acknowledged  # read before the answers are
        answers: dict[int, bytes] = {}
        for _, values in self._connection.take_responses(*_ANSWERS):
            data = values.get("read", values.get("response"))
            if isinstance(data, bytes):
                answers[int(values["oid"])] = data
        now = self._connection.now
        for oid, line in self._lines.items():
            if line.talks:
                self._go_on(line, answers.get(oid), now, acknowledged=acknowledged)

    def _go_on(self, line: _Line, answer: bytes | None, now: int, *, acknowledged: bool) -> None:
        talk = line.talks[0]
        asked = talk.question is not None
        if asked and answer is None:
            if talk.deadline is None and acknowledged:
                patience_s = _TIMEOUT_S if line.slow else 0.0
                talk.deadline = now + int(patience_s * self._connection.wire.hz)
            if talk.deadline is None or now < talk.deadline:
                return
        talk.lost = talk.lost + 1 if asked and answer is None else 0
        try:
            if not asked:
                talk.question = next(talk.exchange)
            elif answer is None:
                talk.question = talk.exchange.throw(AnswerLostError())
            else:
                talk.question = talk.exchange.send(answer)
        except StopIteration as end:
            talk.done(end.value)
            line.talks.popleft()
        except DriverFailure as failure:
            talk.failed(failure)
            line.talks.popleft()
        else:
            self._connection.command(talk.question)
            talk.deadline = None


def _link(driver: Driver, oids: Oids) -> tuple[DriverLink, int]:
    wire = driver.wire
    name, chip = driver.settings.chip, CHIPS[driver.settings.chip]
    if isinstance(wire, UartPins):
        oid = oids.uarts[wire]
        place = " and ".join(bare(pin) for pin in wire.pins)
        if chip.addresses > 1:
            place += f" (address {driver.address})"
        return DriverLink(driver.stepper, name, UartWire(oid, driver.address), place), oid
    oid = oids.spi_devices[wire]
    access = Spi20Wire(oid) if "spi20" in chip.buses else SpiWire(oid)
    return DriverLink(driver.stepper, name, access, bare(wire.cs_pin)), oid
