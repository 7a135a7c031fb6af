"""A connection to one board: identify, configure, run a job, ask how it is."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TypeAlias

from passo import _core
from passo.board.configuration import (
    Oids,
    checksum,
    commands,
    full_scale,
    heater_options,
    queries,
)
from passo.board.description import BoardDescription, Output, Sensor, inverted
from passo.board.dictionary import RUNS_KLIPPERS, RUNS_PASSOS, Dictionary, DictionaryError
from passo.board.faults import (
    BoardAloneError,
    BoardResetError,
    BoardSilentError,
    HeaterFault,
    shutdown_error,
)
from passo.board.main_loop import MainLoop
from passo.board.ports import LinkLostError, Port
from passo.board.recorded_frames import KEPT_BYTES, KEPT_PARTS, KEPT_S, RecordedFrames
from passo.board.words import check_words
from passo.clock import time_scale
from passo.errors import MachineError

_SQUARES = 256  # ticks² of a unit in reports of load, where the board does not specify it
Values: TypeAlias = dict[str, int | bytes]

_CHUNK, _SHORT_CHUNK = 40, 8
_STEP_S = 0.01
_TIMEOUT_S = 0.5
_TRIES = 5
LEAD_S = 0.25  # from a word to what it begins
_FAREWELL_S = 0.6
BRAKING_S = 10.0  # no machine brakes for longer
LOOK_S = 0.05  # between two looks whether it stands
ABSOLUTE_ZERO_C = -273.15  # hosts read it as a number, and it is clearly no temperature
_RESET_S = 0.05  # a board that was sent `reset` has begun to restart by then
_REOPEN_S = 5.0  # and its port is back by then
_RESPONSES_KEPT = 1024
_MAX_STEPS = 0xFFFF  # of one command
_SURVIVE = 2  # The settings that the control loop of a heater needs.
_SLOTS_RENEWED = 4  # of each output that is told its value again and again


class Connection:
    """The host's side of one board, wherever it is.

    All times are ticks of the main board's clock, which is this one unless others say so by `name`;
    `board_clock` is the board's own. Not thread-safe; `run` releases the interpreter lock.
    On a live port real time passes, and a thread of the core looks after the link; else time passes
    only in `run` and in what asks the board.
    Every method that lets time pass raises MachineError when the board shuts down and
    BoardSilentError when it no longer answers. When a heater fails, it is ordered off, to be so in
    0.1 s, and the fault is appended to `faults` and given to `on_fault`, which may raise; without
    that, it is raised as a MachineError.
    """

    def __init__(self, board: BoardDescription, port: Port, name: str = "") -> None:
        self.name = name
        self.board = board
        self.port = port
        self.link = _core.Link(float(board.clock_hz))
        self.link.set_byte_ticks(port.byte_s * board.clock_hz)
        self.wire = port.attach(self.link)
        self.dictionary = Dictionary((), (), {}, {})
        self.move_count = 0
        self.heaters: dict[str, _core.Heater] = {}
        self.faults: list[HeaterFault] = []
        self.on_fault: Callable[[str, HeaterFault], None] | None = None
        self._told: dict[str, int] = {}
        self._crc = 0
        self.adopted = False
        self.oids = Oids.of(board)
        self._timeline: _core.Timeline | None = None
        self._responses: list[tuple[str, Values]] = []
        self._main_loop: MainLoop | None = None
        self._late: dict[tuple[str, int | None], int] = {}  # until when old answers may come

    @property
    def now(self) -> int:
        """The main board's clock; on a live port each board's own, as far as it is known, and
        before that this computer's."""
        return self.wire.now

    @property
    def board_clock(self) -> int:
        """The board's own clock, as far as it is known."""
        return self.wire.board_clock(self.link)

    def connect(self, *, adopt: bool = False) -> None:
        """Identifies and configures the board, follows its clock and starts its sensors.

        A board that was in use is reset first, since its state is unknown. With `adopt` one that
        outlived its host, and has the very configuration, stays as it is, but for outputs other
        than heaters and motors; then `adopted` is true.
        """
        self.begin(adopt=adopt and self.left_alone())

    def left_alone(self) -> bool:
        """Identifies the board, and tells whether it has outlived its host, and has the very
        configuration; its motors stand then."""
        self._identify_once()
        state = self.ask("get_config", "config")
        same = state["is_config"] and not state["is_shutdown"] and state["crc"] == self._crc
        return bool(same) and self.survives and self._stood_alone()

    def begin(self, *, adopt: bool) -> None:
        """As `connect`; to adopt it if it was `left_alone`."""
        self._identify_once()
        try:
            self._configure(adopt)
        except DictionaryError as error:
            raise MachineError.of("machine.dictionary", value=str(error)) from None
        self._follow_clock()
        self._prepare()
        self.renew()
        if self.adopted:
            # It takes orders again, and counts this host's commits from 0 on.
            self.command("survive_off")
            self.command("survive_arm")
            self._switch_off_loads()
        self.run(self.now)

    def keep_frames(self) -> None:
        """Frames of both directions are kept from now on, for `recorded_frames`."""
        self.link.keep_record(KEPT_BYTES, KEPT_PARTS)

    @property
    def host_ticks(self) -> int:
        """Host time of the link now, in ticks of this board's nominal frequency; 0 before the
        link follows the clock of the board."""
        return self.link.host_at(self.board_clock) if self.link.synchronous else 0

    def recorded_frames(self, halt_ticks: int) -> RecordedFrames:
        """The frames since some seconds before that host time, as far as they are kept."""
        since = halt_ticks - int(KEPT_S * self.board.clock_hz)
        return RecordedFrames(
            self.name, self.board, self.dictionary, self.oids, halt_ticks, self.link.recorded(since)
        )

    def join(self, timeline: _core.Timeline, *, main: bool, tolerance_s: float) -> None:
        """The board is one of several: the main one, or one whose steps may miss the plan's times
        by `tolerance_s` more."""
        hz = self.board.clock_hz
        self._timeline = timeline
        self.link.join(timeline, main, tolerance_s * hz)
        if isinstance(self.wire, _core.LiveWire):
            self.wire.join(timeline)
        for target, s in zip(self.board.stepper_targets, self.board.steppers, strict=True):
            self.link.set_apart(target, float(s.apart_ticks), float(s.turning_ticks))

    def main_clock(self, clock: int) -> int:
        """The main board's clock when this one's reads `clock`, of which the low 32 bits count, not
        long ago."""
        now = self.board_clock
        ago = (now - clock) & 0xFFFFFFFF
        return self.link.main_clock(now - ago + (1 << 32 if ago >= 1 << 31 else 0))

    @property
    def survives(self) -> bool:
        """The board can stop by itself when it is left alone (docs/decisions/0013-survive.md)."""
        return self.dictionary.number("SURVIVE") > 0

    def use_commits(self, horizon_s: float) -> None:
        """The job comes in commits, and leaves so long ahead. Only if the board `survives`."""
        self.link.use_commits(self._ticks(horizon_s))
        for o in self._unheated():
            if o.max_duration_ticks > 0:
                off = self.full_scale(o.name) if inverted(o.pin) else 0
                oid = self.oids.outputs[o.name]
                self.command(f"survive_output oid={oid} value={off} seconds=0")

    async def reopen(self) -> None:
        """`open_again`, and the board has gone on alone.

        Raises LinkLostError if it cannot be reached, BoardResetError if it does not know any more
        what it did, MachineError if it has shut down.
        """
        await self.open_again()
        state = self._ask("get_config", [], "config", {}, tries=1)
        if state["is_shutdown"]:
            # The refusal tells why.
            self._ask("survive_off", [], "is_shutdown", {}, tries=1)
            raise self.shutdown_error()
        if not state["is_config"] or state["crc"] != self._crc:
            raise BoardResetError(self.name)

    async def open_again(self) -> None:
        """Opens the port again after the link was lost, while the loop goes on. The job stands
        until `link.go_on`. Raises LinkLostError."""
        self._late.clear()
        if self.port.live:
            await asyncio.to_thread(self.port.open)
        self.link.reconnect()
        self.wire = self.port.attach(self.link)
        if isinstance(self.wire, _core.LiveWire):
            self.wire.use_board_clock()
            if self._timeline is not None:
                self.wire.join(self._timeline)

    def order_stop(self) -> None:
        """Tells the board to shut down, and asks it whether it has; it leaves when time next
        passes."""
        self.command("emergency_stop")
        self.command("get_config")

    def has_shut_down(self) -> bool:
        """The board has told that it is shut down, or has answered so since `order_stop`."""
        answers = self.take_responses("config")
        return self.link.shut_down or any(state["is_shutdown"] for _, state in answers)

    @property
    def lost(self) -> bool:
        """The board cannot be heard any more: it is silent, or its port is closed."""
        try:
            self.pass_time(self.now)
        except LinkLostError:
            return True
        return self.link.lost

    def move_evenly(self, steps: Mapping[str, int], seconds: float, serial: int) -> None:
        """Motors that stand make so many steps each, forward if more than 0, in so many seconds and
        at an even pace, and stand behind the commit `serial` then: all of it, or nothing. The board
        is armed, and no job is under way."""
        clock = self._clock_after(2 * LEAD_S) & 0xFFFFFFFF
        for entry in self.board.steppers:
            left = abs(net := steps.get(entry.name, 0))
            if left == 0:
                continue
            oid = self.oids.steppers[entry.name]
            turned = entry.invert != inverted(entry.dir_pin)
            interval = int(seconds * self.board.clock_hz / left)
            self.command(f"reset_step_clock oid={oid} clock={clock}")
            self.command(f"set_next_step_dir oid={oid} dir={int((net > 0) != turned)}")
            while left > 0:
                count = min(left, _MAX_STEPS)
                self.command(f"queue_step oid={oid} interval={interval} count={count} add=0")
                left -= count
        self.command(f"survive_commit serial={serial} clock={clock} rest=1")

    def renew(self) -> None:
        """Tells how the board is to sample its sensors, which it may not have heard when the link
        was lost."""
        for line in queries(self.board, self.dictionary, self._clock_after(LEAD_S)):
            self.command(line)
        for heater in self.heaters.values():
            heater.asked_anew()

    def command(self, text: str) -> None:
        """Queues a command, as `name parameter=value …`; it leaves when time next passes.

        Raises DictionaryError if the board does not know it.
        """
        self.link.send(*self.dictionary.values(text))

    def ask(self, text: str, answer: str) -> Values:
        """Sends a command and returns the values of the report `answer`.

        Reports are not repeated by the board, so the question is. An object's report is that of the
        very object in the question.
        """
        name, values = self.dictionary.values(text)
        oid = re.search(r" oid=(\d+)", text)
        same = {"oid": int(oid[1])} if oid else {}
        about = (answer, same.get("oid"))
        if (late := self._late.pop(about, 0)) > self.now:
            self.pass_time(late)
        begin = self.now
        found = self._ask(name, values, answer, same)
        passed = self.now - begin
        if passed > self._ticks(_TIMEOUT_S):
            # It was repeated: the answer to the repetition is as late as this one.
            self._late[about] = self.now + passed
        return found

    def take_responses(self, *names: str) -> list[tuple[str, Values]]:
        """Unsolicited reports since the last call, oldest first: those of these names, or all."""
        self._collect()
        taken = [r for r in self._responses if not names or r[0] in names]
        self._responses = [r for r in self._responses if names and r[0] not in names]
        return taken

    def main_loop(self) -> MainLoop | None:
        """The load of the board by its last report; None before the first. Asks no board."""
        for _, report in self.take_responses("stats"):
            unit = int(self.dictionary.constants.get("STATS_SUMSQ_BASE", _SQUARES))
            self._main_loop = MainLoop.of(report, unit, float(self.board.clock_hz))
        return self._main_loop

    def start_job(
        self,
        messages: _core.MessageQueue,
        base_clock: int | None = None,
        main_hz: float | None = None,
    ) -> int:
        """Sends `messages` from now on, their clocks counted from `base_clock` (default: a quarter
        of a second from now). Both are the main board's, which runs at `main_hz` (default: as this
        one). Returns that clock."""
        base = self.now + self._ticks(LEAD_S) if base_clock is None else base_clock
        self.link.set_queue(messages)
        self.link.start_job(base, main_hz or float(self.board.clock_hz))
        return base

    def run(self, until_clock: int, *, until_heaters: bool = False) -> bool:
        """Lets time pass until `until_clock`, or until no heater is on its way any more.

        Returns False if it came to `until_clock`, True if the heaters were first.
        """
        stop = self.pass_time(until_clock, until_heaters)
        if self.link.shut_down:
            raise self.shutdown_error()
        if self.link.alone:
            raise BoardAloneError.of("machine.alone")
        if self.link.lost:
            raise self.silence("get_clock")
        return stop == _core.Stop.HEATERS

    def reading(self, heater: str) -> float:
        """What a heater's sensor says now, °C; absolute zero while the board tells nothing of it.
        KeyError if there is no such heater."""
        loop = self.heaters[heater]
        silent = not loop.heard or self.link.shut_down or self.lost
        return ABSOLUTE_ZERO_C if silent else loop.celsius

    def set_target(self, heater: str, celsius: float) -> None:
        """Sets a heater's target; 0 turns it off. One that has failed keeps it for when it is
        rearmed. KeyError if there is no such heater."""
        self.heaters[heater].target = celsius

    def switch(self, output: str, on: bool) -> None:
        """Switches an output without a cycle at once. KeyError if there is no such output."""
        pin = next(o.pin for o in self.board.outputs if o.name == output)
        self.command(
            f"update_digital_out oid={self.oids.outputs[output]} value={int(on != inverted(pin))}"
        )

    def tone(self, output: str, hz: float, seconds: float, after_s: float) -> None:
        """Pulses an output with a cycle, off so far, at `hz` and half of its power, for so many
        seconds, `after_s` from now; the board has its end with its beginning. KeyError if there is
        no such output."""
        pin = next(o.pin for o in self.board.outputs if o.name == output)
        oid = self.oids.outputs[output]
        cycle = round(self.board.clock_hz / hz)
        begin = self._clock_after(after_s)
        end = begin + int(seconds * self.board.clock_hz)
        self.command(f"set_digital_out_pwm_cycle oid={oid} cycle_ticks={cycle}")
        for clock, on_ticks in ((begin, cycle // 2), (end, cycle if inverted(pin) else 0)):
            self.command(
                f"queue_digital_out oid={oid} clock={clock & 0xFFFFFFFF} on_ticks={on_ticks}"
            )

    def pulse(self, output: str, width_s: float, seconds: float, after_s: float) -> None:
        """Pulses an output with a cycle for so many seconds, `after_s` from now. KeyError if there
        is no such output."""
        pin = next(o for o in self.board.outputs if o.name == output)
        oid, hz = self.oids.outputs[output], self.board.clock_hz
        begin = self._clock_after(after_s)
        on, off = round(width_s * hz), 0
        if inverted(pin.pin):
            on, off = pin.cycle_ticks - on, pin.cycle_ticks
        for clock, ticks in ((begin, on), (begin + int(seconds * hz), off)):
            self.command(f"queue_digital_out oid={oid} clock={clock & 0xFFFFFFFF} on_ticks={ticks}")

    def set_sensor(self, heater: str, sensor: Sensor) -> None:
        """Another idea of a heater's sensor: its table and its range, from the next report on. Name
        and pin stay. KeyError if there is no such heater."""
        loop = self.heaters[heater]
        entry = next(h for h in self.board.heaters if h.name == heater)
        sensors = (
            replace(sensor, name=s.name, pin=s.pin) if s.name == entry.sensor else s
            for s in self.board.sensors
        )
        self.board = replace(self.board, sensors=tuple(sensors))
        loop.set_sensor(heater_options(self.board, entry, self.dictionary))

    def close(self) -> None:
        """Switches heaters and the laser off and lets go of the board. Raises nothing."""
        if isinstance(self.wire, _core.LiveWire):
            for heater in self.heaters.values():
                heater.target = 0.0
            self.link.stop_job()
            # What the board has already is over by then; each heater is set anew with the next
            # report of its sensor.
            with suppress(MachineError):
                self.run(self.now + self._ticks(_FAREWELL_S))
                self._switch_off_lasers()
                self.run(self.now + self._ticks(LEAD_S))
            self.wire.stop()

    def _unheated(self) -> list[Output]:
        """The outputs that no heater's loop renews."""
        heated = {h.output for h in self.board.heaters}
        return [o for o in self.board.outputs if o.name not in heated]

    def _switch_off_loads(self) -> None:
        """Fans and the laser; motors stay on, so that they keep their position. A tone ends by
        itself."""
        self._switch_off_lasers()
        for o in self._unheated():
            if o.kind == "digital" and o.cycle_ticks > 0 and o.max_duration_ticks == 0:
                value = int(inverted(o.pin))
                self.command(f"update_digital_out oid={self.oids.outputs[o.name]} value={value}")

    def _switch_off_lasers(self) -> None:
        clock = self._clock_after(LEAD_S / 2) & 0xFFFFFFFF
        for o in self._unheated():
            if o.kind == "pwm":
                off = self.full_scale(o.name) if inverted(o.pin) else 0
                oid = self.oids.outputs[o.name]
                self.command(f"queue_pwm_out oid={oid} clock={clock} value={off}")

    def net_steps(self, stepper: str) -> int:
        """Steps forward less steps backward that the board has made since it was configured. Lets
        time pass; raises MachineError."""
        oid = self.oids.steppers[stepper]
        answer = self.ask(f"stepper_get_position oid={oid}", "stepper_position")
        entry = next(s for s in self.board.steppers if s.name == stepper)
        sign = -1 if entry.invert != inverted(entry.dir_pin) else 1
        return sign * int(answer["pos"])

    def full_scale(self, output: str) -> int:
        """The value of an output that means fully on."""
        return full_scale(next(o for o in self.board.outputs if o.name == output), self.dictionary)

    def pass_time(self, until_clock: int, until_heaters: bool = False) -> _core.Stop:
        """As `run`, but a board that is shut down or silent is no error."""
        while (stop := self.wire.run(until_clock, until_heaters)) == _core.Stop.FAULT:
            self.take_faults()
        if stop == _core.Stop.CLOSED:
            failure = self.wire.failure if isinstance(self.wire, _core.LiveWire) else ""
            if failure:
                raise LinkLostError.of("machine.link-failed", value=failure)
            raise LinkLostError.of("machine.closed")
        return stop

    def take_faults(self) -> None:
        """Tells of the heaters that have failed since the last call."""
        for name, heater in self.heaters.items():
            fault = heater.fault
            if fault is None or self._told.get(name) == fault.clock:
                continue
            self._told[name] = fault.clock
            event = HeaterFault.of(name, fault)
            self.faults.append(event)
            if self.on_fault is None:
                raise MachineError([event.problem])
            self.on_fault(name, event)

    def _ticks(self, seconds: float) -> int:
        return int(seconds * self.wire.hz)

    def _clock_after(self, seconds: float) -> int:
        """What the board's own clock will read."""
        return self.board_clock + int(seconds * self.board.clock_hz)

    def _identify_once(self) -> None:
        if self.dictionary.commands:
            return
        try:
            self._identify()
            self._check_version()
            self._check_clock()
            check_words(self.board, self.dictionary)
            self._crc = checksum(commands(self.board, self.dictionary))
        except DictionaryError as error:
            raise MachineError.of("machine.dictionary", value=str(error)) from None

    def _check_version(self) -> None:
        if 0 < self.dictionary.number("SURVIVE") < _SURVIVE:
            raise MachineError.of("machine.old-firmware")
        if self.board.survives not in (None, self.survives):
            raise DictionaryError(RUNS_PASSOS if self.survives else RUNS_KLIPPERS)

    def _check_clock(self) -> None:
        hz, wanted = self.dictionary.number("CLOCK_FREQ"), self.board.clock_hz
        if hz not in (0, wanted):
            raise DictionaryError(
                f"its clock has {hz / 1e6:g} MHz, not {wanted / 1e6:g} MHz (clock_hz)"
            )

    def _identify(self) -> None:
        data = b""
        while True:
            part = (self._part(len(data)) if data else self._first_part())["data"]
            if not isinstance(part, bytes) or not part:
                break
            data += part
        self.dictionary = Dictionary.parse(data)
        self.link.set_dictionary(
            list(self.dictionary.commands),
            list(self.dictionary.reports),
            self.dictionary.number("RECEIVE_WINDOW"),
        )

    def _part(self, offset: int) -> Values:
        with suppress(BoardSilentError):
            return self._chunk(offset, _CHUNK, tries=1)
        # Of a bad link's bytes, few come through together.
        return self._chunk(offset, _SHORT_CHUNK, _TRIES - 1)

    def _chunk(self, offset: int, size: int, tries: int) -> Values:
        return self._ask("identify", [offset, size], "identify_response", {"offset": offset}, tries)

    def _first_part(self) -> Values:
        """What the board had said to another link may come first. It misleads about the number that
        the board expects, which is asked for anew then."""
        for _ in range(_TRIES - 1):
            with suppress(BoardSilentError):
                return self._chunk(0, _CHUNK, tries=1)
            self.link.restart()
        return self._chunk(0, _CHUNK, tries=1)

    def _follow_clock(self) -> None:
        self.link.follow_clock(0)  # at once: `now` counts in ticks of the main board
        for _ in range(int(_TIMEOUT_S * _TRIES / _STEP_S)):
            self.run(self.now)
            if self.link.synchronous:
                if isinstance(self.wire, _core.LiveWire):
                    self.wire.use_board_clock()
                return
            self.run(self.now + self._ticks(_STEP_S))
        raise self.silence("get_uptime")

    def stopped(self) -> Values | None:
        """The `survive_state` of a board that was left alone, once its motors stand. Asks the
        board."""
        states = self.dictionary.enumerations["survive"]
        state = self.ask("survive_query", "survive_state")
        return None if state["state"] in (states["moving"], states["braking"]) else state

    def _stood_alone(self) -> bool:
        """Whether the board has outlived its host, and its motors stand."""
        states = self.dictionary.enumerations["survive"]
        for _ in range(int(BRAKING_S / LOOK_S)):
            if (state := self.stopped()) is not None:
                return state["state"] in (states["resting"], states["held"])
            self.pass_time(self.now + self._ticks(LOOK_S))
        return False

    def _configure(self, adopt: bool) -> None:
        lines = commands(self.board, self.dictionary)
        state = self.ask("get_config", "config")
        self.adopted = adopt
        if not self.adopted and (state["is_shutdown"] or state["is_config"]):
            self._reset(shut_down=bool(state["is_shutdown"]))
            state = self.ask("get_config", "config")
            if state["is_shutdown"] or state["is_config"]:
                raise MachineError.of("machine.no-reset", value=self._named("the board"))
        if not state["is_config"]:
            for line in [*lines, f"finalize_config crc={self._crc}"]:
                self.command(line)
            state = self._ask("get_config", [], "config", {"is_config": 1})  # none of before that
        self.move_count = int(state["move_count"])

    def _reset(self, *, shut_down: bool) -> None:
        """Restarts the board, so that it has no configuration. Raises MachineError."""
        known = {text.split(" ", 1)[0] for _, text in self.dictionary.commands}
        if "reset" in known:
            self.command("reset")
        elif "config_reset" in known:  # a Linux process, or a PRU: only in a shutdown
            if not shut_down:
                self.command("emergency_stop")
                self._find_shut_down()
            self.command("config_reset")
        else:
            raise MachineError.of("machine.no-reset", value=self._named("the board"))
        try:
            self.pass_time(self.now + self._ticks(_RESET_S))
            self.link.restart()
            self._identify()
        except LinkLostError:
            # A device of USB, or the pty of a process, is a new one after the restart.
            self.port.open(_REOPEN_S)
            self.link.restart()
            self.wire = self.port.attach(self.link)
            self._identify()

    def _find_shut_down(self) -> None:
        """Waits until the board has shut down."""
        for _ in range(_TRIES):
            self.pass_time(self.now + self._ticks(_RESET_S))
            self.link.restart()  # it may be asked again, also on a live port
            if self.ask("get_config", "config")["is_shutdown"]:
                return

    def _prepare(self) -> None:
        renewed = sum(o.max_duration_ticks > 0 for o in self.board.outputs)
        slots = self.move_count - _SLOTS_RENEWED * renewed
        self.link.set_slots(max(slots, 1))
        for target, s in zip(self.board.stepper_targets, self.board.steppers, strict=True):
            turned = s.invert != inverted(s.dir_pin)
            self.link.add_stepper(target, s.name, self.oids.steppers[s.name], turned)
        heated = {h.output for h in self.board.heaters}
        for target, o in zip(self.board.output_targets, self.board.outputs, strict=True):
            kind = _core.PinKind.PWM if o.kind == "pwm" else _core.PinKind.DIGITAL
            full = full_scale(o, self.dictionary)
            low = full if inverted(o.pin) else 0
            # A heater's own loop renews it.
            longest = 0 if o.name in heated else o.max_duration_ticks
            self.link.add_pin(target, o.name, self.oids.outputs[o.name], kind, low, longest)
            if o.kick:
                self.link.set_kick(
                    target, o.kick.ticks, round(o.kick.power * full), int(o.kick.rise * full)
                )
        for h in self.board.heaters:
            options = heater_options(self.board, h, self.dictionary)
            self.heaters[h.name] = self.link.add_heater(options)

    def _ask(
        self,
        name: str,
        values: Sequence[int | bytes],
        answer: str,
        same: Mapping[str, int],
        tries: int = _TRIES,
    ) -> Values:
        """The report `answer` in which the values of `same` are these. Raises BoardSilentError, or
        the reason for which the board has shut down by itself."""
        self._collect()
        until, end = self.now, self.now + self._ticks(tries * _TIMEOUT_S)
        repeat = until
        lost = True
        while until <= end:
            if lost or until >= repeat:
                self.link.send(name, list(values))
                repeat = until + self._ticks(_TIMEOUT_S)
            # A board that is shut down may still be asked.
            self.pass_time(until)
            lost = self.link.told  # its answer has come by now, or never will
            found = self._find(answer, same)
            if found is not None:
                return found
            until += self._ticks(_STEP_S)
        if self.link.shut_down and not self.link.stopped_with_others:
            raise self.shutdown_error()
        raise self.silence(name)

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
        del self._responses[:-_RESPONSES_KEPT]  # reports that no caller takes

    def silence(self, question: str) -> LinkLostError:
        """The board has left a question unanswered, perhaps because it has begun anew."""
        reset = self.link.begun_anew
        return BoardResetError(self.name) if reset else BoardSilentError(self._named(question))

    def _named(self, text: str) -> str:
        return f"{text} (board {self.name})" if self.name else text

    def shutdown_error(self) -> MachineError:
        """Why the board has shut down."""
        reason = self.dictionary.name_of("static_string_id", self.link.shutdown_reason)
        return shutdown_error(reason, self._named(reason), time_scale())
