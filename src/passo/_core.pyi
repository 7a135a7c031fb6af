"""
Native core of Passo: parse, plan, solve step times, compress, frame, virtual board.
"""

from collections.abc import Callable, Mapping, Sequence
import enum
from typing import Any


class HeatModel:
    """
    A body and its sensor, each of first order; °C, s, and the share by which a fan at full speed raises the loss of heat.
    """

    def __init__(self, rise_c: float, time_constant_s: float, sensor_lag_s: float, fan_loss: float = 0.0, ambient_c: float = 25.0) -> None: ...

    @property
    def rise_c(self) -> float: ...

    @property
    def time_constant_s(self) -> float: ...

    @property
    def sensor_lag_s(self) -> float: ...

    @property
    def fan_loss(self) -> float: ...

    @property
    def ambient_c(self) -> float: ...

    def __eq__(self, arg: HeatModel, /) -> bool: ...

class PidControl:
    """
    Gains in 1/255 of full power by °C, by °C·s and by °C/s, as M301 has them; drive_min and drive_max, fractions of full power, bound the integral; farther than range_c from the target it is fully on or off.
    """

    def __init__(self, kp: float, ki: float, kd: float, filter_s: float = 1.0, drive_min: float = 0.0, drive_max: float = 1.0, range_c: float = 10.0) -> None: ...

    @property
    def kp(self) -> float: ...

    @property
    def ki(self) -> float: ...

    @property
    def kd(self) -> float: ...

    @property
    def filter_s(self) -> float: ...

    @property
    def drive_min(self) -> float: ...

    @property
    def drive_max(self) -> float: ...

    @property
    def range_c(self) -> float: ...

    def __eq__(self, arg: PidControl, /) -> bool: ...

class OnOffControl:
    """
    On below the target by the hysteresis, off above it by as much, and no two switchings within the interval.
    """

    def __init__(self, hysteresis_c: float = 1.0, interval_s: float = 0.0) -> None: ...

    @property
    def hysteresis_c(self) -> float: ...

    @property
    def interval_s(self) -> float: ...

    def __eq__(self, arg: OnOffControl, /) -> bool: ...

class ModelControl:
    """The power that by the model closes the gap within the horizon."""

    def __init__(self, model: HeatModel, horizon_s: float = 3.0) -> None: ...

    @property
    def model(self) -> HeatModel: ...

    @property
    def horizon_s(self) -> float: ...

    def __eq__(self, arg: ModelControl, /) -> bool: ...

class RelayControl:
    """Swings around the target between two powers, for autotuning."""

    def __init__(self, half_cycle_s: float = 5.0) -> None: ...

    @property
    def half_cycle_s(self) -> float: ...

    def __eq__(self, arg: RelayControl, /) -> bool: ...

class FaultKind(enum.Enum):
    NONE = 0

    SENSOR_OPEN = 1

    SENSOR_SHORT = 2

    SENSOR_ERRATIC = 3

    MIN_TEMPERATURE = 4

    MAX_TEMPERATURE = 5

    HEATING_FAILED = 6

    RUNAWAY = 7

    STUCK_ON = 8

    MODEL_DEVIATION = 9

class HeatFault:
    """
    What failed, what the sensor said, the limit that was broken (°C; of a model deviation a share of power), the board clock.
    """

    @property
    def kind(self) -> FaultKind: ...

    @property
    def celsius(self) -> float: ...

    @property
    def limit(self) -> float: ...

    @property
    def clock(self) -> int: ...

class ProtectionLimits:
    """
    What a heater must keep to; 0 switches a protection off, except for min_c and max_c.
    """

    def __init__(self, min_c: float = 5.0, max_c: float = 280.0, jump_c: float = 10.0, watch_rise_c: float = 2.0, watch_s: float = 20.0, runaway_c: float = 4.0, runaway_s: float = 40.0, stuck_on_c: float = 10.0, stuck_on_s: float = 60.0, deviation: float = 0.25, deviation_s: float = 30.0) -> None: ...

    @property
    def min_c(self) -> float: ...

    @property
    def max_c(self) -> float: ...

    @property
    def jump_c(self) -> float: ...

    @property
    def watch_rise_c(self) -> float: ...

    @property
    def watch_s(self) -> float: ...

    @property
    def runaway_c(self) -> float: ...

    @property
    def runaway_s(self) -> float: ...

    @property
    def stuck_on_c(self) -> float: ...

    @property
    def stuck_on_s(self) -> float: ...

    @property
    def deviation(self) -> float: ...

    @property
    def deviation_s(self) -> float: ...

    def __eq__(self, arg: ProtectionLimits, /) -> bool: ...

class HeatTerms:
    """
    Error (°C) and shares of full power; of a relay, p is the mean of its two powers and d how far it is above or below it.
    """

    def __init__(self, error: float = 0.0, p: float = 0.0, i: float = 0.0, d: float = 0.0, output: float = 0.0) -> None: ...

    @property
    def error(self) -> float: ...

    @property
    def p(self) -> float: ...

    @property
    def i(self) -> float: ...

    @property
    def d(self) -> float: ...

    @property
    def output(self) -> float: ...

class HeatSample:
    """One report of the sensor and the answer to it."""

    def __init__(self, clock: int, celsius: float, target: float, power: float, terms: HeatTerms) -> None: ...

    @property
    def clock(self) -> int: ...

    @property
    def celsius(self) -> float: ...

    @property
    def target(self) -> float: ...

    @property
    def power(self) -> float: ...

    @property
    def terms(self) -> HeatTerms: ...

class SensorQuery:
    """How the board samples a sensor; ticks and sums."""

    def __init__(self, sample_ticks: int, sample_count: int, rest_ticks: int, minimum: int, maximum: int, range_checks: int) -> None: ...

    @property
    def sample_ticks(self) -> int: ...

    @property
    def sample_count(self) -> int: ...

    @property
    def rest_ticks(self) -> int: ...

    @property
    def minimum(self) -> int: ...

    @property
    def maximum(self) -> int: ...

    @property
    def range_checks(self) -> int: ...

class Converter(enum.Enum):
    NONE = 0

    MAX31855 = 1

    MAX31856 = 2

    MAX31865 = 3

    MAX6675 = 4

class ConverterFault(enum.Enum):
    NONE = 0

    OPEN = 1

    SHORT_CIRCUIT = 2

    OUT_OF_RANGE = 3

    NO_ANSWER = 4

def read_converter(converter: Converter, word: int, faults: int = 0) -> tuple[float, ConverterFault]:
    """
    What a converter says: °C, or of a MAX31865 a share of its reference resistor; and what is wrong.
    """

def converter_full(converter: Converter) -> int:
    """Steps of full scale."""

def converter_share(converter: Converter, value: float) -> float:
    """The share of full scale of what read_converter() gives."""

def converter_words(converter: Converter, low: float, high: float) -> tuple[int, int]:
    """
    The least and the greatest word between two shares of full scale, from 0 on.
    """

class Arrival:
    """
    When a target is reached: within `window_c` for `seconds`, which begin anew beyond `leaves_c`.
    """

    def __init__(self, window_c: float = 1.0, leaves_c: float = 3.0, seconds: float = 10.0) -> None: ...

    @property
    def window_c(self) -> float: ...

    @property
    def leaves_c(self) -> float: ...

    @property
    def seconds(self) -> float: ...

