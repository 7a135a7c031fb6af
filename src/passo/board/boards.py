"""All boards of one machine behind one interface; each part of the machine is wired to one
board."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

from passo import _core
from passo.board.connection import Connection
from passo.board.description import Sensor, together
from passo.board.exchange import LEAD_S
from passo.board.fault_injection import FaultInjector
from passo.board.faults import BoardAloneError, HeaterFault
from passo.board.inputs import InputChange
from passo.board.ports import LinkLostError
from passo.board.reading import Reading
from passo.board.shown_sensors import SensorReading
from passo.errors import MachineError

# How long the host measures the clocks of several boards: `SETTLING_S`, plus `_SETTLING_PER_JITTER`
# seconds for each second of usual answer delay, at most `_LONGEST_SETTLING_S`.
SETTLING_S = 4.0
_SETTLING_PER_JITTER = 6000.0
_LONGEST_SETTLING_S = 30.0
_LOOK_S = 0.02  # longest delay before a fault of one live board among several is reported
_NEWS_S = 0.05  # until all boards have been told that one is lost
_TOLERANCE_S = 1e-6  # tolerance of a step on a further board, in addition to that of the plan


class Boards:
    """The connections to the boards of one machine, the main one first.

    Times are ticks of the main board's clock, and so are the clocks of messages. `board` describes
    all boards together. Methods raise as those of `Connection` do. When one board fails, the links
    of the others stop these at once; when one is only lost, and motion comes in commits, all brake
    by themselves.
    """

    def __init__(self, connections: Sequence[Connection]) -> None:
        self.connections = list(connections)
        self.main = self.connections[0]
        self.board = together({c.name: c.board for c in self.connections})
        self.timeline = _core.Timeline()
        self.faults: list[HeaterFault] = []
        self.injector: FaultInjector | None = None  # only for simulated boards
        for connection in self.connections:
            connection.faults = self.faults

    def connect(self, *, adopt: bool = False) -> None:
        """Identifies and configures every board, and puts their clocks on one timeline. With
        `adopt`, boards keep their state if all of them have survived the loss of another host."""
        adopt = adopt and all(connection.can_be_adopted() for connection in self.connections)
        for connection in self.connections:
            connection.begin(adopt=adopt)
            _check_room(connection)
        if len(self.connections) > 1:
            for connection in self.connections:
                main = connection is self.main
                connection.join(self.timeline, main=main, tolerance_s=_TOLERANCE_S)
            self._settle_clocks()

    def _settle_clocks(self) -> None:
        begin, hz = self.now, self.board.clock_hz
        self.run(begin + int(SETTLING_S * hz))
        jitter_s = max(connection.link.clock_jitter_s for connection in self.connections)
        wanted_s = SETTLING_S + _SETTLING_PER_JITTER * jitter_s
        self.run(begin + int(min(wanted_s, _LONGEST_SETTLING_S) * hz))

    @property
    def now(self) -> int:
        """The clock of the main board."""
        return self.main.now

    @property
    def live(self) -> bool:
        """Whether real time passes at the boards, even if no caller waits."""
        return self.main.port.live

    @property
    def survives(self) -> bool:
        """Whether all boards can brake without the host when a link is lost."""
        return all(connection.survives for connection in self.connections)

    @property
    def move_count(self) -> int:
        """The number of moves that each board can hold."""
        return min(connection.move_count for connection in self.connections)

    @property
    def delivered(self) -> bool:
        """Whether the boards have acknowledged all messages of the job so far."""
        return all(connection.link.delivered for connection in self.connections)

    @property
    def unacknowledged_s(self) -> float:
        """The age of the oldest message that a board has not acknowledged, in seconds; the maximum
        of all boards, 0 if they have acknowledged all."""
        return max(c.link.unacknowledged_s(c.board_clock) for c in self.connections)

    def keep_frames(self) -> None:
        """Like `Connection.keep_frames`, on all boards."""
        for connection in self.connections:
            connection.keep_frames()

    def use_commits(self, horizon_s: float) -> None:
        """Like `Connection.use_commits`, on all boards."""
        for connection in self.connections:
            connection.use_commits(horizon_s)

    def arm(self, on: bool) -> None:
        """If `on`, the boards brake without the host when their link is lost. Axes can be homed
        only while this is off. Call it only at standstill, and only if all boards `survive`."""
        for connection in self.connections:
            connection.command("survive_arm" if on else "survive_home")
            connection.link.begin_commits(on)

    @property
    def heaters(self) -> dict[str, _core.Heater]:
        """The control loops of all heaters."""
        loops = {n: h for c in self.connections for n, h in c.heaters.items()}
        return {h.name: loops[h.name] for h in self.board.heaters if h.name in loops}

    @property
    def adopted(self) -> bool:
        """Whether the boards continue with the state that another host left."""
        return self.main.adopted

    def set_on_fault(self, on_fault: Callable[[str, HeaterFault], None] | None) -> None:
        """Sets the callback for each heater that fails; it may raise. None: the fault is raised."""
        for connection in self.connections:
            connection.on_fault = on_fault

    def start_job(self, job: _core.Job) -> int:
        """Sends the job's messages from now on. Returns the main board's clock at which the job's
        clock is 0."""
        hz = float(self.board.clock_hz)
        base = self.now + int(LEAD_S * hz)
        for i, connection in enumerate(self.connections):
            connection.start_job(job.messages_of(i), base, hz)
        return base

    def stop_job(self) -> None:
        """Stops sending the job's messages."""
        for connection in self.connections:
            connection.link.stop_job()

    def emergency_stop(self) -> None:
        """Queues the shutdown command for all boards; the links send it when time next passes."""
        for connection in self.connections:
            connection.command("emergency_stop")

    def run(self, until_clock: int) -> None:
        """Lets time pass until `until_clock`."""
        if len(self.connections) == 1:
            self.main.run(until_clock)
            return
        while True:
            look = self.now + int(_LOOK_S * self.board.clock_hz)
            self.main.pass_time(min(until_clock, look) if self.live else until_clock)
            self._look()
            if self.now >= until_clock:
                return

    def wait(self, until_clock: int) -> None:
        """Like `live_on`, but raises MachineError when a board has shut down."""
        self.live_on(until_clock)
        self._look_for_shutdown()

    def live_on(self, until_clock: int) -> None:
        """Lets time pass until `until_clock`, even if links are lost or boards are shut down."""
        if any(connection.link.shut_down for connection in self.connections):
            self.stand_by(until_clock)
        for connection in self.connections:
            main = connection is self.main
            with suppress(LinkLostError):
                connection.pass_time(until_clock if main else connection.now)
                connection.take_faults()

    def stand_by(self, until_clock: int) -> None:
        """Lets time pass at simulated boards until `until_clock` while boards are shut down:
        heaters cool down, but a heater that is stuck on does not, and the boards go on measuring.
        Links to real boards have their own threads."""
        if isinstance(self.main.wire, _core.Pump):
            self.main.wire.stand_by(until_clock)

    def _look(self) -> None:
        """Handles what all boards have reported."""
        for connection in self.connections:
            connection.pass_time(connection.now)
            connection.take_faults()
        self._look_for_shutdown()
        if any(connection.link.self_stopped for connection in self.connections):
            raise BoardAloneError.of("machine.alone")
        for connection in self.connections:
            if connection.link.lost:
                if self.timeline.halted:  # the others are being stopped
                    self.main.pass_time(self.now + int(_NEWS_S * self.board.clock_hz))
                raise connection.silence("get_clock")

    def _look_for_shutdown(self) -> None:
        stopped = [c for c in self.connections if c.link.shut_down]
        if not stopped:
            return
        # Report the board that failed first, not those that were stopped because of it.
        first = min(stopped, key=lambda c: c.link.stopped_with_others)
        if first.link.stopped_with_others:
            for connection in self.connections:
                if connection.link.restarted or connection.link.lost:
                    raise connection.silence("get_clock")
        raise first.shutdown_error()

    def connection_of(self, part: str, name: str) -> Connection:
        """The board that has a part, one of `steppers`, `outputs`, `sensors`, `heaters`,
        `endstops`. Raises KeyError if no board has it."""
        for connection in self.connections:
            if any(entry.name == name for entry in getattr(connection.board, part)):
                return connection
        raise KeyError(name)

    def reading(self, heater: str, now: int) -> Reading:
        """Like `Connection.reading`."""
        return self.connection_of("heaters", heater).reading(heater, now)

    def sensor(self, name: str, now: int) -> SensorReading:
        """Like `Connection.sensor`, or `Connection.i2c_sensor`. A sensor that its board cannot read
        has no reading."""
        with suppress(KeyError):
            return self.connection_of("sensors", name).sensor(name, now)
        with suppress(KeyError):
            return self.connection_of("i2c_sensors", name).i2c_sensor(name)
        return SensorReading(Reading(None))

    def work_i2c_sensors(self) -> None:
        """Like `Connection.work_i2c_sensors`, on all boards."""
        for connection in self.connections:
            connection.work_i2c_sensors()

    def set_target(self, heater: str, celsius: float) -> None:
        """Like `Connection.set_target`."""
        self.connection_of("heaters", heater).set_target(heater, celsius)

    def switch_heaters_off(self) -> None:
        """Turns every heater off. A heater that has failed is off already; its set-point stays
        readable. Call it only while no command can rearm a heater."""
        for connection in self.connections:
            for heater in connection.heaters.values():
                if heater.fault is None:
                    heater.target = 0.0

    def set_sensor(self, heater: str, sensor: Sensor) -> None:
        """Like `Connection.set_sensor`."""
        self.connection_of("heaters", heater).set_sensor(heater, sensor)

    def switch(self, output: str, on: bool) -> None:
        """Like `Connection.switch`."""
        self.connection_of("outputs", output).switch(output, on)

    def tone(self, output: str, hz: float, seconds: float, after_s: float) -> None:
        """Like `Connection.tone`."""
        self.connection_of("outputs", output).tone(output, hz, seconds, after_s)

    def pulse(self, output: str, width_s: float, seconds: float, after_s: float) -> None:
        """Like `Connection.pulse`."""
        self.connection_of("outputs", output).pulse(output, width_s, seconds, after_s)

    def full_scale(self, output: str) -> int:
        """Like `Connection.full_scale`."""
        return self.connection_of("outputs", output).full_scale(output)

    def input_changes(self) -> list[InputChange]:
        """Like `Connection.input_changes`, of all boards."""
        return [change for c in self.connections for change in c.input_changes()]

    def take_counts(self) -> None:
        """Like `Connection.take_counts`, on all boards."""
        for connection in self.connections:
            connection.take_counts()

    def count_rate(self, counter: str, lasts_s: float) -> float | None:
        """Like `Connection.count_rate`."""
        return self.connection_of("counters", counter).count_rate(counter, lasts_s)

    def show_light(self, light: str, frame: bytes) -> None:
        """Like `LightFrames.show`, on the board of a light."""
        self.connection_of("lights", light).lights.show(light, frame)

    def work_lights(self) -> list[str]:
        """Like `Connection.work_lights`, on all boards."""
        return [light for c in self.connections for light in c.work_lights()]

    def net_steps(self, stepper: str) -> int:
        """Like `Connection.net_steps`."""
        return self.connection_of("steppers", stepper).net_steps(stepper)

    def close(self) -> None:
        """Switches heaters and the laser off and releases all boards. Raises nothing."""
        for connection in self.connections:
            connection.close()


def _check_room(connection: Connection) -> None:
    """Raises MachineError if the plan needs more commands than the boards can hold: they would be
    late."""
    room = connection.move_count
    if room < connection.board.move_count:
        where = f" of board {connection.name}" if connection.name else ""
        value = f"it has room for {room} commands, so write move_count = {room}{where} there"
        raise MachineError.of("machine.dictionary", value=value)
