"""The link between the host and one board: commands, questions, reports, time."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Mapping, Sequence
from typing import TypeAlias

from passo import _core
from passo.board.analog_inputs import REPORT as ANALOG_REPORT
from passo.board.analog_inputs import AnalogReports
from passo.board.configuration import Oids, adc_full
from passo.board.description import BoardDescription
from passo.board.dictionary import Dictionary
from passo.board.faults import (
    BoardAloneError,
    BoardResetError,
    BoardSilentError,
    HeaterFault,
    shutdown_error,
)
from passo.board.inputs import InputChange, InputReports
from passo.board.ports import LinkLostError, Port
from passo.clock import time_scale
from passo.errors import MachineError

Values: TypeAlias = dict[str, int | bytes]

LEAD_S = 0.25  # from a command to its first effect
TIMEOUT_S = 0.5  # until a question is repeated
TRIES = 5
STEP_S = 0.01  # between two checks for an answer
_RESPONSES_KEPT = 1024


class Exchange:
    """The link to one board: what the host sends, and what the board reports.

    Every method that lets time pass raises LinkLostError when the port is closed. When a heater
    fails, the fault is appended to `faults` and passed to `on_fault`, which may raise. Without
    `on_fault`, the fault is raised as a MachineError.
    """

    def __init__(self, board: BoardDescription, port: Port, name: str = "") -> None:
        self.name = name
        self.board = board
        self.port = port
        self.link = _core.Link(float(board.clock_hz))
        self.link.set_byte_ticks(port.byte_s * board.clock_hz)
        self.wire = port.attach(self.link)
        self.dictionary = Dictionary((), (), {}, {})
        self._number_parts()
        self.heaters: dict[str, _core.Heater] = {}
        self.faults: list[HeaterFault] = []
        self.on_fault: Callable[[str, HeaterFault], None] | None = None
        self._reported: dict[str, int] = {}
        self._responses: list[tuple[str, Values]] = []
        # until this clock, an old answer may still arrive
        self._late: dict[tuple[str, int | None], int] = {}

    def _number_parts(self) -> None:
        """Call this when `board` or `dictionary` has changed."""
        self.oids = Oids.of(self.board)
        self.inputs = InputReports({oid: group for group, oid in self.oids.inputs.items()})
        analog = {self.oids.analog_inputs[a.name]: a for a in self.board.analog_inputs}
        self.analog = AnalogReports(analog, adc_full(self.dictionary))

    @property
    def now(self) -> int:
        """The main board's clock. On a live port it is the estimate of the board's clock, or this
        computer's clock before there is an estimate."""
        return self.wire.now

    @property
    def board_clock(self) -> int:
        """The clock of this board, by the last estimate."""
        return self.wire.board_clock(self.link)

    def ticks(self, seconds: float) -> int:
        """Seconds in ticks of the main board's clock."""
        return int(seconds * self.wire.hz)

    def clock_after(self, seconds: float) -> int:
        """The expected clock of this board in `seconds` from now."""
        return self.board_clock + int(seconds * self.board.clock_hz)

    def command(self, text: str) -> None:
        """Queues a command, as `name parameter=value …`; the link sends it when time next passes.

        Raises DictionaryError if the board does not know it.
        """
        self.link.send(*self.dictionary.values(text))

    def ask(self, text: str, answer: str) -> Values:
        """Sends a command and returns the values of the report `answer`.

        The board does not repeat reports, so the question is repeated. The report must be that of
        the object in the question.
        """
        name, values = self.dictionary.values(text)
        oid = re.search(r" oid=(\d+)", text)
        same = {"oid": int(oid[1])} if oid else {}
        about = (answer, same.get("oid"))
        if (late := self._late.pop(about, 0)) > self.now:
            self.pass_time(late)
        begin = self.now
        found = self.ask_for(name, values, answer, same)
        passed = self.now - begin
        if passed > self.ticks(TIMEOUT_S):
            # The question was repeated, and the second answer may be as late as this one.
            self._late[about] = self.now + passed
        return found

    def ask_for(
        self,
        name: str,
        values: Sequence[int | bytes],
        answer: str,
        same: Mapping[str, int],
        tries: int = TRIES,
    ) -> Values:
        """Sends the command `name` with `values`, up to `tries` times, and returns the first report
        `answer` that has the values of `same`. Raises BoardSilentError if there is none, and the
        error of the shutdown if the board has shut down."""
        self._collect()
        until, end = self.now, self.now + self.ticks(tries * TIMEOUT_S)
        repeat = until
        lost = True
        while until <= end:
            if lost or until >= repeat:
                self.link.send(name, list(values))
                repeat = until + self.ticks(TIMEOUT_S)
            # A board that is shut down still answers questions.
            self.pass_time(until)
            lost = self.link.acknowledged  # an answer has arrived by now, or is lost
            found = self._find(answer, same)
            if found is not None:
                return found
            until += self.ticks(STEP_S)
        if self.link.shut_down and not self.link.stopped_with_others:
            raise self.shutdown_error()
        raise self.silence(name)

    def take_responses(
        self, *names: str, oids: Container[object] | None = None
    ) -> list[tuple[str, Values]]:
        """The reports since the last call that no question asked for, oldest first: those of
        `names`, or all; with `oids`, only those of these objects."""
        self._collect()
        taken: list[tuple[str, Values]] = []
        rest: list[tuple[str, Values]] = []
        for report in self._responses:
            own = not names or report[0] in names
            own = own and (oids is None or report[1].get("oid") in oids)
            (taken if own else rest).append(report)
        self._responses = rest
        return taken

    @property
    def input_levels(self) -> dict[str, bool]:
        """Whether each input is active, as far as the board has reported it."""
        return self.inputs.levels | self.analog.levels

    def input_changes(self) -> list[InputChange]:
        """The changes of the inputs since the last call, in the order of the reports. The board
        receives an acknowledgement of each."""
        if not (self.oids.inputs or self.oids.analog_inputs):
            return []
        found = self.analog.take(self.take_responses(ANALOG_REPORT, oids=self.analog.oids))
        for _, report in self.take_responses("buttons_state"):
            oid, states = int(report["oid"]), report["state"]
            assert isinstance(states, bytes)
            count, changes = self.inputs.take(oid, int(report["ack_count"]), states)
            found += changes
            if count:
                self.command(f"buttons_ack oid={oid} count={count}")
        return found + self.inputs.settled(self.board_clock)

    def run(self, until_clock: int, *, until_heaters: bool = False) -> bool:
        """Lets time pass until `until_clock`. With `until_heaters`, returns True as soon as every
        heater has reached its target; otherwise returns False at `until_clock`.
        """
        stop = self.pass_time(until_clock, until_heaters)
        if self.link.shut_down:
            raise self.shutdown_error()
        if self.link.self_stopped:
            raise BoardAloneError.of("machine.alone")
        if self.link.lost:
            raise self.silence("get_clock")
        return stop == _core.Stop.HEATERS

    def pass_time(self, until_clock: int, until_heaters: bool = False) -> _core.Stop:
        """Like `run`, but a board that is shut down or silent is not an error."""
        while (stop := self.wire.run(until_clock, until_heaters)) == _core.Stop.FAULT:
            self.take_faults()
        if stop == _core.Stop.CLOSED:
            failure = self.wire.failure if isinstance(self.wire, _core.LiveWire) else ""
            if failure:
                raise LinkLostError.of("machine.link-failed", value=failure)
            raise LinkLostError.of("machine.closed")
        return stop

    def take_faults(self) -> None:
        """Reports the heaters that have failed since the last call."""
        for name, heater in self.heaters.items():
            fault = heater.fault
            if fault is None or self._reported.get(name) == fault.clock:
                continue
            self._reported[name] = fault.clock
            event = HeaterFault.of(name, fault)
            self.faults.append(event)
            if self.on_fault is None:
                raise MachineError([event.problem])
            self.on_fault(name, event)

    @property
    def lost(self) -> bool:
        """Whether the link is lost: the board is silent, or its port is closed."""
        try:
            self.pass_time(self.now)
        except LinkLostError:
            return True
        return self.link.lost

    def silence(self, question: str) -> LinkLostError:
        """The error of a board that has left a question unanswered, perhaps because it has
        restarted."""
        reset = self.link.restarted
        return BoardResetError(self.name) if reset else BoardSilentError(self.named(question))

    def shutdown_error(self) -> MachineError:
        """The error that says why the board has shut down."""
        reason = self.dictionary.name_of("static_string_id", self.link.shutdown_reason)
        return shutdown_error(reason, self.named(reason), time_scale())

    def named(self, text: str) -> str:
        """The text with the name of the board, if there are several boards."""
        return f"{text} (board {self.name})" if self.name else text

    def forget_late_answers(self) -> None:
        """Call this after the link was lost: old answers cannot arrive any more."""
        self._late.clear()

    def _find(self, answer: str, same: Mapping[str, int]) -> Values | None:
        fresh: list[tuple[str, Values]] = self.link.take_responses()
        found = None
        for name, values in fresh:
            wanted = name == answer and all(values.get(k, v) == v for k, v in same.items())
            if wanted and found is None:
                found = values
            else:
                self._responses.append((name, values))
        return found

    def _collect(self) -> None:
        self._responses += self.link.take_responses()
        del self._responses[:-_RESPONSES_KEPT]  # drop old reports that no caller has taken