class HeaterOptions:
    def __init__(self, sensor_oid: int, output_oid: int, pwm: bool, full: int, adc_full: int, query: SensorQuery, longest_s: float, max_power: float, arrival: Arrival, celsius: Sequence[tuple[float, float]], low_share: float, high_share: float, open_is_high: bool, control: PidControl | OnOffControl | ModelControl | RelayControl, limits: ProtectionLimits, model: HeatModel | None, fan_target: int = -1, fan_full: float = 1.0, inverted: bool = False, converter: Converter = Converter.NONE, spi_oid: int = 0, clears_faults: bytes = ...) -> None:
        """
        longest_s: how long the board leaves the power on without being told.
        fan_target: index of the fan's output among the link's pins.
        """

class Heater:
    """A heater loop beside the link."""

    @property
    def celsius(self) -> float: ...

    @property
    def heard(self) -> bool:
        """The sensor has reported, and the link has not been lost since."""

    @property
    def target(self) -> float: ...

    @target.setter
    def target(self, arg: float, /) -> None: ...

    @property
    def suspended(self) -> bool:
        """Nothing heats; the target is kept, and may change."""

    @suspended.setter
    def suspended(self, arg: bool, /) -> None: ...

    @property
    def power(self) -> float: ...

    @property
    def max_power(self) -> float: ...

    @property
    def reached(self) -> bool:
        """It has been at its target, since that was set."""

    @property
    def settled(self) -> bool:
        """It has been at its target for as long as who waits for it wants."""

    @property
    def arrival(self) -> Arrival: ...

    @property
    def terms(self) -> HeatTerms: ...

    @property
    def control(self) -> PidControl | OnOffControl | ModelControl | RelayControl: ...

    def set_control(self, control: PidControl | OnOffControl | ModelControl | RelayControl) -> None:
        """Takes over at once; a model also serves the protections."""

    @property
    def model(self) -> HeatModel | None: ...

    @property
    def limits(self) -> ProtectionLimits: ...

    @limits.setter
    def limits(self, arg: ProtectionLimits, /) -> None: ...

    @property
    def fan(self) -> float:
        """Speed of the fan that cools this heater, 0 to 1, for its model."""

    @fan.setter
    def fan(self, arg: float, /) -> None: ...

    @property
    def fault(self) -> HeatFault | None:
        """
        What is wrong; while it is not None the target is kept, but nothing heats.
        """

    def set_sensor(self, options: HeaterOptions) -> None:
        """
        Takes over table, broken ends and query of these options, from the next report on.
        """

    def asked_anew(self) -> None:
        """The board was asked for the sensor's reports anew, with its own range."""

    def rearm(self) -> None:
        """Ends the fault: the heater heats to the target that it kept."""

    def take_samples(self) -> list[HeatSample]:
        """
        The samples since the last call, at most the newest 4096, oldest first.
        """

class HeatRun:
    """
    A heater loop and the body that it heats, without a board: how long heating takes, as on a simulated printer.
    """

    def __init__(self, body: HeatModel, control: PidControl | OnOffControl | ModelControl | RelayControl, arrival: Arrival, max_power: float, limits: ProtectionLimits, model: HeatModel | None) -> None: ...

    def run(self, seconds: float) -> None:
        """Lets time pass."""

    def set_fan(self, speed: float) -> None:
        """The fan that cools the body blows so fast from now on, 0 to 1."""

    @property
    def heater(self) -> Heater: ...

def crc16(data: bytes) -> int:
    """CRC-16/MCRF4XX of the bytes."""

def encode_vlq(value: int) -> bytes:
    """Encodes a 32-bit value (modulo 2^32) in 1 to 5 bytes."""

def decode_vlq(data: bytes) -> tuple[int, int]:
    """Returns (signed value, bytes used). ValueError if cut short."""

def make_frame(payload: bytes, sequence: int) -> bytes: ...

def board_commands() -> list[tuple[int, str]]: ...

def board_reports() -> list[tuple[int, str]]: ...

def board_faults() -> list[str]:
    """Texts of the virtual board's shutdown reasons, by static_string_id."""

class FrameScanner:
    """Finds frames in bytes cut anywhere."""

    def __init__(self) -> None: ...

    def feed(self, data: bytes) -> list[tuple[int, bytes] | None]:
        """
        List of (sequence, payload) for each good frame and None for each stretch that is none.
        """

class Formats:
    """Messages of one direction, as a data dictionary declares them."""

    def __init__(self, formats: Sequence[tuple[int, str]]) -> None: ...

    def parameters(self, name: str) -> list[tuple[str, bool]]:
        """List of (parameter, is a blob). ValueError for an unknown message."""

    def names(self) -> list[str]: ...

    def encode(self, name: str, values: list[int | bytes]) -> bytes: ...

    def decode(self, payload: bytes) -> list[tuple[str, dict[str, int | bytes]]]:
        """
        List of (name, values) of a frame's payload. ValueError if it is malformed.
        """

class MessageKind(enum.Enum):
    QUEUE_STEP = 0

    SET_DIR = 1

    RESET_CLOCK = 2

    PIN = 3

    TAIL = 4

    COMMIT = 5

class MessageQueue:
    """Planned messages of one board, in the order in which they leave."""

    def __init__(self) -> None: ...

    def push(self, kind: MessageKind, target: int, clock: int, end_clock: int = 0, interval: int = 0, count: int = 0, add: int = 0, dir: bool = False) -> None: ...

    def clear(self) -> None: ...

    def __len__(self) -> int: ...

class PinKind(enum.Enum):
    DIGITAL = 0

    PWM = 1

class Cause(enum.Enum):
    """Why a frame was not at the board sooner."""

    PLAN = 0
    """Its moves were planned late."""

    STALL = 1
    """The program did not run."""

    BYTES = 2
    """The link carries no more bytes."""

    RETRANSMITS = 3
    """Bytes got lost."""

    SLOTS = 4
    """The board had no slot free."""

LATE_S: float = 0.06

class Slack:
    """
    Of a frame: ticks before the clock of its most urgent message at which the board had it, that clock, and what held it up for how long.
    """

    @property
    def known(self) -> bool: ...

    @property
    def slack(self) -> int: ...

    @property
    def clock(self) -> int: ...

    @property
    def held(self) -> int: ...

    @property
    def cause(self) -> Cause: ...

class Timeline:
    """What the links to the boards of one machine share."""

    def __init__(self) -> None: ...

    def arm(self, members: Sequence[tuple[int, int]], reason: int, expired: int, clock: float, patience: float) -> None:
        """
        These trsyncs, (seat of the link, oid), trigger together, for one of two reasons; and by themselves when one of them was not heard of for so many ticks.
        """

    def disarm(self) -> None: ...

    @property
    def halted(self) -> bool:
        """A board has stopped or is lost."""

