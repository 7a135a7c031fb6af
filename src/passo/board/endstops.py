"""Endstops: the host arms them, and the board stops the motors at once when one triggers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from passo.board.boards import Boards
from passo.board.connection import Connection
from passo.board.description import inverted
from passo.board.eddy import EddyReader
from passo.board.exchange import Values
from passo.errors import CommandError

_NONE: Mapping[str, Sequence[str]] = {}
_SAMPLE_S = 15e-6  # interval of the samples that must agree
_SAMPLES = 4
_REPORT_S = 0.1  # interval of the state reports of a group
_REASONS = 60  # each search has its own reason, so that a late report does not end the next search
_FAILED = 64  # the first of 16 reasons for errors of a sensor
_FAILURES = 16
_EXPIRED = 128  # added to the reason when a board of the group was silent for too long
_SHARED_REPORT_S = 0.01  # interval of the state reports of a group of several boards
_SHARED_TIMEOUT_S = 0.05  # its motors stop when another board is silent for longer


class Endstops:
    """The endstops of a machine's boards. Times are in ticks of the main board's clock.

    A triggered endstop stops the motors of its own board without the host. The links pass the
    trigger on to other boards at once, without Python. Motors there stop later by the transmission
    time, and by at most `_SHARED_TIMEOUT_S` if a link fails. Every board counts its steps, so that
    no step is lost.
    """

    def __init__(self, boards: Boards) -> None:
        self._boards = boards
        # each with all boards on which it stops motors
        self._armed: dict[str, list[Connection]] = {}
        self._also: list[tuple[str, str]] = []  # further endstops, and the armed one they belong to
        self._rest_s = 0.0
        self._reason = 0
        # armed endstops that triggered, with the clock at which their motors stopped
        self.hit: dict[str, int] = {}
        self.expired: set[str] = set()  # armed endstops whose boards have lost each other
        self.failed: dict[str, CommandError] = {}  # armed sensors that have failed
        # The sensors that are endstops, by their names.
        self.eddies = {
            part.name: EddyReader(connection, part)
            for connection in boards.connections
            for part in connection.board.eddies
        }

    def _board(self, name: str) -> Connection:
        part = "eddies" if name in self.eddies else "endstops"
        return self._boards.connection_of(part, name)

    def _is_low(self, name: str) -> bool:
        """Whether the endstop reads low when triggered."""
        pin = next(e.pin for e in self._board(name).board.endstops if e.name == name)
        return inverted(pin)

    def pressed(self, name: str) -> bool:
        """Asks the board whether the endstop is triggered. Lets time pass; raises MachineError, and
        CommandError for a sensor that fails."""
        if name in self.eddies:
            return self.eddies[name].near()
        return bool(self._state(name)["pin_value"]) != self._is_low(name)

    def _state(self, name: str) -> Values:
        connection = self._board(name)
        oid = connection.oids.endstops[name]
        return connection.ask(f"endstop_query_state oid={oid}", "endstop_state")

    def arm(
        self,
        steppers: Mapping[str, Sequence[str]],
        clock: int,
        rest_s: float,
        *,
        opening: bool = False,
        also: Mapping[str, Sequence[str]] = _NONE,
    ) -> None:
        """From `clock` on, each of these endstops stops its steppers when it triggers or, with
        `opening`, when it opens; so do the endstops that it has in `also`, on its board. The
        board samples every `rest_s` seconds. After this call, do not
        set the motors' clocks: a stopped motor would continue."""
        self._rest_s = rest_s
        self._armed, self.hit, self.expired, self.failed = {}, {}, set(), {}
        self._also = []
        self._reason = self._reason % _REASONS + 1
        for connection in self._boards.connections:
            # Before its reset, a board may have reported a search of another host.
            connection.take_responses("trsync_state")
        for name, stopped in steppers.items():
            own = self._board(name)
            boards = [own]
            for stepper in stopped:
                board = self._boards.connection_of("steppers", stepper)
                if board not in boards:
                    boards.append(board)
            self._armed[name] = boards
            for board in boards:
                self._group(board, name, stopped, clock, shared=len(boards) > 1)
            if len(boards) > 1:
                self._boards.timeline.arm(
                    [(board.link.seat, board.oids.trsyncs[name]) for board in boards],
                    self._reason,
                    self._reason + _EXPIRED,
                    float(clock),
                    _SHARED_TIMEOUT_S * self._boards.board.clock_hz,
                    _FAILED if name in self.eddies else 0,
                )
            self._home(own, name, name, clock, opening=opening)
            for other in also.get(name, ()):
                self._also.append((other, name))
                self._home(own, other, name, clock, opening=opening)

    def _group(
        self, board: Connection, name: str, stopped: Sequence[str], clock: int, *, shared: bool
    ) -> None:
        """Arms the group (trsync) of the motors of one board that an endstop stops."""
        hz, group = board.board.clock_hz, board.oids.trsyncs[name]
        begin = board.link.own_clock(clock)
        report_s = _SHARED_REPORT_S if shared else _REPORT_S
        expired = self._reason + _EXPIRED if shared else 0
        board.command(
            f"trsync_start oid={group} report_clock={begin & 0xFFFFFFFF}"
            f" report_ticks={int(report_s * hz)} expire_reason={expired}"
        )
        if shared:
            end = (begin + int(_SHARED_TIMEOUT_S * hz)) & 0xFFFFFFFF
            board.command(f"trsync_set_timeout oid={group} clock={end}")
        for stepper in stopped:
            if stepper in board.oids.steppers:
                oid = board.oids.steppers[stepper]
                board.command(f"stepper_stop_on_trigger oid={oid} trsync_oid={group}")

    def _home(self, board: Connection, name: str, group: str, clock: int, *, opening: bool) -> None:
        hz, begin = board.board.clock_hz, board.link.own_clock(clock)
        if name in self.eddies:
            self.eddies[name].arm(board.oids.trsyncs[group], self._reason, _FAILED, begin)
            return
        level = int(self._is_low(name) == opening)
        board.command(
            f"endstop_home oid={board.oids.endstops[name]} clock={begin & 0xFFFFFFFF}"
            f" sample_ticks={int(_SAMPLE_S * hz)} sample_count={_SAMPLES}"
            f" rest_ticks={int(self._rest_s * hz)} pin_value={level}"
            f" trsync_oid={board.oids.trsyncs[group]} trigger_reason={self._reason}"
        )

    def all_hit(self) -> bool:
        """Handles the reports of the boards. Returns whether every armed endstop was triggered."""
        for connection in self._boards.connections:
            groups = {
                connection.oids.trsyncs[name]: name
                for name, boards in self._armed.items()
                if connection in boards
            }
            for _, values in connection.take_responses("trsync_state"):
                name = groups.get(int(values["oid"]))
                if name is None or values["can_trigger"]:
                    continue
                if values["trigger_reason"] == self._reason:
                    # Later reports repeat the trigger with other clocks.
                    if connection is self._board(name) and name not in self.hit:
                        self.hit[name] = connection.main_clock(int(values["clock"]))
                elif values["trigger_reason"] == self._reason + _EXPIRED:
                    self.expired.add(name)
                elif connection is self._board(name) and name in self.eddies:
                    number = int(values["trigger_reason"]) - _FAILED
                    if 0 <= number < _FAILURES and name not in self.failed:
                        self.failed[name] = self.eddies[name].error(number)
        return self.hit.keys() == self._armed.keys()

    def hit_clock(self, name: str) -> int:
        """The clock at which a triggered endstop first read as triggered. It must still be armed.
        Asks the board. Lets time pass; raises MachineError."""
        connection = self._board(name)
        rest = int(self._rest_s * connection.board.clock_hz)
        state = self._state(name)
        # The board reports the clock of the sample after that.
        return connection.main_clock(int(state["next_clock"]) - rest)

    def disarm(self) -> None:
        """Disarms the endstops: they stop no motor any more."""
        self._boards.timeline.disarm()
        for name, group in (*((name, name) for name in self._armed), *self._also):
            if name in self.eddies:
                self.eddies[name].disarm()
                continue
            own = self._board(group)
            own.command(
                f"endstop_home oid={own.oids.endstops[name]} clock=0 sample_ticks=0 sample_count=0"
                f" rest_ticks=0 pin_value=0 trsync_oid={own.oids.trsyncs[group]} trigger_reason=0"
            )
        for name, boards in self._armed.items():
            for board in boards:
                board.command(f"trsync_trigger oid={board.oids.trsyncs[name]} reason=0")
        self._armed, self._also = {}, []
