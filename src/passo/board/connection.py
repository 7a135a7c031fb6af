"""A connection to one board: identify and configure it, run a job, read its state."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import replace

from passo import _core
from passo.board.configuration import (
    checksum,
    commands,
    full_scale,
    heater_options,
    on_wire,
    queries,
    sensors_known_to,
)
from passo.board.description import (
    BoardDescription,
    I2cPins,
    Output,
    Sensor,
    SpiPins,
    inverted,
)
from passo.board.dictionary import DictionaryError
from passo.board.exchange import LEAD_S, Exchange
from passo.board.faults import BoardResetError
from passo.board.firmware_identity import identify
from passo.board.i2c_sensors.reader import ANSWERS, SUCCESS, I2cSensorReader
from passo.board.inputs import SETTLING_S
from passo.board.lights import LightFrames
from passo.board.main_loop import MainLoop
from passo.board.ports import Port
from passo.board.reading import Reading
from passo.board.recorded_frames import KEPT_BYTES, KEPT_PARTS, KEPT_S, RecordedFrames
from passo.board.shown_sensors import REPORTS, SensorReading, ShownSensors
from passo.board.start_up import add_parts, configure, follow_clock
from passo.board.survive import has_survived
from passo.board.tachometers import REPORT as COUNTER_REPORT
from passo.board.tachometers import Tachometers
from passo.errors import MachineError

_SQUARES = 256  # ticks² in one unit of reported load, if the board does not specify it
_FAREWELL_S = 0.6


class Connection(Exchange):
    """The host's side of one board, real or simulated. All times are ticks of the main board's
    clock, unless a name says `board_clock`, which is the clock of this board. Not thread-safe;
    `run` releases the interpreter lock. On a live port real time passes, and a thread of the core
    serves the link; otherwise time passes only in `run` and in methods that ask the board. Every
    method that lets time pass raises MachineError when the board shuts down and BoardSilentError
    when it no longer answers. When a heater fails, the host sends the command that turns it off
    within 0.1 s.
    """

    def __init__(self, board: BoardDescription, port: Port, name: str = "") -> None:
        super().__init__(board, port, name)
        self.move_count = 0
        self._crc = 0
        self.adopted = False
        self._timeline: _core.Timeline | None = None
        self._main_loop: MainLoop | None = None
        self._shown: ShownSensors | None = None
        self.lights = self._light_frames()
        self.i2c_sensors = self._i2c_sensor_reader()
        self.tachometers = Tachometers(self.oids.counters, board.clock_hz)

    def connect(self, *, adopt: bool = False) -> None:
        """Identifies and configures the board, follows its clock and starts its sensors.

        A board that was in use is reset first, because its state is unknown. With `adopt`, a board
        that has survived the loss of its host, and has exactly this configuration, keeps the state
        of its heaters and motors; then `adopted` is true.
        """
        self.begin(adopt=adopt and self.can_be_adopted())

    def can_be_adopted(self) -> bool:
        """Identifies the board. Returns whether it has survived the loss of its host and has
        exactly this configuration. If True, its motors are at standstill."""
        self._identify()
        state = self.ask("get_config", "config")
        same = state["is_config"] and not state["is_shutdown"] and state["crc"] == self._crc
        return bool(same) and self.survives and has_survived(self)

    def begin(self, *, adopt: bool) -> None:
        """Like `connect`. With `adopt` the board keeps its state; `can_be_adopted` must be True
        then."""
        self._identify()
        self.adopted = adopt
        try:
            lines = commands(self.board, self.dictionary)
            self.move_count = configure(self, lines, self._crc, adopt=adopt)
        except DictionaryError as error:
            raise MachineError.of("machine.dictionary", value=str(error)) from None
        follow_clock(self)
        add_parts(self, self.move_count)
        self._shown = ShownSensors(self.board, self.dictionary)
        self.renew()
        if self.adopted:
            # The board accepts commands again, and counts this host's commits from 0 on.
            self.command("survive_off")
            self.command("survive_arm")
            self._switch_off_loads()
        self.run(self.now)

    def _identify(self) -> None:
        if self.dictionary.commands:
            return
        try:
            identify(self)
            self.board = sensors_known_to(self.board, self.dictionary)
            self._number_parts()
            self._crc = checksum(commands(self.board, self.dictionary))
            self.lights = self._light_frames()
            self.i2c_sensors = self._i2c_sensor_reader()
            self.tachometers = Tachometers(self.oids.counters, self.board.clock_hz)
        except DictionaryError as error:
            raise MachineError.of("machine.dictionary", value=str(error)) from None

    def keep_frames(self) -> None:
        """Keeps frames of both directions from now on, for `recorded_frames`."""
        self.link.keep_record(KEPT_BYTES, KEPT_PARTS)

    @property
    def host_ticks(self) -> int:
        """Host time of the link now, in ticks of this board's nominal frequency; 0 before the
        link follows the clock of the board."""
        return self.link.host_at(self.board_clock) if self.link.synchronous else 0

    def recorded_frames(self, halt_ticks: int) -> RecordedFrames:
        """The kept frames from `KEPT_S` before the host time `halt_ticks` on."""
        since = halt_ticks - int(KEPT_S * self.board.clock_hz)
        return RecordedFrames(
            self.name, self.board, self.dictionary, self.oids, halt_ticks, self.link.recorded(since)
        )

    def join(self, timeline: _core.Timeline, *, main: bool, tolerance_s: float) -> None:
        """Puts the board on the timeline of several boards. `main` marks the main board. The step
        times of any other board may deviate from the plan by `tolerance_s` more, in seconds."""
        hz = self.board.clock_hz
        self._timeline = timeline
        self.link.join(timeline, main, tolerance_s * hz)
        if isinstance(self.wire, _core.LiveWire):
            self.wire.join(timeline)
        for target, s in zip(self.board.stepper_targets, self.board.steppers, strict=True):
            self.link.set_apart(target, float(s.apart_ticks), float(s.turning_ticks))

    def main_clock(self, clock: int) -> int:
        """The main board's clock when this board's clock reads `clock`. Only the low 32 bits of
        `clock` count; the time must be near the present one."""
        now = self.board_clock
        ago = (now - clock) & 0xFFFFFFFF
        return self.link.main_clock(now - ago + (1 << 32 if ago >= 1 << 31 else 0))

    @property
    def survives(self) -> bool:
        """Whether the board can stop by itself when its link is lost
        (docs/decisions/0013-survive.md)."""
        return self.dictionary.number("SURVIVE") > 0

    def use_commits(self, horizon_s: float) -> None:
        """Sends the job in commits, each `horizon_s` seconds ahead. Call it only if the board
        `survives`."""
        self.link.use_commits(self.ticks(horizon_s))
        for o in self._unheated():
            if o.max_duration_ticks > 0:
                oid = self.oids.outputs[o.name]
                self.command(f"survive_output oid={oid} value={self._at_halt(o)} seconds=0")

    async def reopen(self) -> None:
        """Like `open_again`, for a board that has run without the host.

        Raises LinkLostError if it cannot be reached, BoardResetError if it has lost its state,
        MachineError if it has shut down.
        """
        await self.open_again()
        state = self.ask_for("get_config", [], "config", {}, tries=1)
        if state["is_shutdown"]:
            # The refusal has the reason.
            self.ask_for("survive_off", [], "is_shutdown", {}, tries=1)
            raise self.shutdown_error()
        if not state["is_config"] or state["crc"] != self._crc:
            raise BoardResetError(self.name)

    async def open_again(self) -> None:
        """Opens the port again after the link was lost; the event loop keeps running. The job waits
        until `link.resume`. Raises LinkLostError."""
        self.forget_late_answers()
        if self.port.live:
            await asyncio.to_thread(self.port.open)
        self.link.reconnect()
        self.wire = self.port.attach(self.link)
        if isinstance(self.wire, _core.LiveWire):
            self.wire.use_board_clock()
            if self._timeline is not None:
                self.wire.join(self._timeline)

    def order_stop(self) -> None:
        """Queues the shutdown command, and the question whether the board has shut down; the link
        sends both when time next passes."""
        self.command("emergency_stop")
        self.command("get_config")

    def has_shut_down(self) -> bool:
        """Whether the board has reported a shutdown, by itself or in its answer to `order_stop`."""
        answers = self.take_responses("config")
        return self.link.shut_down or any(state["is_shutdown"] for _, state in answers)

    def renew(self) -> None:
        """Sends the sampling commands of the sensors again, which the board may have missed when
        the link was lost."""
        for line in queries(self.board, self.dictionary, self.clock_after(LEAD_S)):
            self.command(line)
        for heater in self.heaters.values():
            heater.asked_anew()
        self.inputs.asked_anew(self.clock_after(LEAD_S + SETTLING_S))
        self.lights.renew()
        self.i2c_sensors.renew()
        self.tachometers.forget()

    def _light_frames(self) -> LightFrames:
        oids = dict(self.oids.chains)
        for light in self.board.lights:
            if isinstance(light.wire, SpiPins):
                oids[light.name] = self.oids.spi_devices[light.wire]
            elif isinstance(light.wire, I2cPins):
                oids[light.name] = self.oids.i2c_devices[light.wire]
        return LightFrames(self.board.lights, oids, self.port.byte_s, older_i2c=self._older_i2c)

    @property
    def _older_i2c(self) -> bool:
        """Whether the board has only the older commands for I2C."""
        return self.dictionary.takes("i2c_read", "reg")

    def _i2c_sensor_reader(self) -> I2cSensorReader:
        sensors = self.board.i2c_sensors
        oids = {sensor.name: self.oids.i2c_devices[sensor.wire] for sensor in sensors}
        return I2cSensorReader(sensors, oids, older=self._older_i2c)

    def take_counts(self) -> None:
        """Takes the reports of the counters since the last call."""
        if self.board.counters:
            self.tachometers.take(self.take_responses(COUNTER_REPORT), self.board_clock)

    def count_rate(self, counter: str, lasts_s: float) -> float | None:
        """Changes per second of a counter, unless the last report is older than `lasts_s`."""
        rate = self.tachometers.rates.get(counter)
        if rate is None or self.board_clock - rate.clock > lasts_s * self.board.clock_hz:
            return None
        return rate.changes_s

    def work_lights(self) -> list[str]:
        """Sends what is due to the lights. Returns those that could not show their state in several
        attempts. Call this often, while the link is up."""
        if not self.board.lights:
            return []
        failed: list[str] = []
        for _, report in self.take_responses("neopixel_result"):
            light = self.lights.take_result(int(report["oid"]), success=bool(report["success"]))
            failed += [light] if light else []
        if not self.board.i2c_sensors:
            self.take_responses("i2c_response")  # writes need no answer
        self.lights.work(self._board_s, self.command)
        return failed

    def main_loop(self) -> MainLoop | None:
        """The load in the board's last report; None before the first report. Does not ask the
        board."""
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
        """Sends `messages` from now on, and returns `base_clock`, from which their clocks count
        (default: a quarter of a second from now). Both are ticks of the main board's clock, which
        runs at `main_hz` (default: the frequency of this board)."""
        base = self.now + self.ticks(LEAD_S) if base_clock is None else base_clock
        self.link.set_queue(messages)
        self.link.start_job(base, main_hz or float(self.board.clock_hz))
        return base

    def reading(self, heater: str, now: int) -> Reading:
        """The last reading of a heater's sensor, with its age at the time `now`. A board that is
        shut down still measures. Raises KeyError if there is no such heater."""
        loop = self.heaters[heater]
        if (clock := loop.reported) is None:
            return Reading(None)
        age_s = (now - self.link.main_clock(clock)) / self.wire.hz
        return Reading.of(loop.celsius, age_s, lost=self.lost)

    def sensor(self, name: str, now: int) -> SensorReading:
        """The last reading of a sensor that no heater uses, at the time `now`."""
        shown = self._shown
        if shown is None:
            return SensorReading(Reading(None))
        shown.take(self.take_responses(*REPORTS, oids=shown.oids))
        if (report := shown.last.get(name)) is None:
            return SensorReading(Reading(None))
        age_s = (now - self.main_clock(report.clock)) / self.wire.hz
        return SensorReading(Reading.of(report.celsius, age_s, lost=self.lost), report.broken)

    def i2c_sensor(self, name: str) -> SensorReading:
        """Like `sensor`, for a chip on I2C. Raises KeyError if the board does not have it."""
        state = self.i2c_sensors.state(name)
        if (measured := state.measured) is None:
            return SensorReading(Reading(None), state.fault or "", state.found)
        period_s = next(s.period_s for s in self.board.i2c_sensors if s.name == name)
        age_s = self._board_s - state.at_s - period_s
        reading = Reading.of(measured.celsius, age_s, lost=self.lost)
        return SensorReading(
            reading, humidity=measured.humidity, pressure_hpa=measured.pressure_hpa
        )

    @property
    def _board_s(self) -> float:
        """The clock of this board, in seconds."""
        return self.board_clock / self.board.clock_hz

    def work_i2c_sensors(self) -> None:
        """Takes what the chips on I2C have answered, and sends what is due to them. Call this
        often, while the link is up."""
        if not self.board.i2c_sensors:
            return
        for name, report in self.take_responses(*ANSWERS):
            status, data = SUCCESS, report["response"]
            if name == "i2c_response":
                number = int(report["i2c_bus_status"])
                status = self.dictionary.name_of("i2c_bus_status", number)
            assert isinstance(data, bytes)
            self.i2c_sensors.take(int(report["oid"]), status, data)
        self.i2c_sensors.work(self._board_s, self.command)

    def set_target(self, heater: str, celsius: float) -> None:
        """Sets a heater's target; 0 turns it off. A heater that has failed keeps the new target,
        but stays off until it is rearmed. Raises KeyError if there is no such heater."""
        self.heaters[heater].target = celsius

    def switch(self, output: str, on: bool) -> None:
        """Switches an output without a cycle at once. Raises KeyError if there is no such
        output."""
        pin = next(o.pin for o in self.board.outputs if o.name == output)
        self.command(
            f"update_digital_out oid={self.oids.outputs[output]} value={int(on != inverted(pin))}"
        )

    def tone(self, output: str, hz: float, seconds: float, after_s: float) -> None:
        """Pulses an output at `hz` and half of its power, for `seconds`, `after_s` seconds from
        now. The output must have a cycle, and be off. The board gets the command that ends the tone
        together with the one that starts it. Raises KeyError if there is no such output."""
        pin = next(o.pin for o in self.board.outputs if o.name == output)
        oid = self.oids.outputs[output]
        cycle = round(self.board.clock_hz / hz)
        begin = self.clock_after(after_s)
        end = begin + int(seconds * self.board.clock_hz)
        self.command(f"set_digital_out_pwm_cycle oid={oid} cycle_ticks={cycle}")
        for clock, on_ticks in ((begin, cycle // 2), (end, cycle if inverted(pin) else 0)):
            self.command(
                f"queue_digital_out oid={oid} clock={clock & 0xFFFFFFFF} on_ticks={on_ticks}"
            )

    def pulse(self, output: str, width_s: float, seconds: float, after_s: float) -> None:
        """Repeats pulses of `width_s` on an output that has a cycle, for `seconds`, `after_s`
        seconds from now. Raises KeyError if there is no such output."""
        pin = next(o for o in self.board.outputs if o.name == output)
        oid, hz = self.oids.outputs[output], self.board.clock_hz
        begin = self.clock_after(after_s)
        on, off = round(width_s * hz), 0
        if inverted(pin.pin):
            on, off = pin.cycle_ticks - on, pin.cycle_ticks
        for clock, ticks in ((begin, on), (begin + int(seconds * hz), off)):
            self.command(f"queue_digital_out oid={oid} clock={clock & 0xFFFFFFFF} on_ticks={ticks}")

    def set_sensor(self, heater: str, sensor: Sensor) -> None:
        """Replaces the table and the range of a heater's sensor, from its next report on. Name and
        pin stay. Raises KeyError if there is no such heater."""
        loop = self.heaters[heater]
        entry = next(h for h in self.board.heaters if h.name == heater)
        sensors = (
            replace(sensor, name=s.name, pin=s.pin) if s.name == entry.sensor else s
            for s in self.board.sensors
        )
        self.board = replace(self.board, sensors=tuple(sensors))
        loop.set_sensor(heater_options(self.board, entry, self.dictionary))

    def close(self) -> None:
        """Switches heaters and the laser off and releases the board. Raises nothing."""
        if isinstance(self.wire, _core.LiveWire):
            for heater in self.heaters.values():
                heater.target = 0.0
            self.link.stop_job()
            # The board's earlier commands are over by then; each heater is set again with the next
            # report of its sensor.
            with suppress(MachineError):
                self.run(self.now + self.ticks(_FAREWELL_S))
                self._switch_off_lasers()
                self.run(self.now + self.ticks(LEAD_S))
            self.wire.stop()

    def _unheated(self) -> list[Output]:
        """The outputs that are not heaters: no control loop renews them."""
        heated = {name for h in self.board.heaters for name in h.outputs}
        return [o for o in self.board.outputs if o.name not in heated]

    def _switch_off_loads(self) -> None:
        """Fans, the laser and other pulsed outputs; motors stay on, so that they keep their
        position. A tone ends by itself."""
        self._switch_off_lasers()
        for o in self._unheated():
            if o.kind == "digital" and o.cycle_ticks > 0 and o.max_duration_ticks == 0:
                value = int(self._at_halt(o) > 0)
                self.command(f"update_digital_out oid={self.oids.outputs[o.name]} value={value}")

    def _switch_off_lasers(self) -> None:
        clock = self.clock_after(LEAD_S / 2) & 0xFFFFFFFF
        for o in self._unheated():
            if o.kind == "pwm":
                oid, value = self.oids.outputs[o.name], self._at_halt(o)
                self.command(f"queue_pwm_out oid={oid} clock={clock} value={value}")

    def _at_halt(self, output: Output) -> int:
        """The value of an output that the board receives for the value after a shutdown."""
        return on_wire(output, output.at_halt, self.full_scale(output.name))

    def net_steps(self, stepper: str) -> int:
        """Steps forward minus steps backward that the board has made since it was configured. Lets
        time pass; raises MachineError."""
        oid = self.oids.steppers[stepper]
        answer = self.ask(f"stepper_get_position oid={oid}", "stepper_position")
        entry = next(s for s in self.board.steppers if s.name == stepper)
        sign = -1 if entry.invert != inverted(entry.dir_pin) else 1
        return sign * int(answer["pos"])

    def full_scale(self, output: str) -> int:
        """The value of an output that means fully on."""
        return full_scale(next(o for o in self.board.outputs if o.name == output), self.dictionary)