class Link:
    """The host's end of a board's wire; times in ticks."""

    def __init__(self, clock_hz: float) -> None: ...

    @property
    def hz(self) -> float: ...

    def set_dictionary(self, commands: Sequence[tuple[int, str]], reports: Sequence[tuple[int, str]], receive_window: int) -> None: ...

    def send(self, name: str, values: list[int | bytes]) -> None: ...

    def take_responses(self) -> list[tuple[str, dict[str, int | bytes]]]: ...

    def follow_clock(self, now: int) -> None: ...

    def set_byte_ticks(self, ticks: float) -> None:
        """What a byte takes on a serial line."""

    @property
    def synchronous(self) -> bool: ...

    @property
    def lost(self) -> bool: ...

    @property
    def begun_anew(self) -> bool:
        """The board was reset, or its supply has failed."""

    def clock_at(self, host_ticks: int) -> int: ...

    def host_at(self, clock: int) -> int: ...

    @property
    def clock_rate(self) -> float: ...

    def add_stepper(self, target: int, name: str, oid: int, invert: bool) -> None: ...

    def join(self, timeline: Timeline, main: bool, tolerance: float = 0.0) -> None:
        """
        The board is one of several: the main one, or one whose steps are told in its own clock, within so many ticks.
        """

    @property
    def seat(self) -> int:
        """Its number among the links of the machine."""

    def own_clock(self, main_clock: int) -> int:
        """What this board's clock reads when the main one's reads so much."""

    def main_clock(self, own_clock: int) -> int: ...

    def set_apart(self, target: int, least: float, turning: float) -> None:
        """
        How close steps of a motor may come, in ticks, one way and where it turns.
        """

    def add_pin(self, target: int, name: str, oid: int, kind: PinKind, inverted_full: int = 0, longest: int = 0) -> None:
        """
        inverted_full: the value at full scale of a pin that is on when low; longest: ticks that the board lets it be on without a word.
        """

    def set_kick(self, target: int, ticks: int, full: int, rise: int) -> None:
        """
        Where the value of a pin comes from 0, or rises by more than so much, it is `full` for so many ticks first.
        """

    def set_slots(self, slots: int) -> None: ...

    def set_queue(self, queue: MessageQueue | None) -> None: ...

    def start_job(self, base_clock: int, main_hz: float) -> None:
        """Both are the main board's."""

    @property
    def clock_jitter_s(self) -> float:
        """What answers usually take longer than the quickest ones, seconds."""

    def use_commits(self, horizon: int) -> None:
        """The job comes in commits, and leaves so many ticks ahead."""

    def begin_commits(self, on: bool) -> None:
        """
        The machine stands, and what moves it comes in commits from here on, for the board is armed; or it does no more.
        """

    def reconnect(self) -> None:
        """
        The board has gone on without this host: what was on its way is forgotten, and the job stands until go_on().
        """

    @property
    def told(self) -> bool:
        """The board has all commands; answers at once have come, or are lost."""

    def unheard_s(self, clock: int) -> float:
        """
        Seconds since the first of what the board has not acknowledged was sent, when its clock reads `clock`; 0 if it has acknowledged all.
        """

    @property
    def delivered(self) -> bool:
        """Everything of the job so far is at the board."""

    def go_on(self) -> None: ...

    def stop_job(self) -> None: ...

    def add_heater(self, options: HeaterOptions) -> Heater: ...

    @property
    def shut_down(self) -> bool: ...

    @property
    def alone(self) -> bool:
        """The board has stopped by itself."""

    @property
    def stopped_with_others(self) -> bool:
        """The board was shut down because another one of the machine had failed."""

    @property
    def shutdown_reason(self) -> int: ...

    def restart(self) -> None:
        """
        The board begins anew: what was on its way is forgotten, its numbering is learnt again.
        """

    @property
    def wire_bytes(self) -> int: ...

    @property
    def frames(self) -> int: ...

    @property
    def retransmitted_bytes(self) -> int: ...

    def take_slack(self) -> Slack:
        """The least since this was last asked."""

    @property
    def min_slack(self) -> Slack: ...

    @property
    def late_frames(self) -> dict[Cause, int]:
        """
        How many frames were at the board less than LATE_S before it needed them, by cause.
        """

    @property
    def longest_stall(self) -> int:
        """The most that it was looked after too late, ticks."""

    @property
    def queue_steps(self) -> int: ...

    @property
    def messages(self) -> int: ...

    @property
    def stream_hash(self) -> int: ...

    def keep_record(self, bytes: int, parts: int) -> None:
        """Keeps the last bytes of both directions from now on; powers of two."""

    def recorded(self, since: int) -> list[tuple[int, int, bool, bytes]]:
        """
        What was sent and received since that host time, oldest first: host time, the board's clock (0 while it is not known), whether it came from the board, and its bytes.
        """

    def feed(self, data: bytes, now: int) -> None: ...

    def poll(self, now: int) -> tuple[bytes, int]:
        """(bytes to send, host time of the next call)"""

class Device:
    """The far end of a link, in virtual time."""

    def feed(self, data: bytes, now: int) -> None: ...

    def poll(self, now: int) -> bytes: ...

    @property
    def next_deadline(self) -> int: ...

    @property
    def stopped(self) -> bool: ...

class Bed:
    """A simulated bed that is not flat; lengths in mm."""

    def __init__(self, center: Sequence[float], size: Sequence[float], tilt: Sequence[float], dome: float, wave: float, wave_length: Sequence[float], lift: float) -> None:
        """Raises ValueError for a size or a wave length of 0."""

    def height(self, x: float, y: float) -> float:
        """Height over a place."""

class ProbeMechanism:
    """How a simulated probe gets to the bed."""

    @staticmethod
    def fixed() -> ProbeMechanism:
        """To the head."""

    @staticmethod
    def servo(control_pin: int, deploy_us: float, stow_us: float, stowed_reads: bool) -> ProbeMechanism:
        """Turned down by the pulses of a servo."""

    @staticmethod
    def bltouch(control_pin: int) -> ProbeMechanism:
        """A pin that a BLTouch puts out."""

    @staticmethod
    def dock(dock: Sequence[float], leave: Sequence[float]) -> ProbeMechanism:
        """Coupled with the nozzle at `dock`; on the way to `leave` it stays."""

    @property
    def jammed(self) -> bool:
        """A fault: it never gets into place."""

    @jammed.setter
    def jammed(self, arg: bool, /) -> None: ...

