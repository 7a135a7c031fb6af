"""Switches that stop motors: armed on the board, which acts at once, and read by the host."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from passo.board.configuration import Oids
from passo.board.connection import Connection, Values
from passo.board.description import inverted

_SAMPLE_S = 15e-6  # between the samples that must agree
_SAMPLES = 4
_REPORT_S = 0.1  # a group tells its state so often
_REASONS = 255  # told apart, so that a late report of one search does not end the next


class Endstops:
    """The endstops of one board. Times in ticks of its clock."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._oids = Oids.of(connection.board)
        self._pins = {e.name: e.pin for e in connection.board.endstops}
        self._armed: set[str] = set()
        self._rest = 0  # ticks between two looks
        self._reason = 0
        self.hit: set[str] = set()  # of those armed

    def pressed(self, name: str) -> bool:
        """Asks the board. Lets time pass; raises MachineError."""
        oid = self._oids.endstops[name]
        state = self._connection.ask(f"endstop_query_state oid={oid}", "endstop_state")
        return self._is_pressed(name, state)

    def _is_pressed(self, name: str, state: Values) -> bool:
        return bool(state["pin_value"]) != inverted(self._pins[name])

    def arm(self, steppers: Mapping[str, Sequence[str]], clock: int, rest_s: float) -> None:
        """From a board clock on each of these endstops stops its steppers when it is pressed; the
        board looks every `rest_s` seconds. The motors' clocks must not be set anew after that: it
        would let a stopped motor go on."""
        connection = self._connection
        hz = connection.board.clock_hz
        clock &= 0xFFFFFFFF
        self._rest = int(rest_s * hz)
        self._armed, self.hit = set(steppers), set()
        self._reason = self._reason % _REASONS + 1
        for name, stopped in steppers.items():
            group = self._oids.trsyncs[name]
            connection.command(
                f"trsync_start oid={group} report_clock={clock} report_ticks={int(_REPORT_S * hz)}"
                " expire_reason=0"
            )
            for stepper in stopped:
                connection.command(
                    f"stepper_stop_on_trigger oid={self._oids.steppers[stepper]} trsync_oid={group}"
                )
            connection.command(
                f"endstop_home oid={self._oids.endstops[name]} clock={clock}"
                f" sample_ticks={int(_SAMPLE_S * hz)} sample_count={_SAMPLES}"
                f" rest_ticks={self._rest} pin_value={int(not inverted(self._pins[name]))}"
                f" trsync_oid={group} trigger_reason={self._reason}"
            )

    def all_hit(self) -> bool:
        """Takes in what the board has told: whether every armed endstop was hit."""
        groups = {self._oids.trsyncs[name]: name for name in self._armed}
        for _, values in self._connection.take_responses("trsync_state"):
            name = groups.get(int(values["oid"]))
            if name is None or values["can_trigger"] or values["trigger_reason"] != self._reason:
                continue
            self.hit.add(name)
        return self.hit == self._armed

    def hit_clock(self, name: str) -> int:
        """Board clock at which an endstop that was hit, and is still armed, first read as pressed.
        Asks the board. Lets time pass; raises MachineError."""
        oid = self._oids.endstops[name]
        state = self._connection.ask(f"endstop_query_state oid={oid}", "endstop_state")
        now = self._connection.now
        # The board tells when it would have looked again.
        ago = (now - (int(state["next_clock"]) - self._rest)) & 0xFFFFFFFF
        return now - ago

    def disarm(self) -> None:
        """None of them stops anything any more."""
        for name in self._armed:
            oid, group = self._oids.endstops[name], self._oids.trsyncs[name]
            self._connection.command(
                f"endstop_home oid={oid} clock=0 sample_ticks=0 sample_count=0 rest_ticks=0"
                f" pin_value=0 trsync_oid={group} trigger_reason=0"
            )
            self._connection.command(f"trsync_trigger oid={group} reason=0")
        self._armed = set()