class Bench(Device):
    """A simulated board with the plant around it; pins by number."""

    def add_actuator(self, step_pin: int, start: float, per_step: float) -> None: ...

    def add_switch(self, pin: int, weights: Sequence[tuple[int, float]], position: float, at_maximum: bool, pressed_level: bool) -> None:
        """
        Pressed at or beyond `position` of the weighted sum of actuators: (step pin, weight).
        """

    def add_probe(self, pin: int, motors: Sequence[int], geometry: dict[str, Any], bed: Bed, offset: Sequence[float], trigger: float, pressed_level: bool, hysteresis: float, sigma: float, seed: int, dead: Sequence[Sequence[float]], touchy: Sequence[Sequence[float]], mechanism: ProbeMechanism) -> None:
        """
        A probe on the head, and the bed below; `motors` are the step pins of the actuators.
        """

    def carry_probe(self, pin: int, lifts: Sequence[tuple[int, Sequence[float]]]) -> None:
        """
        Several motors carry the gantry of a probe: the step pin of each, and c of its weight c · (1, x, y, x y) at X, Y of the nozzle.
        """

    def change_probe(self, pin: int, dead: Sequence[Sequence[float]], touchy: Sequence[Sequence[float]], sigma: float, jammed: bool) -> None:
        """Faults of a probe from now on."""

    def change_bed(self, pin: int, bed: Bed) -> None:
        """The bed below a probe from now on."""

    def feel(self, step_pin: int, board: Bench, its_step_pin: int) -> None:
        """
        A motor on another board, as the switches of this one feel it while that board lives.
        """

    def place(self, step_pin: int, position: float) -> None:
        """Somebody moves the motor's actuator by hand."""

    def force_switch(self, pin: int, pressed: int) -> None:
        """A fault: never pressed (0), always (1); -1 ends it."""

    def add_body(self, heater_pin: int, sensor_pin: int, ambient_c: float, rise_c: float, time_constant_s: float, sensor_time_constant_s: float, adc_ratio: Sequence[tuple[float, float]], fan_pin: int = 0, fan_loss: float = 0.0) -> None: ...

    def invert_output(self, pin: int) -> None:
        """What hangs on this output pin is on when the pin is low."""

    def force_adc(self, sensor_pin: int, ratio: float) -> None:
        """A fault: the ADC sees this share of full scale; negative ends it."""

    def force_heater(self, sensor_pin: int, duty: float) -> None:
        """A fault: the heater does this whatever its pin says; negative ends it."""

    def add_noise(self, sensor_pin: int, share: float) -> None:
        """A fault: the ADC errs by up to this share of full scale."""

    def drop_sensor(self, sensor_pin: int, fallen: bool) -> None:
        """A fault: the sensor feels the room instead of its body."""

    def temperature(self, sensor_pin: int) -> float: ...

    def net_steps(self, step_pin: int) -> int: ...

    def steps(self, step_pin: int) -> int: ...

    def position(self, step_pin: int) -> float: ...

    def trace_steps(self, step_pin: int, from_clock: int, to_clock: int) -> None: ...

    def take_steps(self, step_pin: int) -> bytes:
        """
        Traced steps done so far, as int64 rows (start, interval, count, add, direction).
        """

    def output_value(self, pin: int) -> int: ...

    def trace_output(self, pin: int) -> None: ...

    def take_changes(self, pin: int) -> list[tuple[int, int]]:
        """List of (clock, value) since the last call."""

    @property
    def fault(self) -> str:
        """Why it is shut down, or an empty string."""

    @property
    def frames(self) -> int: ...

    @property
    def naks(self) -> int: ...

    @property
    def now(self) -> int: ...

class VirtualBoard(Bench):
    """A complete board in virtual time; pins by number."""

    def __init__(self, clock_hz: float, move_count: int, adc_max: int, pwm_max: int, identify: bytes, start: int = 0) -> None: ...

    @property
    def peak_slots(self) -> int: ...

class FirmwareBoard(Bench):
    """A board run by the firmware itself, in virtual time."""

    def __init__(self, library: str, clock_hz: int, move_count: int, adc_max: int, identify: bytes, start: int, faults: Mapping[int, str]) -> None: ...

    def add_motor(self, step_pin: int, dir_pin: int, step_inverted: bool) -> None:
        """A motor driver on these pins; to be told before the board moves it."""

    def trace_edges(self, pin: int) -> None: ...

    def take_edges(self, pin: int) -> list[tuple[int, int]]:
        """List of (clock, level) since the last call."""

class Distant(Device):
    """
    A device with a clock and a cable that are not perfect: its clock begins at `start` and is a share of `drift` faster than host time; bytes travel `latency` to `latency` + `jitter` ticks each way.
    """

    def __init__(self, device: Device, start: int = 0, drift: float = 0.0, latency: int = 0, jitter: int = 0, seed: int = 1) -> None: ...

    @property
    def now(self) -> int:
        """Host time."""

    def cut(self, on: bool) -> None:
        """What is sent either way is lost."""

    def spoil(self, share: float, frames: float = 0.0) -> None:
        """
        So many of all bytes, either way, arrive as others, not at all, twice, or elsewhere; and so many of all frames not at all, twice, behind the next one, or late.
        """

    @property
    def spoilt_frames(self) -> list[int]:
        """
        How many frames were lost, doubled, swapped with the next, and late so far.
        """

    def clock_at(self, host_ticks: int) -> int: ...

    def host_at(self, clock: int) -> int: ...

def firmware_dictionary(library: str) -> bytes:
    """The dictionary that was built into a firmware library, compressed."""

def expand_steps(rows: bytes, from_clock: int, to_clock: int) -> bytes:
    """int64 clocks of all steps of take_steps() within from…to."""

def expand_directions(rows: bytes, from_clock: int, to_clock: int, sign: int) -> bytes:
    """int8 directions of the steps of expand_steps(), times sign (+1 or -1)."""

class NozzleGap:
    """
    How far the nozzle is above the simulated bed while a job extrudes in its first layer, from executed steps; mm.
    """

    def __init__(self, clock_hz: float, geometry: dict, bed: Bed, motors: Sequence[tuple[Bench, int, float, float, float]], lifts: Sequence[tuple[int, Sequence[float]]]) -> None:
        """
        `motors`, first one for each actuator of the geometry: the board, the step pin, the mm or degrees of a step, the main board's ticks in one of the board's, and the main board's clock when the board's reads 0. `lifts`: the number of each motor that carries the gantry, and its weight as for carry_probe. Keeps the steps of these motors until the layer is over.
        """

    def begin(self, job: Job, base: float) -> None:
        """The job begins at this clock of the main board."""

    def place(self, ticks: float, positions: Sequence[float]) -> None:
        """
        From this clock of the job on, at which they stand, the motors are at these positions.
        """

    def follow(self, job: Job) -> bool:
        """Looks at what the boards have executed; False once the layer is over."""

    def end(self, job: Job) -> None:
        """Keeps no more steps."""

    @property
    def looks(self) -> int: ...

    @property
    def mean(self) -> float: ...

    @property
    def lowest(self) -> tuple[float, float, float]:
        """The smallest distance, and X and Y there."""

    @property
    def highest(self) -> tuple[float, float, float]:
        """The largest distance, and X and Y there."""

    @property
    def cells(self) -> list[tuple[float, int]]:
        """
        The mean distance and the number of looks in each cell of the bed, in rows from the front.
        """

GAP_CELLS: int = 24

class Stop(enum.Enum):
    """Why time stopped passing."""

    TIME = 0

    SHUTDOWN = 1

    HEATERS = 2

    FAULT = 3

    CLOSED = 4

class Pump:
    """Runs a link and a device in virtual time."""

    def __init__(self, link: Link, device: Device, start: int = 0) -> None: ...

    def attach(self, link: Link, device: Device) -> None:
        """A further device, or another link to one that is here."""

    @property
    def now(self) -> int: ...

    @property
    def hz(self) -> float:
        """Ticks of its time in a second."""

    def board_clock(self, link: Link) -> int:
        """What the clock of this link's board reads, as far as it is known."""

    def sleep(self, until: int) -> None:
        """The host does nothing until then; boards live on."""

    def cut(self) -> None:
        """Takes the cable away."""

    @property
    def device_share(self) -> float:
        """The part of its processor time that the devices take, from a sample."""

    def record(self, on: bool) -> None: ...

    def take_recorded(self) -> bytes: ...

    def run(self, until: int, until_heaters: bool = False) -> Stop: ...

class LiveWire:
    """
    Drives a link over a file descriptor, which it owns, in real time and a thread of its own.
    """

    def __init__(self, link: Link, fd: int) -> None: ...

    @property
    def now(self) -> int: ...

    @property
    def failure(self) -> str:
        """What ended the connection, if it was not the cable."""

    @property
    def hz(self) -> float:
        """Ticks of its time in a second."""

    def board_clock(self, link: Link) -> int:
        """What the board's clock reads, as far as it is known."""

    def use_board_clock(self) -> None:
        """Once the link is synchronous: `now` is the board's clock from here on."""

    def join(self, timeline: Timeline) -> None:
        """The link looks up whenever others of its machine have news for it."""

    def stop(self) -> None:
        """No byte moves any more."""

    def run(self, until: int, until_heaters: bool = False) -> Stop: ...

class LiveBoard:
    """
    Lets a device answer on a file descriptor, which it owns, in real time and a thread of its own; look at the device in `look`, or after `stop`.
    """

    def __init__(self, device: Device, fd: int, clock_hz: float, start: int = 0) -> None: ...

    def look(self, at: Callable) -> object:
        """What the function returns, which may use the device."""

    def stop(self) -> None: ...

class TrinamicKind(enum.Enum):
    TMC2208 = 0

    TMC2209 = 1

    TMC2130 = 2

    TMC5160 = 3

class TrinamicChip:
    """A simulated motor driver with registers."""

    def __init__(self, kind: TrinamicKind, address: int = 0) -> None: ...

    def read(self, register: int) -> int: ...

    def set(self, register: int, value: int) -> None:
        """What the chip itself finds out."""

    def power_on(self) -> None:
        """Its supply was gone: it forgets its settings."""

    @property
    def plugged(self) -> bool: ...

    @plugged.setter
    def plugged(self, arg: bool, /) -> None: ...

    @property
    def damaged_answers(self) -> int:
        """So many of its next answers have a bit turned over."""

    @damaged_answers.setter
    def damaged_answers(self, arg: int, /) -> None: ...

def add_uart_driver(bench: Bench, rx_pin: int, tx_pin: int, chip: TrinamicChip) -> None:
    """Wires a driver to the UART on these pins, which may have others."""

def add_spi_driver(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int, chip: TrinamicChip) -> None:
    """Wires a driver to the SPI bus on these pins."""

class Digipot:
    """A simulated setter of motors' currents."""

    def wiper(self, channel: int) -> int:
        """0 to 255."""

def add_digipot(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int) -> Digipot:
    """Wires a setter of currents to the SPI bus on these pins."""

class ConverterChip:
    """A simulated converter of a sensor."""

    def setting(self, address: int) -> int:
        """
        What it was told: of a MAX31856 its modes (0) and its thermocouple (1), of a MAX31865 its modes (0).
        """

def add_converter(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int, converter: Converter) -> ConverterChip:
    """
    Wires a converter to the SPI bus on these pins; its thermocouple belongs to the body whose sensor is on the select pin.
    """

def sincos(x: float) -> tuple[float, float]: ...

def atan2(y: float, x: float) -> float: ...

class Geometry:
    """A geometry kernel: Cartesian mm to actuator mm or degrees, and back."""

    def __init__(self, spec: dict) -> None: ...

    @property
    def actuators(self) -> int: ...

    def inverse(self, actuator: int, point: tuple[float, float, float]) -> float:
        """Position of an actuator; NaN where it cannot reach."""

    def forward(self, positions: tuple[float, float, float]) -> tuple[float, float, float]:
        """Nozzle position. Raises ValueError where there is none."""

    def linear(self, actuator: int) -> tuple[float, float, float] | None:
        """
        How far an actuator goes for each mm of X, Y and Z; None if that differs.
        """

    def slopes(self, actuator: int, start: tuple[float, float, float], end: tuple[float, float, float], s: float) -> tuple[float, float]:
        """First and second derivative by path length at s mm."""

    def crossings(self, actuator: int, start: tuple[float, float, float], end: tuple[float, float, float], steps_per_unit: float) -> tuple[list[float], list[int]]:
        """
        Path positions and directions of all steps of a nonlinear actuator along a line.
        """

class Move:
    """
    A planned move: a line with a trapezoid of speed. Speeds are of the path measure.
    """

    @property
    def start_mm(self) -> tuple[float, float, float, float, float, float, float, float]:
        """X, Y, Z, E and further axes"""

    @property
    def end_mm(self) -> tuple[float, float, float, float, float, float, float, float]: ...

    @property
    def length(self) -> float:
        """path measure, usually mm"""

    @property
    def start_speed(self) -> float: ...

    @property
    def cruise_speed(self) -> float: ...

    @property
    def end_speed(self) -> float: ...

    @property
    def acceleration(self) -> float:
        """of the first phase, signed"""

    @property
    def deceleration(self) -> float:
        """of the last phase, positive"""

    @property
    def speed_cap(self) -> float: ...

    @property
    def advance_s(self) -> float:
        """pressure advance of its filament"""

    @property
    def advance_binds(self) -> bool:
        """
        The speed at its start is bound by what the advance asks of the extruder.
        """

    @property
    def start_cap(self) -> float:
        """junction's speed limit"""

    @property
    def accelerate_length(self) -> float: ...

    @property
    def cruise_length(self) -> float: ...

    @property
    def start_ticks(self) -> float: ...

    @property
    def accelerate_ticks(self) -> float: ...

    @property
    def cruise_ticks(self) -> float: ...

    @property
    def decelerate_ticks(self) -> float: ...

    @property
    def end_ticks(self) -> float: ...

    @property
    def line(self) -> int: ...

    @property
    def layer(self) -> int: ...

    @property
    def feature(self) -> int: ...

    @property
    def extruder(self) -> int: ...

    @property
    def inner(self) -> bool:
        """continues the path of the move before it"""

    @property
    def tolerance_ticks(self) -> float:
        """by which its steps may miss their ideal times; 0: the board's own"""

    @property
    def speed_limit(self) -> int:
        """index in the names of limits"""

    @property
    def accel_limit(self) -> int: ...

    @property
    def kind(self) -> str: ...

class Motion:
    """Plans moves, solves and compresses their steps. Not thread-safe."""

    def __init__(self, spec: dict, with_steps: bool = True) -> None: ...

    def push(self, target: Sequence[float], feed_mm_s: float, kind: str = 'travel', extruder: int = 0, duration_s: float = 0.0, radius_mm: float = float('inf'), inner: bool = False, line: int = 0, flow: float = 1.0) -> None:
        """
        Adds a move to the absolute target: one number an axis, then E, which was scaled with `flow` (0: by none, and never). Raises ValueError.
        """

    def set_height_map(self, first: tuple[float, float], spacing: tuple[float, float], heights: Sequence[Sequence[float]], fade: tuple[float, float, float] | None = None) -> None:
        """
        What the bed adds to Z: heights in mm on an even grid, rows along X, the first one at the Y of `first`; bilinear in between, level beyond. With a `fade` of start, end and target, mm: in full up to the start in Z, then evenly less, until the target alone is added from the end on. No rows: the bed is flat. No motor moves, but Z of the plan changes; only while nothing is queued. Raises ValueError.
        """

    def add_pieces(self, pieces: Sequence[tuple[float, Sequence[Sequence[float]]]], end: Sequence[float] | None = None, extruder: int = 0) -> None:
        """
        Motion that is planned already, behind what was pushed so far: of each piece its seconds, and for each axis, then E, up to six coefficients of a polynomial of time: mm, mm/s, mm/s^2 and so on. Pieces join to 1e-6 mm; `end` says where the last one ends if not where its polynomials do. Raises ValueError.
        """

    def record(self, target: int, value: int) -> None:
        """A timed record, due when the moves pushed so far are done."""

    def set_position(self, position: Sequence[float]) -> None:
        """
        Sets where the machine is, without motion; only while nothing is queued.
        """

    def flush(self) -> None:
        """Settles all for a stop at the end."""

    def wait_until(self, ticks: float) -> None: ...

    def replan_from(self, ticks: float) -> float:
        """
        Plans anew from this clock on with the limits of now; returns the clock of the cut.
        """

    def shift_from(self, ticks: float, axis: int, mm: float) -> float:
        """
        From this clock on all lies so much further; returns the clock of the cut.
        """

    def change_flow_from(self, ticks: float, flow: float, extruder: int = 0) -> float:
        """
        From behind this clock on filament moves with this flow; returns the clock of the cut.
        """

    def skip_dwell_from(self, ticks: float) -> float | None:
        """
        Ends the dwell that is under way at this clock; returns the clock of the cut, or None.
        """

    def hold_from(self, ticks: float) -> float:
        """
        Brakes to a stop on the path from this clock on; returns the clock of the cut.
        """

    def release(self) -> None:
        """Goes on with what hold_from left."""

    def use_commits(self, period: int, most: int) -> None:
        """
        Messages come in commits of at most so many ticks and messages from now on; only behind flush().
        """

    def set_speed_factor(self, factor: float, live: bool = True) -> None:
        """M220: of moves to come, or, `live`, of all that is replanned."""

    def set_accel(self, accel: float, live: bool = True) -> None: ...

    def set_advance(self, extruder: int, seconds: float) -> None:
        """Pressure advance of moves to come."""

    @property
    def clock(self) -> float:
        """End of the last settled move, ticks."""

    def take_moves(self) -> list[Move]:
        """Moves settled since the last call, in order."""

    def take_messages(self, before: float = float('inf')) -> list[tuple[str, int, int, int, int, int, int, int]]:
        """
        Takes (kind, target, clock, end_clock, interval, count, add, dir) of all messages due before a clock.
        """

    def counts(self) -> list[int]:
        """Step count of every motor after all that was solved."""

    def dropped_pairs(self, arg: int, /) -> int: ...

    def ideal_ticks(self, move: Move, stepper: int, count: int) -> tuple[list[float], int]:
        """Unrounded step times of one motor in one move, and its count after it."""

    def ideal_piece_ticks(self, seconds: float, coefficients: Sequence[Sequence[float]], stepper: int, count: int, extruder: int = 0) -> tuple[list[float], int]:
        """The same for one piece that starts at tick 0."""

class Fault(enum.Enum):
    NUMBER = 0

    RANGE = 1

    WORD = 2

    CHECKSUM = 4

    LINE_TOO_LONG = 5

    FEEDRATE = 6

    ARC = 7

    CENTRE = 8

    RADII = 9

    REPEATED = 3

    OUT_OF_RANGE = 10

    MISSING_TOOL = 11

    NOT_HOMED = 12

    COLD = 13

    GARBAGE = 14

    UNSAVED = 15

    UNREACHABLE = 16

    ACTUATOR = 17

    TOO_LONG = 18

    TOO_SLOW = 19

    STRAY = 20

    UTF_16 = 21

    HOLE = 22

    AFTER_END = 23

    MISSING_WORD = 24

    CALL = 25

class CallFault(enum.IntEnum):
    """Why M98 or M99 cannot be carried out."""

    UNREADABLE = 1

    MISSING = 2

    NESTED = 3

    UNENDED = 4

    IDLE = 5

    NO_FILE = 6

def without_exponents(text: str) -> str:
    """
    A line's command with decimal numbers in place of those with exponents, as a job reads it on a machine that has an E.
    """

def split_text(text: str) -> list[tuple[str, float | None, str | None]]:
    """
    The words of a command's text, in order: the letter in upper case, or another character that begins no word; its number, not a number for `nan`, or None; the number as it is written, or what stands in quotes. Comments in parentheses are left out.
    """

def find_stray(text: str, any: bool) -> tuple[str, int]:
    """
    The first character of a command's text that is not G-code: what stands around it, and its code (0: none; below 0: a byte that is not UTF-8). Not `any`: only one that changes what the text means.
    """

class ObjectAction(enum.Enum):
    """What a command says about the objects of a print."""

    COUNT = 0
    """There are so many."""

    DEFINE = 1
    """One of this name."""

    BEGIN = 2
    """What follows belongs to this one."""

    NAME = 3
    """Of the one that has begun."""

    END = 4
    """What follows belongs to none."""

    CANCEL = 5
    """This one, by number or name."""

    CANCEL_CURRENT = 6
    """The one that is printed."""

    RESTORE = 7
    """This one, by number or name."""

    RESTORE_ALL = 8

def object_orders(code: str, text: str) -> list[tuple[ObjectAction, int, str]]:
    """
    (action, number, name) of M486 or EXCLUDE_OBJECT…, by what follows the code. The number is -1 where the object is meant by its name. What cannot be read is left out.
    """

class Survey:
    """The commands of a program, found before it runs."""

    def __init__(self, spec: dict) -> None: ...

    def feed(self, data: bytes) -> None: ...

    def finish(self) -> None:
        """No more input will come."""

    @property
    def commands(self) -> list[tuple[int, str, int, int, str, str]]:
        """
        (line, letter, number, minor, name, text) of each command that is no move, once for each code.
        """

    @property
    def bad_calls(self) -> list[tuple[int, str, CallFault]]:
        """
        (line, text, fault) of each M98 that cannot be carried out, once it is finished.
        """

    @property
    def moves(self) -> bool:
        """The program moves the machine."""

LOAD_MM_S: float = 6.0

UNLOAD_MM_S: float = 20.0

LONGEST_CHANGE_MM: float = 5000.0

class JobStatus(enum.Enum):
    NEED_INPUT = 0

    EVENT = 1

    MACRO = 2

    ERROR = 3

    FULL = 4

    END = 5

class Within(enum.Enum):
    """What a move outside of any program must keep to."""

    LIMITS = 0
    """The machine's limits."""

    REACH = 1
    """What its actuators reach: it has been there."""

    ANYTHING = 2
    """Nothing: it does not know where it is."""

class Job:
    """A G-code program through one machine. Not thread-safe."""

    def __init__(self, spec: dict, with_steps: bool = True, clamp: bool = False, ignore_tools: bool = False) -> None: ...

    def advance(self, horizon: float = float('inf'), most: int = 1048576, to_boundary: bool = False) -> JobStatus:
        """
        Reads on until something wants the caller, or the plan reaches a clock or a number of messages; or no further than to the end of the line that it is in.
        """

    def adopt(self, other: Job) -> None:
        """
        Takes the state of a program that another job has read up to the position of this machine.
        """

    @property
    def messages(self) -> MessageQueue:
        """The main board's."""

    def messages_of(self, board: int) -> MessageQueue: ...

    def feed(self, data: bytes) -> None: ...

    def finish(self) -> None:
        """No more input will come."""

    def select(self, console: bool) -> None:
        """
        Reads on from the console's lines, or the program's; only at a boundary.
        """

    @property
    def at_boundary(self) -> bool:
        """No line is under way."""

    def restart(self, first_line: int = 1) -> None:
        """
        Forgets the unread text of the selected source; its lines count from this one again.
        """

    def abandon(self) -> None:
        """
        After an error: drops the rest of the line and continues at the end of the plan.
        """

    @property
    def offset(self) -> int:
        """Bytes of the selected source that were read."""

    @property
    def program_position(self) -> list[float]:
        """Where the program is, in its own coordinates: the axes, then E."""

    @property
    def event(self) -> tuple[int, str, int, int, str, str]:
        """
        (line, letter, number, minor, name, text) of the event or the macro that advance stopped at.
        """

    def insert(self, text: bytes) -> None:
        """
        After MACRO: the lines that the call becomes. They are read next, with the line number of the call, and then the rest of its line.
        """

    @property
    def macro_depth(self) -> int:
        """
        How many macros of the selected source are under way within each other.
        """

    @property
    def modal(self) -> tuple[bool, bool, float]:
        """
        (G90, M82, feedrate in mm/s): the modal state of what is read; the feedrate is infinite while none was given.
        """

    @property
    def plain(self) -> bool:
        """No macro is called: the commands that they replace are carried out."""

    @plain.setter
    def plain(self, arg: bool, /) -> None: ...

    def forget_macros(self) -> None:
        """What is left of a console's macros is not carried out."""

    def listen(self, line: int) -> None:
        """
        Before this line of the program is read: notes its commands, see heard.
        """

    @property
    def heard(self) -> tuple[str, bool, list[tuple[str, list[str], str]]]:
        """
        (number, whether it had a checksum, [(code, words, text), …]) of the line listened to. The code is empty for a move in the way of the last one, the text is what follows the code.
        """

    @property
    def ends_in_move(self) -> bool:
        """All was read, and the last line is a move without an end of line."""

    @property
    def error(self) -> tuple[int, Fault, str, float, float, tuple[float, float, float]]:
        """
        (line, fault, word, value, limit, point) of the error that advance stopped at.
        """

    @property
    def clamped(self) -> list[tuple[tuple[int, Fault, str, float, float, tuple[float, float, float]], int]]:
        """
        What `clamp` has changed: for each axis the first target that was moved to the limit, as `error`, and how many were; then the same of the moves that were left out.
        """

    def use_survey(self, survey: Survey) -> None:
        """
        Of the program that it reads next: its sub-programs, its objects, and the comments that mark layers.
        """

    @property
    def calls(self) -> bool:
        """The program has sub-programs."""

    @property
    def ignore_calls(self) -> bool:
        """M98 of a sub-program that is missing is an event, not an error."""

    @ignore_calls.setter
    def ignore_calls(self, arg: bool, /) -> None: ...

    @property
    def commands(self) -> int:
        """How many were read, unknown ones too."""

    @property
    def line(self) -> int: ...

    @property
    def layer(self) -> int: ...

    @property
    def tool(self) -> int: ...

    @property
    def feature_names(self) -> list[str]: ...

    @property
    def objects(self) -> list[tuple[str, bool, str, str]]:
        """
        (name, cancelled, centre, outline) of each object of the program, by number; centre and outline as they are written, or empty.
        """

    @property
    def objects_version(self) -> int:
        """Another value after each change of `objects`, and for each program."""

    def watch_height(self, low_mm: float, high_mm: float) -> None:
        """
        Before a move that prints below or above these heights, `advance` stops once at an event TUNING_TOWER with the height as its word Z. Infinite: there is none.
        """

    def object_of_line(self, line: int) -> int:
        """
        The object that a line of the main program belongs to, of those read lately; -1: none.
        """

    def find_objects(self, name: str) -> list[int]:
        """Numbers of the objects of this name, in any case."""

    def cancel_object(self, number: int, cancelled: bool = True) -> None:
        """
        Moves of the object that are read from now on are left out, or are not left out.
        """

    @property
    def queued(self) -> int:
        """Moves that are not settled."""

    @property
    def queued_ticks(self) -> float:
        """Ticks that these moves take at least."""

    def record(self, target: int, value: int) -> None:
        """
        A timed record for output `target`, due between the moves before and after.
        """

    def record_at(self, ticks: float, target: int, value: int) -> None:
        """
        A record for output `target` at this clock, whatever moves are planned; it cannot be revoked.
        """

    def mark(self, target: int, value: int) -> None:
        """A timed record for the host itself, see next_mark."""

    @property
    def next_mark(self) -> tuple[int, int, int] | None:
        """
        (clock, target, value) of the earliest mark whose clock is known by now; None without one. A mark after a cut of the plan gets another clock.
        """

    def pop_mark(self) -> None:
        """Removes the next mark, if there is one: the host carries it out."""

    def set_laser(self, target: int, full: int) -> None:
        """This output is a laser, fully on at `full`."""

    def follow_speed(self, share: float) -> None:
        """
        The laser's share of full power, at the feed rate of the moves that follow; it is less where they are slower, and none while nothing moves. 0: records alone set it.
        """

    def flush(self) -> None:
        """Settles all for a stop."""

    def wait_until(self, ticks: float) -> None:
        """The machine is idle until then; only after flush."""

    def replan_from(self, ticks: float) -> float: ...

    def skip_dwell_from(self, ticks: float) -> float | None:
        """
        Ends the dwell that is under way at this clock; returns the clock of the cut, None if there is no dwell.
        """

    def hold_from(self, ticks: float) -> float: ...

    def use_commits(self, period: int, most: int) -> None:
        """
        Messages come in commits of at most so many ticks and messages from now on; only while the machine is idle.
        """

    def stop_commits(self) -> None:
        """Messages come as they are; only at standstill."""

    def recover_from(self, serial: int) -> float | None:
        """
        The boards have stopped behind this commit by themselves: what was to follow is held until `release`. Returns its clock; None, and nothing is changed, if it is not known.
        """

    def between_stops(self, serial: int, next: int) -> list[int] | None:
        """
        Net steps by which each motor is further where it has stopped behind the commit `next` than where it would have behind `serial`, the one before; None if they are not known, or do not follow each other.
        """

    @property
    def holds(self) -> bool:
        """Moves wait for `release`."""

    def release(self) -> None: ...

    def stop_from(self, ticks: float, program: bool = True) -> float:
        """
        Brakes to a stop from this clock on and forgets what was to follow; returns the clock of the cut.
        """

    def suspend(self, hand_over_macro: bool = False) -> None:
        """
        After hold_from: other moves may come before what is held. What is left of a macro of the program is read as a console's if it is handed over.
        """

    @property
    def suspended(self) -> bool: ...

    def resume(self) -> None:
        """Resumes the suspended plan; the machine must be back at stop_position."""

    def forget_suspended(self) -> None: ...

    def shift_from(self, ticks: float, axis: int, mm: float) -> float | None:
        """
        From this clock on all lies so much further; returns the clock of the cut, None if that is out of range, see error.
        """

    def shift(self, axis: int, mm: float) -> bool:
        """
        The same behind all moves so far; False if that is out of range, see error.
        """

    def passed(self, ticks: float) -> None:
        """Time has passed to this clock, or nothing before it will be replanned."""

    @property
    def held(self) -> int: ...

    @property
    def clock(self) -> float:
        """End of the settled plan, ticks."""

    @property
    def rests(self) -> bool:
        """The settled plan ends at rest: what is queued may begin later."""

    @property
    def handed_out(self) -> int:
        """Clock of the last message, ticks."""

    def settle_position(self) -> None:
        """After homing: stop, and be where the program says."""

    @property
    def stop_position(self) -> list[float]:
        """
        The position at which a suspended job resumes: X, Y, Z, E and further axes, in machine mm.
        """

    def use_tool(self, tool: int) -> None:
        """
        This tool is in use, with its offset, as if the program had selected it; nothing moves. Tool 0 may be named without tools, too.
        """

    @property
    def machine_position(self) -> list[float]:
        """
        End of the plan: X, Y, Z, E of the tool in use and further axes, in machine mm.
        """

    def move_to(self, target: Sequence[float], feed_mm_s: float, within: Within = Within.LIMITS) -> bool:
        """
        A straight move in machine coordinates (NaN: stay). False, and nothing is changed, if it is too long, or not within what it must keep to: see error.
        """

    def set_axes(self, places: Sequence[tuple[int, float]], homed: bool = False) -> None:
        """
        These axes, by number, are here now (mm), without motion; and at home there, if they are `homed`.
        """

    def stand_at(self, places: Sequence[tuple[int, float]]) -> None:
        """
        The machine is here now (slots, machine mm), without motion; the program's offsets stay.
        """

    def use_joints(self, on: bool) -> None:
        """
        X, Y and Z are from now on the first three actuators of a nonlinear geometry, or the axes again; only at standstill, and set_axes must say where they are.
        """

    def renew_steppers(self, steppers: Sequence[int]) -> None:
        """
        An endstop has stopped these motors: their clocks are sent again before the next step.
        """

    def lock_axis(self, axis: int, locked: bool) -> None:
        """
        A locked axis does not know where it is: moves of it are errors, until it is set.
        """

    @property
    def locked_axes(self) -> list[int]: ...

    def line_at(self, ticks: float) -> int:
        """
        Line of the program's move that is under way, or was last, at a clock (0: none). Clocks must not go back.
        """

    def line_near(self, ticks: float) -> int:
        """As line_at, for any clock from a second before the last one asked for."""

    def layer_near(self, ticks: float) -> int:
        """The layer of that move (0: before the first one)."""

    def position_at(self, ticks: float) -> list[float] | None:
        """
        Where the plan was at a clock not much more than a second ago, as machine_position; None if it is longer ago.
        """

    def set_steps_per_unit(self, stepper: int, value: float) -> None:
        """Another scale of a motor, at standstill."""

    def set_geometry(self, spec: dict[str, Any]) -> None:
        """
        Other parameters of the machine's geometry, as in its spec, at standstill. No motor moves: set_axes must say where the axes are now.
        """

    def let_rest(self, steppers: Sequence[int]) -> None:
        """
        These motors, by number, make no step of later moves, all others do; while the machine stands. set_axes must say where the axes are after the moves of a motor that rested.
        """

    def set_height_map(self, first: tuple[float, float], spacing: tuple[float, float], heights: Sequence[Sequence[float]], fade: tuple[float, float, float] | None = None) -> None:
        """
        What the bed adds to Z: heights in mm on an even grid, rows along X, the first one at the Y of `first`; bilinear in between, level beyond. With a `fade` of start, end and target, mm: in full up to the start in Z, then evenly less, until the target alone is added from the end on. No rows: the bed is flat. No motor moves, but Z of the plan changes; only while nothing is queued. Raises ValueError.
        """

    def set_shaper(self, axis: int, impulses: Sequence[tuple[float, float]]) -> None:
        """
        The shaper of X, Y or Z at standstill: (weight, seconds) of each impulse; none: the axis is not shaped.
        """

    def set_smoothing(self, extruder: int, half_s: float) -> None:
        """
        Half of the width over which an advance is smoothed, s, at standstill; 0: the extruder has no advance.
        """

    def smoothing(self, extruder: int) -> float:
        """What set_smoothing has set, s."""

    def set_advance(self, extruder: int, seconds: float) -> None:
        """Pressure advance of the moves that follow."""

    def pressure_advance(self, extruder: int) -> float:
        """What set_advance has set, s."""

    def use_filters(self, on: bool) -> None:
        """Shapers and advance act from now on, or do not; only at standstill."""

    def plan_z(self, x: float, y: float, height: float) -> float:
        """
        Z of the plan, in mm, where what the bed adds there lifts the nozzle to this height.
        """

    def nozzle_height(self, x: float, y: float, z: float) -> float:
        """Z of the plan and what the bed adds to it there, in mm."""

    def set_tool_offset(self, tool: int, axis: int, mm: float) -> None: ...

    @property
    def tool_offsets(self) -> list[list[float]]: ...

    @property
    def offset_due(self) -> list[float]:
        """
        mm by which the next move of an axis moves X, Y and Z, too: for a change of tools, or of the offset of the tool in use, that no move has carried out yet.
        """

    @property
    def retraction(self) -> tuple[float, float, float, float, float, float, float]:
        """
        (mm, mm/s, hop mm, extra mm, mm/s back or 0, mm and extra mm of G10 S1) of M207 and M208.
        """

    @property
    def filament_diameters(self) -> list[float] | None:
        """mm, of each extruder, where E is a volume (M200); else None."""

    @property
    def filament_changes(self) -> list[tuple[float, float]]:
        """mm that M701 pushes in and M702 pulls out, of each extruder."""

    @property
    def modes(self) -> str:
        """
        Tool, speed, plane, kinds of positions and units of a program that does not name its own: a command a line, the units last.
        """

    @property
    def auto_retract(self) -> bool: ...

    def limit(self, name: str) -> float:
        """A limit as set_limit takes it."""

    def axis_limit(self, axis: str, what: str) -> float:
        """The `speed`, `accel` or `jerk` of an axis or extruder now."""

    @property
    def cold(self) -> bool:
        """While it is set, moves of the tool's filament are errors."""

    @cold.setter
    def cold(self, arg: bool, /) -> None: ...

    def set_cold_axis(self, axis: int, cold: bool) -> None:
        """The same for an axis, by number, that pushes filament."""

    @property
    def filament_scale(self) -> float:
        """
        mm of filament of the tool in use for a mm, or mm3, of the program's E.
        """

    @property
    def flows(self) -> list[float]:
        """M221 of each extruder, as a factor."""

    def set_flow(self, extruder: int, flow: float) -> None:
        """M221, a factor above 0, for what is read from now on."""

    def scale_flow_from(self, ticks: float, extruder: int, flow: float) -> float:
        """
        M221, a factor above 0, for all that is replanned from this clock on, and what is read from now on; returns the clock of the cut.
        """

    @property
    def speed_factor(self) -> float:
        """M220, as a factor."""

    def set_speed_factor(self, factor: float, live: bool = False) -> None:
        """
        M220 for the moves that follow; `live`: for all that is replanned from now on.
        """

    def set_limit(self, name: str, value: float, live: bool = False) -> None:
        """
        Changes a limit of the moves that follow; `live`: of all that is replanned.
        """

    def set_axis_limit(self, axis: str, what: str, value: float, live: bool = False) -> None:
        """
        Changes an axis' `speed`, `accel` or `jerk`, never beyond the machine's own, as set_limit.
        """

    def keep_moves(self, on: bool) -> None: ...

    def take_moves(self) -> list[Move]: ...

    def keep_toolpath(self) -> None:
        """From now on keeps the path of all moves."""

    def take_toolpath(self) -> tuple[int, list[float], float, float, list[tuple[int, float, float, int]], bytes] | None:
        """
        The path that was kept, as toolpath.py describes it; None of none. It is kept no more.
        """

    def keep_ideal(self, on: bool) -> None:
        """From now on keeps the ideal time of every step, see take_ideal."""

    def take_ideal(self, stepper: int) -> bytes:
        """
        Ideal ticks (float64) of the steps made into commands since the last call.
        """

    @property
    def limit_names(self) -> list[str]: ...

    def statistics(self) -> dict[str, Any]: ...

    def steppers(self) -> list[dict[str, Any]]: ...

    def cpu(self) -> dict[str, float]: ...
